// Time to decode one VLP-16 packet of 384 returns: single return, and dual return with two different returns a firing.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "drivers/velodyne/vlp16_decoder.hpp"

namespace {

using namespace slamd;

/// One revolution and more of packets, each continuing the one before.
class Packets {
 public:
  explicit Packets(std::uint8_t mode) : dual_{mode == 0x39} {
    for (std::size_t i = 0; i < bytes_.size(); ++i) fill(i, mode);
  }
  std::span<const std::uint8_t> at(std::size_t i, std::int64_t stamp_us) {
    auto& packet = bytes_[i % bytes_.size()];
    for (std::size_t k = 0; k < 4; ++k) packet[1200 + k] = static_cast<std::uint8_t>(stamp_us % 3'600'000'000 >> 8 * k);
    return packet;
  }
  std::int64_t period_ns() const { return dual_ ? 663'552 : 1'327'104; }

 private:
  void fill(std::size_t index, std::uint8_t mode) {
    auto& packet = bytes_[index];
    const std::size_t blocks = dual_ ? 6 : 12;
    for (std::size_t block = 0; block < 12; ++block) {
      std::uint8_t* at = &packet[block * 100];
      const std::size_t azimuth = 40 * (index * blocks + (dual_ ? block / 2 : block)) % 36000;
      const std::array<std::uint8_t, 4> head = {0xFF, 0xEE, static_cast<std::uint8_t>(azimuth),
                                                static_cast<std::uint8_t>(azimuth >> 8)};
      std::copy(head.begin(), head.end(), at);
      for (std::size_t channel = 0; channel < 32; ++channel) {
        const std::size_t distance = 1000 + 37 * channel + 501 * block;
        at[4 + 3 * channel] = static_cast<std::uint8_t>(distance);
        at[5 + 3 * channel] = static_cast<std::uint8_t>(distance >> 8);
        at[6 + 3 * channel] = static_cast<std::uint8_t>(channel * 7 + block);
      }
    }
    packet[1204] = mode;
    packet[1205] = 0x22;
  }

  bool dual_;
  std::array<std::array<std::uint8_t, 1206>, 150> bytes_{};  // 150 * 12 (6) * 0.4 degrees = two turns (one)
};

void decode(benchmark::State& state, std::uint8_t mode) {
  Packets packets{mode};
  Vlp16Decoder decoder{{}};
  std::size_t i = 0;
  for (auto _ : state) {
    const std::int64_t stamp_ns = static_cast<std::int64_t>(i) * packets.period_ns();
    const HostTime arrival = from_ns<HostTime>(stamp_ns + packets.period_ns() + 50'000 + 1'000'000'000);
    benchmark::DoNotOptimize(decoder.decode(packets.at(i++, stamp_ns / 1000), arrival));
  }
  if (decoder.stats().accepted != decoder.stats().received) state.SkipWithError("packets were refused");
  state.counters["points"] =
      static_cast<double>(decoder.stats().points) / static_cast<double>(decoder.stats().received);
}
BENCHMARK_CAPTURE(decode, single_return, 0x37);
BENCHMARK_CAPTURE(decode, dual_return, 0x39);

}  // namespace
