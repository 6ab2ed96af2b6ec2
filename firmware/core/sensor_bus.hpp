#pragma once
// The bus to the sensor as the sensor's driver sees it: one transfer at a time, started and polled. It knows no
// registers.

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd {

/// Of the last transfer.
enum class BusState : std::uint8_t {
  kBusy,
  kDone,
  kNoAnswer,  // not acknowledged
};

class SensorBus {
 public:
  static constexpr std::size_t kMaxRead = 14;

  /// Starts reading `count` registers from `first` on; 0 < count <= kMaxRead. Not while busy.
  virtual void read(std::uint8_t first, std::size_t count) = 0;
  /// Starts writing one register. Not while busy.
  virtual void write(std::uint8_t address, std::uint8_t value) = 0;

  virtual BusState state() = 0;
  /// What the last read brought; valid after kDone until the next transfer.
  virtual std::span<const std::uint8_t> bytes() const = 0;

  /// Abandons the transfer, frees a line that a slave holds low (up to 9 clocks and a stop) and starts the bus anew.
  /// Less than 1 ms. Returns whether both lines are high.
  virtual bool recover() = 0;

 protected:
  ~SensorBus() = default;
};

}  // namespace slamd
