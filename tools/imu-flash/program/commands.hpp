#pragma once
// What imu-flash does for each way of calling it. Texts go to stdout, refusals and failures to stderr.

#include <string>

namespace slamd::flash {

struct Options {
  std::string file;
  std::string serial;  // serial number or port; empty: the only board
  bool binary = false;
};

/// Exit codes.
constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kRefused = 2;  // the file or the command line; no board was touched

int list_boards();
int print_image(const Options& options);
int flash_board(const Options& options);
int verify_board(const Options& options);

}  // namespace slamd::flash
