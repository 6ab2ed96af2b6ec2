#include "tools/imu-flash/flasher.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace slamd::flash {
namespace {

std::string difference(std::uint32_t address, std::uint8_t wanted, std::uint8_t found) {
  char text[96];
  std::snprintf(text, sizeof text, "verify failed at 0x%08x: should be 0x%02x, is 0x%02x", address, unsigned{wanted},
                unsigned{found});
  return text;
}

}  // namespace

const char* name(Step step) {
  constexpr const char* kNames[] = {"erase", "write", "verify"};
  return kNames[static_cast<std::size_t>(step)];
}

Flasher::Flasher(PicobootClient& client, const FlashImage& image, FlashProgress progress)
    : client_{client}, image_{image}, progress_{std::move(progress)} {}

FlashOutcome Flasher::write() {
  FlashImage rest = image_;
  FlashImage first;
  if (image_.has_second_stage()) {
    first.pages.push_back(rest.pages.front());
    rest.pages.erase(rest.pages.begin());
  }
  const std::vector<Run> rest_runs = rest.runs();
  const std::vector<Run> first_run = first.runs();
  FlashOutcome outcome = begin();
  if (outcome) outcome = erase_all();
  if (outcome) outcome = write_runs(rest_runs);
  if (outcome) outcome = compare_runs(rest_runs);
  if (outcome) outcome = write_runs(first_run);
  if (outcome) outcome = compare_runs(first_run);
  return outcome;
}

FlashOutcome Flasher::verify() {
  const FlashOutcome begun = begin();
  return begun ? compare_runs(image_.runs()) : begun;
}

FlashOutcome Flasher::begin() {
  std::ranges::fill(done_, 0);
  PicobootOutcome outcome = client_.begin();
  if (outcome) outcome = client_.exit_xip();
  return {outcome.text};
}

/// In the order of addresses: the first page's sector first.
FlashOutcome Flasher::erase_all() {
  for (const std::uint32_t sector : image_.sectors()) {
    const PicobootOutcome erased = client_.erase(sector, kSectorBytes);
    if (!erased) return {erased.text};
    if (FlashOutcome stopped = advance(Step::kErase, kSectorBytes); !stopped) return stopped;
  }
  return {};
}

FlashOutcome Flasher::write_runs(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    const PicobootOutcome written = client_.write(run.address, run.bytes);
    if (!written) return {written.text};
    if (FlashOutcome stopped = advance(Step::kWrite, run.bytes.size()); !stopped) return stopped;
  }
  return {};
}

FlashOutcome Flasher::compare_runs(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    std::vector<std::uint8_t> found(run.bytes.size());
    const PicobootOutcome read = client_.read(run.address, found);
    if (!read) return {read.text};
    const auto [wanted_at, found_at] = std::ranges::mismatch(run.bytes, found);
    if (wanted_at != run.bytes.end()) {
      return {
          difference(run.address + static_cast<std::uint32_t>(wanted_at - run.bytes.begin()), *wanted_at, *found_at)};
    }
    if (FlashOutcome stopped = advance(Step::kVerify, run.bytes.size()); !stopped) return stopped;
  }
  return {};
}

FlashOutcome Flasher::advance(Step step, std::size_t bytes) {
  std::size_t& done = done_[static_cast<std::size_t>(step)];
  done += bytes;
  const std::size_t total =
      step == Step::kErase ? image_.sectors().size() * kSectorBytes : image_.pages.size() * kPageBytes;
  if (progress_(step, done, total)) return {};
  return {std::string{name(step)} + " interrupted"};
}

}  // namespace slamd::flash
