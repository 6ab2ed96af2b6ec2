#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fstream>

#include "tools/imu-monitor/program/live.hpp"
#include "tools/imu-monitor/rest_recording.hpp"

namespace {

using namespace slamd::monitor;

constexpr const char* kFooter = R"(
One line a second: rate by the board's own clock; gaps in the sequence and samples they cost; rejected packets; resets;
frames with a sensor fault; skew of the board's clock against this PC's with its uncertainty; norm of the mean acceleration
(9.81 at rest); temperature; standard deviation of each axis, which is its noise when the board lies still.

Noise figures for slamd.yaml: let the board lie still for some hours, away from fans and feet,
  imu-monitor --seconds 14400 --record rest.csv
  imu-monitor --allan rest.csv --plot allan.png

exit codes: 0 samples came, the board answered and passed, the figures are printed; 1 not so, or a file cannot be written;
2 wrong command line or file)";

int print_allan(const std::string& path, const std::string& picture) {
  std::ifstream file{path};
  if (!file) {
    std::fprintf(stderr, "imu-monitor: %s cannot be opened\n", path.c_str());
    return 2;
  }
  const RestRecording recording = read_rest_recording(file);
  if (!recording.refusal.empty()) {
    std::fprintf(stderr, "imu-monitor: %s: %s\n", path.c_str(), recording.refusal.c_str());
    return 2;
  }
  const AllanResult result = evaluate(recording);
  std::fputs(allan_report(recording, result).c_str(), stdout);
  if (!picture.empty()) draw_allan(result, picture);
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{"Watches the IMU board: rates, gaps, clock, noise; Allan deviation of a recording at rest.",
               "imu-monitor"};
  app.footer(kFooter);
  app.get_formatter()->column_width(30);
  LiveOptions live;
  std::string allan;
  std::string picture;
  bool usb = false;
  bool board = false;
  bool self_test = false;
  app.add_option("DEVICE", live.source.serial.path, "tty or pty of the board")->capture_default_str();
  app.add_flag("--usb", usb, "read the board's USB endpoint instead, without a tty");
  app.add_option("--serial", live.source.usb_serial, "with --usb: the board with this serial number")->needs("--usb");
  app.add_option("--seconds", live.seconds, "stop after so long; 0 = at Ctrl-C")->check(CLI::NonNegativeNumber);
  app.add_option("--record", live.record_path, "write the samples to this imu.csv as well");
  app.add_flag("--board", board, "print the board's identity and its counters, and stop");
  app.add_flag("--self-test", self_test, "the same, and the sensor's built-in self-test; keep the board still");
  auto* allan_option = app.add_option("--allan", allan, "evaluate this imu.csv of a board at rest; no board needed");
  app.add_option("--plot", picture, "with --allan: draw the curves into this PNG")->needs(allan_option);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (usb) live.source.kind = "usb";
  if (!allan.empty()) return print_allan(allan, picture);
  return board || self_test ? query(live.source, self_test) : watch(live);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "imu-monitor: %s\n", error.what());
    return 1;
  }
}
