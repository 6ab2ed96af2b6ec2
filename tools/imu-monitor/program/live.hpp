#pragma once
// The live side of imu-monitor: reads a board, prints a line a second, records when asked.

#include <string>

#include "drivers/imu/imu_source.hpp"

namespace slamd::monitor {

struct LiveOptions {
  ImuSourceConfig source;
  double seconds = 0.0;     // 0 = until Ctrl-C
  std::string record_path;  // imu.csv to write; empty = none
};

/// Prints what the board says of itself, with `self_test` that result too. Exit code: 0 it answered, and passed; 1 not.
int query(const ImuSourceConfig& source, bool self_test);

/// Exit code: 0 samples came; 1 none did, or the recording could not be written.
int watch(const LiveOptions& options);

}  // namespace slamd::monitor
