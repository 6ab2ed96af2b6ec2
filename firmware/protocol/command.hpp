#pragma once
// Commands from the host to the IMU board: layout, encoder, decoder. Each gets exactly one reply (reply.hpp).
// Freestanding.

#include <array>
#include <cstdint>
#include <optional>

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

constexpr std::size_t kCommandPlainBytes = 6;

/// The bytes for the wire, delimiter included.
constexpr std::array<std::uint8_t, kCommandPlainBytes + 2> encode(const Command& command) {
  std::array<std::uint8_t, kCommandPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(PacketKind::kCommand);
  plain[1] = command.code;
  wire::store(plain, 2, command.tag);
  return seal_packet(plain);
}

constexpr std::optional<Command> read_command(const OpenedPacket& packet) {
  if (!packet.is(PacketKind::kCommand, kCommandPlainBytes)) return std::nullopt;
  return Command{packet.plain[1], wire::load<std::uint16_t>(packet.plain, 2)};
}

}  // namespace slamd
