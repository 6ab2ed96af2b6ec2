#pragma once
// What all packets of the IMU board have in common: kind byte, CRC, COBS, delimiter. The fields of each kind are in
// imu_frame.hpp, command.hpp and reply.hpp. Freestanding (firmware and PC).

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/protocol/cobs.hpp"
#include "firmware/protocol/crc16.hpp"
#include "firmware/protocol/wire.hpp"

namespace slamd {

/// First byte of a packet: kind (high nibble), version of its layout (low nibble). Numbers are never reused; 0x11 is
/// the sample (kImuFrameKindVersion).
enum class PacketKind : std::uint8_t {
  kIdentity = 0x21,
  kStatistics = 0x31,
  kSelfTest = 0x41,
  kAcknowledgement = 0x51,
  kCommand = 0x81,
};

constexpr std::size_t kMaxPacketPlainBytes = 61;                                 // CRC included
constexpr std::size_t kMaxPacketBytes = cobs_max_encoded(kMaxPacketPlainBytes);  // without the delimiter
constexpr std::size_t kMaxPacketWireBytes = kMaxPacketBytes + 1;                 // with the delimiter
constexpr std::size_t kPacketCrcBytes = 2;
static_assert(kMaxPacketWireBytes < 64);  // one packet is one short packet of USB: the host's read ends with it

/// Closes a packet: writes the CRC into the last two bytes of `plain` and gives the bytes for the wire, delimiter 0x00
/// included: always N + 2.
template <std::size_t N>
constexpr std::array<std::uint8_t, N + 2> seal_packet(std::array<std::uint8_t, N> plain) {
  static_assert(N > kPacketCrcBytes && N <= kMaxPacketPlainBytes);
  constexpr std::size_t body = N - kPacketCrcBytes;
  wire::store(plain, body, crc16(std::span<const std::uint8_t>{plain}.first(body)));
  std::array<std::uint8_t, N + 2> bytes{};
  cobs_encode(plain, bytes);
  return bytes;
}

/// A packet whose COBS and CRC are right.
struct OpenedPacket {
  std::array<std::uint8_t, kMaxPacketPlainBytes> plain{};
  std::size_t size = 0;  // plain bytes, CRC included; at least 3

  constexpr std::uint8_t kind() const { return plain[0]; }
  /// Whether this is that kind, in the length of its layout.
  constexpr bool is(PacketKind kind, std::size_t bytes) const {
    return plain[0] == static_cast<std::uint8_t>(kind) && size == bytes;
  }
};

/// Opens what stood between two delimiters; nothing when COBS or CRC is wrong or the packet is too long. Works for
/// every kind, samples too. O(bytes), no state.
constexpr std::optional<OpenedPacket> open_packet(std::span<const std::uint8_t> packet) {
  OpenedPacket opened;
  if (packet.size() > kMaxPacketBytes) return std::nullopt;
  opened.size = cobs_decode(packet, opened.plain);
  if (opened.size <= kPacketCrcBytes) return std::nullopt;
  const std::size_t body = opened.size - kPacketCrcBytes;
  const std::span<const std::uint8_t> plain{opened.plain};
  if (wire::load<std::uint16_t>(plain, body) != crc16(plain.first(body))) return std::nullopt;
  return opened;
}

/// How a kind of packet lies on the wire. Specialised beside each kind with kKind, kPlainBytes (CRC included) and
/// fields(wire, packet), which names every field after the kind byte with its offset; wire is a Writer or a Reader.
template <class Packet>
struct Layout;

/// The bytes for the wire, delimiter included.
template <class Packet>
constexpr std::array<std::uint8_t, Layout<Packet>::kPlainBytes + 2> encode(const Packet& packet) {
  std::array<std::uint8_t, Layout<Packet>::kPlainBytes> plain{};
  plain[0] = static_cast<std::uint8_t>(Layout<Packet>::kKind);
  Layout<Packet>::fields(wire::Writer{plain}, packet);
  return seal_packet(plain);
}

/// Nothing when it is another kind of packet.
template <class Packet>
constexpr std::optional<Packet> read_packet(const OpenedPacket& opened) {
  if (!opened.is(Layout<Packet>::kKind, Layout<Packet>::kPlainBytes)) return std::nullopt;
  Packet packet;
  Layout<Packet>::fields(wire::Reader{opened.plain}, packet);
  return packet;
}

}  // namespace slamd
