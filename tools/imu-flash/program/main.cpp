#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "tools/imu-flash/program/commands.hpp"
#include "tools/imu-flash/program/texts.hpp"

namespace {

using namespace slamd::flash;

int run(int argc, char** argv) {
  CLI::App app{"Brings firmware into the IMU board (Arduino Nano RP2040 Connect) over USB.", "imu-flash"};
  app.footer(kHelpFooter);
  app.get_formatter()->column_width(30);
  Options options;
  bool list = false;
  bool info = false;
  bool verify = false;
  bool rescue = false;
  app.add_option("FILE", options.file, "firmware as UF2, or as raw binary with --bin");
  app.add_option("--serial", options.serial, "the board with this serial number or at this port (see --list)");
  app.add_flag("--bin", options.binary, "FILE is a raw binary for the start of the flash");
  auto* modes = app.add_option_group("instead of flashing");
  modes->add_flag("--list", list, "show the boards on the USB");
  modes->add_flag("--info", info, "check and describe FILE; no board needed");
  modes->add_flag("--verify", verify, "compare the board's flash with FILE; changes nothing");
  modes->add_flag("--rescue", rescue, "say how to reach the boot loader of a board that does not answer");
  modes->require_option(0, 1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kRefused;
  }
  if (rescue) return std::fputs(kRescueText, stdout), kDone;
  if (list) return list_boards();
  if (options.file.empty()) {
    std::fprintf(stderr, "imu-flash: which FILE? See imu-flash --help\n");
    return kRefused;
  }
  return info ? print_image(options) : verify ? verify_board(options) : flash_board(options);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "imu-flash: %s\n", error.what());
    return kFailed;
  }
}
