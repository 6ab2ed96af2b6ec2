#pragma once
// An LSM6DSOX behind SensorBus, register by register, in no time: for tests of firmware/core. The model with electrical
// timing is in the emulator.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/core/data_ready.hpp"
#include "firmware/core/sensor_bus.hpp"

namespace slamd::test {

class SensorFake final : public SensorBus {
 public:
  static constexpr Micros kPeriod = 4'808;

  bool present = true;
  bool hung = false;          // transfers never end, recover() finds a line low
  int hung_until_clocks = 0;  // recover() frees the bus at this many calls
  bool reset_sticks = false;
  bool data_ready_dead = false;
  std::optional<std::uint8_t> stuck_register;  // keeps its reset value
  std::array<std::int16_t, 3> self_test_accel{1000, 2000, 3000};
  std::array<std::int16_t, 3> self_test_gyro{300, 400, 500};  // at +-2000 dps
  std::array<std::int16_t, 3> gyro{}, accel{};
  std::int16_t temperature = 0;
  std::array<std::uint8_t, 128> registers{};
  std::vector<std::array<std::uint8_t, 2>> writes;
  int recoveries = 0;

  SensorFake() { power_up(); }

  void power_up() {
    registers = {};
    registers[0x0F] = 0x6C;
    registers[0x12] = 0x04;
    registers[0x18] = 0xE0;
  }

  /// The pin's edges up to `now`.
  DataReady at(Micros now) {
    const bool measuring =
        present && (registers[0x10] >> 4U) == 5 && (registers[0x11] >> 4U) == 5 && registers[0x0D] == 0x02;
    for (; next_ <= now; next_ += kPeriod) {
      if (measuring && !data_ready_dead) edge(next_);
    }
    return ready_;
  }
  void edge(Micros stamp) { ready_ = {ready_.edges + 1, stamp}; }

  void read(std::uint8_t first, std::size_t count) override {
    if (first == 0x20) latch_outputs();
    bytes_.assign(registers.begin() + first, registers.begin() + first + static_cast<std::ptrdiff_t>(count));
  }
  void write(std::uint8_t address, std::uint8_t value) override {
    writes.push_back({address, value});
    if (!present) return;
    if (address == 0x12 && (value & 1U) != 0) {
      power_up();
      if (reset_sticks) registers[0x12] |= 1U;
    } else if (stuck_register != address) {
      registers[address] = value;
    }
  }
  BusState state() override { return hung ? BusState::kBusy : present ? BusState::kDone : BusState::kNoAnswer; }
  std::span<const std::uint8_t> bytes() const override { return bytes_; }
  bool recover() override {
    ++recoveries;
    if (hung && hung_until_clocks > 0 && --hung_until_clocks == 0) hung = false;
    return !hung;
  }

 private:
  void latch_outputs() {
    const bool forced = registers[0x14] == 0x05;
    store(0x20, temperature);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      store(0x22 + 2 * axis, static_cast<std::int16_t>(gyro[axis] + (forced ? self_test_gyro[axis] : 0)));
      store(0x28 + 2 * axis, static_cast<std::int16_t>(accel[axis] + (forced ? self_test_accel[axis] : 0)));
    }
  }
  void store(std::size_t at, std::int16_t value) {
    registers[at] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) & 0xFFU);
    registers[at + 1] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) >> 8U);
  }

  std::vector<std::uint8_t> bytes_;
  DataReady ready_;
  Micros next_ = kPeriod;
};

}  // namespace slamd::test
