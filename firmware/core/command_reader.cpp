#include "firmware/core/command_reader.hpp"

#include "firmware/protocol/imu_frame.hpp"

namespace slamd {

std::optional<Command> CommandReader::take(std::uint8_t byte) {
  if (byte != kImuFrameDelimiter) {
    if (size_ < packet_.size()) packet_[size_] = byte;
    if (size_ <= packet_.size()) ++size_;
    return std::nullopt;
  }
  const std::size_t size = size_;
  size_ = 0;
  if (size == 0) return std::nullopt;
  if (size <= packet_.size()) {
    if (const auto opened = open_packet({packet_.data(), size})) {
      if (const auto command = read_packet<Command>(*opened)) return command;
    }
  }
  ++rejected_;
  return std::nullopt;
}

}  // namespace slamd
