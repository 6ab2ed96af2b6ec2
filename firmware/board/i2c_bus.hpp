#pragma once
// I2C0 of the RP2040 at 400 kHz as the sensor's bus. A transfer fits the controller's FIFO (16 entries): started in one
// go, its end wakes the main loop, nothing in between.

#include <array>

#include "firmware/core/sensor_bus.hpp"

namespace slamd::board {

class I2cBus final : public SensorBus {
 public:
  void read(std::uint8_t first, std::size_t count) override;
  void write(std::uint8_t address, std::uint8_t value) override;
  BusState state() override;
  std::span<const std::uint8_t> bytes() const override { return {bytes_.data(), size_}; }
  bool recover() override;

 private:
  void start_controller();

  std::array<std::uint8_t, kMaxRead> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace slamd::board
