// What a host can send to the IMU board: any setup packets and any bytes. Properties: no answer is longer than asked
// for; a command after any garbage and a delimiter is found and answered once.

#include <cstdlib>
#include <span>

#include "firmware/core/device.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

/// A bus without a sensor.
class EmptyBus final : public SensorBus {
 public:
  void read(std::uint8_t, std::size_t) override {}
  void write(std::uint8_t, std::uint8_t) override {}
  BusState state() override { return BusState::kNoAnswer; }
  std::span<const std::uint8_t> bytes() const override { return {}; }
  bool recover() override { return true; }
};

void check_requests(std::span<const std::uint8_t> input) {
  UsbControl control{UniqueId{}};
  for (std::size_t at = 0; at + 8 <= input.size(); at += 8) {
    const SetupPacket packet = SetupPacket::from(input.subspan(at).first<8>());
    const ControlReply reply = control.setup(packet);
    require(reply.bytes.size() <= packet.length);
    if (reply.stage == ControlReply::Stage::kReceive) control.received(input.subspan(at, packet.length % 8));
    require(!control.open() || control.configured());
  }
}

void check_commands(std::span<const std::uint8_t> input) {
  EmptyBus bus;
  Device device{bus, {}};
  for (const std::uint8_t byte : input) {
    device.receive({&byte, 1}, 0);
    while (device.has_packet()) require(device.next_packet().size <= kMaxPacketWireBytes);
  }
  device.receive(std::array<std::uint8_t, 1>{0}, 0);
  while (device.has_packet()) device.next_packet();
  device.receive(encode(Command{static_cast<std::uint8_t>(CommandCode::kIdentity), 0x1234}), 0);
  require(device.has_packet());
  const WirePacket packet = device.next_packet();
  const auto opened = open_packet(packet.span().first(packet.size - 1U));
  require(opened && read_packet<Identity>(*opened) && read_packet<Identity>(*opened)->tag == 0x1234);
  require(!device.has_packet());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_requests({data, size});
  check_commands({data, size});
  return 0;
}
