#include "firmware/board/watchdog.hpp"

#include "firmware/board/registers.hpp"

namespace slamd::board {
namespace {

constexpr std::uint32_t kTimeoutUs = 1'000'000;
constexpr std::uint32_t kCountsPerUs = 2;       // erratum RP2040-E1: it counts twice a tick
constexpr std::uint32_t kRunning = 0x736C616D;  // in scratch 0 while the program runs

}  // namespace

ResetCause reset_cause() {
  const std::uint32_t reason = reg(watchdog::kReason);
  // The boot loader restarts the board by the same timer, but only after the program has said good-bye.
  if ((reason & watchdog::kReasonTimer) != 0 && reg(watchdog::kScratch0) == kRunning) return ResetCause::kWatchdog;
  return reason != 0 ? ResetCause::kRequest : ResetCause::kPower;
}

void start_watchdog() {
  reg(psm::kWatchdogSelect) = psm::kAllButOscillators;
  reg(watchdog::kScratch0) = kRunning;
  feed_watchdog();
  reg(watchdog::kControl) = watchdog::kEnable | watchdog::kPauseInDebug;
}

void feed_watchdog() {
  reg(watchdog::kLoad) = kTimeoutUs * kCountsPerUs;
}

void reset_board() {
  reg(psm::kWatchdogSelect) = psm::kAllButOscillators;
  reg(watchdog::kScratch0) = 0;
  for (;;) reg(watchdog::kControl) = watchdog::kTrigger;
}

}  // namespace slamd::board
