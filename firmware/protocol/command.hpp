#pragma once
// Commands from the host to the IMU board: fields and layout. Each gets exactly one reply (reply.hpp).
// Freestanding.

#include <cstdint>

#include "firmware/protocol/packet.hpp"

namespace slamd {

/// Numbers are never reused.
enum class CommandCode : std::uint8_t {
  kIdentity = 1,    // reply Identity
  kStatistics = 2,  // reply Statistics
  kSelfTest = 3,    // reply SelfTestReport after about a second; no samples meanwhile
  kReset = 4,       // reply Acknowledgement, then the board starts anew
  kBootLoader = 5,  // reply Acknowledgement, then the ROM's USB boot loader
};

struct Command {
  std::uint8_t code = 0;  // a CommandCode, or a number that this version does not know
  std::uint16_t tag = 0;  // the host's choice, comes back in the reply

  friend constexpr bool operator==(const Command&, const Command&) = default;
};

template <>
struct Layout<Command> {
  static constexpr PacketKind kKind = PacketKind::kCommand;
  static constexpr std::size_t kPlainBytes = 6;

  static constexpr void fields(const auto& wire, auto& packet) {
    wire(1, packet.code);
    wire(2, packet.tag);
  }
};

}  // namespace slamd
