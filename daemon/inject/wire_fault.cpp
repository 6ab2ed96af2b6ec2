#include "daemon/inject/wire_fault.hpp"

#include <algorithm>

namespace slamd {

WireFault::WireFault(const FaultSwitch& verbs, const WireFaultShape& shape)
    : verbs_{verbs}, shape_{shape}, held_(shape.held_reads), noisy_(shape.read_bytes) {
  for (Held& held : held_) held.bytes.resize(shape.read_bytes);
}

bool WireFault::is_cut(FaultVerb verb, HostTime now) const {
  if (verb == FaultVerb::kOff) return true;
  return verb == FaultVerb::kIntermittent && now.time_since_epoch() % shape_.period < shape_.period / 2;
}

void WireFault::hold(std::span<const std::uint8_t> bytes, HostTime now) {
  while (!bytes.empty()) {
    if (count_ == held_.size()) drop_oldest();
    Held& slot = held_[(first_ + count_++) % held_.size()];
    slot.arrival = now;
    slot.size = std::min(bytes.size(), slot.bytes.size());
    std::copy_n(bytes.begin(), slot.size, slot.bytes.begin());
    bytes = bytes.subspan(slot.size);
  }
}

const WireFault::Held* WireFault::oldest(HostTime until) const {
  return count_ > 0 && held_[first_].arrival <= until ? &held_[first_] : nullptr;
}

void WireFault::drop_oldest() {
  first_ = (first_ + 1) % held_.size();
  --count_;
}

/// Of a read that is longer than any should be only the beginning gets through.
std::span<const std::uint8_t> WireFault::damaged(std::span<const std::uint8_t> bytes) {
  constexpr std::uint64_t kOneIn = 8;
  const std::size_t size = std::min(bytes.size(), noisy_.size());
  for (std::size_t i = 0; i < size; ++i) {
    noise_ ^= noise_ << 13;  // xorshift64: Marsaglia 2003, "Xorshift RNGs"
    noise_ ^= noise_ >> 7;
    noise_ ^= noise_ << 17;
    noisy_[i] = noise_ % kOneIn == 0 ? static_cast<std::uint8_t>(noise_ >> 32) : bytes[i];
  }
  return {noisy_.data(), size};
}

}  // namespace slamd
