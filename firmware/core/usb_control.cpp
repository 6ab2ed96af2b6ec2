#include "firmware/core/usb_control.hpp"

#include "firmware/protocol/usb_identity.hpp"
#include "firmware/protocol/wire.hpp"

namespace slamd {
namespace {

using Stage = ControlReply::Stage;
using Effect = ControlReply::Effect;

// bmRequestType: direction, type, recipient (USB 2.0, table 9-2).
constexpr std::uint8_t kToHost = 0x80, kTypeMask = 0x60, kStandard = 0x00, kClass = 0x20;
constexpr std::uint8_t kRecipientMask = 0x1F, kToDevice = 0, kToInterface = 1, kToEndpoint = 2;

enum Standard : std::uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetInterface = 11
};
enum Serial : std::uint8_t { kSetLineCoding = 0x20, kGetLineCoding = 0x21, kSetLineState = 0x22, kSendBreak = 0x23 };

constexpr std::uint8_t kInterfaces = 3;
constexpr std::uint32_t kTouchBaud = 1200;

constexpr ControlReply stall() {
  return {};
}
constexpr ControlReply acknowledge(Effect effect = Effect::kNone, std::uint8_t argument = 0) {
  return {Stage::kAcknowledge, effect, argument, {}};
}

}  // namespace

SetupPacket SetupPacket::from(std::span<const std::uint8_t, 8> bytes) {
  return {bytes[0], bytes[1], wire::load<std::uint16_t>(bytes, 2), wire::load<std::uint16_t>(bytes, 4),
          wire::load<std::uint16_t>(bytes, 6)};
}

ControlReply UsbControl::setup(const SetupPacket& packet) {
  const std::uint8_t type = packet.type & kTypeMask;
  if (type == kStandard) return standard(packet);
  if (type != kClass || (packet.type & kRecipientMask) != kToInterface || !configured_) return stall();
  if (packet.index == kControlInterface) return serial_port(packet);
  if (packet.index == kResetInterface) return reset_interface(packet);
  return stall();
}

ControlReply UsbControl::standard(const SetupPacket& packet) {
  const std::uint8_t recipient = packet.type & kRecipientMask;
  if ((packet.type & kToHost) != 0) {
    if (packet.request == kGetDescriptor && recipient == kToDevice) return get_descriptor(packet);
    if (packet.request == kGetStatus) return get_status(packet);
    if (packet.request == kGetConfiguration && recipient == kToDevice) return send(configured_ ? 1 : 0, packet);
    if (packet.request == kGetInterface && recipient == kToInterface && configured_ && packet.index < kInterfaces)
      return send(0, packet);
    return stall();
  }
  switch (packet.request) {
    case kSetAddress:
      if (recipient != kToDevice || packet.value > 127) return stall();
      return acknowledge(Effect::kAddress, static_cast<std::uint8_t>(packet.value));
    case kSetConfiguration:
      return recipient == kToDevice ? set_configuration(packet) : stall();
    case kClearFeature:
      return feature(packet, false);
    case kSetFeature:
      return feature(packet, true);
    case kSetInterface:
      if (recipient != kToInterface || !configured_ || packet.index >= kInterfaces || packet.value != 0) return stall();
      return acknowledge();
    default:
      return stall();
  }
}

ControlReply UsbControl::get_descriptor(const SetupPacket& packet) {
  const auto index = static_cast<std::uint8_t>(packet.value & 0xFFU);
  switch (packet.value >> 8U) {
    case 1:
      return index == 0 ? send(device_descriptor(), packet) : stall();
    case 2:
      return index == 0 ? send(configuration_descriptor(), packet) : stall();
    case 3:
      if (index >= kUsbStringCount) return stall();
      string_ = string_descriptor(index, id_);
      return send(string_.span(), packet);
    default:
      return stall();  // no qualifier: the board knows full speed only
  }
}

ControlReply UsbControl::get_status(const SetupPacket& packet) {
  const std::uint8_t recipient = packet.type & kRecipientMask;
  small_ = {};
  if (recipient == kToInterface && !(configured_ && packet.index < kInterfaces)) return stall();
  if (recipient == kToEndpoint && (packet.index & 0x7FU) != 0) {
    const bool* const halt = halted(packet.index);
    if (halt == nullptr) return stall();
    small_[0] = *halt ? 1 : 0;
  }
  return recipient > kToEndpoint ? stall() : send(small_, packet);
}

ControlReply UsbControl::feature(const SetupPacket& packet, bool set) {
  constexpr std::uint16_t kEndpointHalt = 0;
  bool* const halt = halted(packet.index);
  if ((packet.type & kRecipientMask) != kToEndpoint || packet.value != kEndpointHalt || halt == nullptr) return stall();
  *halt = set;
  return acknowledge(set ? Effect::kHalt : Effect::kUnhalt, static_cast<std::uint8_t>(packet.index));
}

ControlReply UsbControl::set_configuration(const SetupPacket& packet) {
  if (packet.value > 1) return stall();
  configured_ = packet.value == 1;
  terminal_ready_ = false;
  halted_ = {};
  return acknowledge(configured_ ? Effect::kConfigure : Effect::kDeconfigure);
}

ControlReply UsbControl::serial_port(const SetupPacket& packet) {
  const bool to_host = (packet.type & kToHost) != 0;
  if (packet.request == kGetLineCoding && to_host) return send(line_coding_, packet);
  if (to_host) return stall();
  switch (packet.request) {
    case kSetLineCoding:
      if (packet.length != line_coding_.size()) return stall();
      return {Stage::kReceive, Effect::kNone, 0, {}};
    case kSetLineState:
      terminal_ready_ = (packet.value & 1U) != 0;
      if (!terminal_ready_ && wire::load<std::uint32_t>(line_coding_, 0) == kTouchBaud)
        start_request_ = StartRequest::kBootLoader;
      return acknowledge();
    case kSendBreak:
      return acknowledge();
    default:
      return stall();
  }
}

ControlReply UsbControl::reset_interface(const SetupPacket& packet) {
  if ((packet.type & kToHost) != 0) return stall();
  switch (static_cast<ImuResetRequest>(packet.request)) {
    case ImuResetRequest::kBootLoader:
      start_request_ = StartRequest::kBootLoader;
      return acknowledge();
    case ImuResetRequest::kFlash:
      start_request_ = StartRequest::kReset;
      return acknowledge();
    default:
      return stall();
  }
}

bool UsbControl::received(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != line_coding_.size()) return false;
  for (std::size_t i = 0; i < bytes.size(); ++i) line_coding_[i] = bytes[i];
  return true;
}

void UsbControl::bus_reset() {
  line_coding_ = kInitialLineCoding;
  halted_ = {};
  configured_ = false;
  terminal_ready_ = false;
}

StartRequest UsbControl::take_start_request() {
  const StartRequest request = start_request_;
  start_request_ = StartRequest::kNone;
  return request;
}

ControlReply UsbControl::send(std::span<const std::uint8_t> bytes, const SetupPacket& packet) {
  return {Stage::kSend, Effect::kNone, 0, bytes.size() > packet.length ? bytes.first(packet.length) : bytes};
}

ControlReply UsbControl::send(std::uint8_t byte, const SetupPacket& packet) {
  small_[0] = byte;
  return send(std::span<const std::uint8_t>{small_}.first(1), packet);
}

bool* UsbControl::halted(std::uint16_t endpoint) {
  if (!configured_) return nullptr;
  switch (endpoint) {
    case kNotifyEndpoint:
      return &halted_[0];
    case kOutEndpoint:
      return &halted_[1];
    case kInEndpoint:
      return &halted_[2];
    default:
      return nullptr;
  }
}

}  // namespace slamd
