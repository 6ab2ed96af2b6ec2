#pragma once
// What the board answers to requests on USB endpoint 0: standard, serial port and reset requests. It moves no bytes:
// packets, toggles and stages are the controller's.

#include <array>
#include <cstdint>
#include <span>

#include "firmware/core/usb_descriptors.hpp"

namespace slamd {

struct SetupPacket {
  std::uint8_t type = 0;  // bmRequestType
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  static SetupPacket from(std::span<const std::uint8_t, 8> bytes);
};

/// What endpoint 0 does next, and what else changes. `address` and `start` take effect after the status stage.
struct ControlReply {
  enum class Stage : std::uint8_t { kStall, kSend, kReceive, kAcknowledge };
  enum class Effect : std::uint8_t { kNone, kAddress, kConfigure, kDeconfigure, kHalt, kUnhalt };

  Stage stage = Stage::kStall;
  Effect effect = Effect::kNone;
  std::uint8_t argument = 0;            // address, or endpoint of kHalt and kUnhalt
  std::span<const std::uint8_t> bytes;  // of kSend, not more than the host asked for; valid until the next call
};

/// What the host asked of the whole board.
enum class StartRequest : std::uint8_t { kNone, kReset, kBootLoader };

/// State of the device as the host sees it. Used by one thread.
class UsbControl {
 public:
  explicit UsbControl(const UniqueId& id) : id_{id} {}

  /// Answers a setup packet.
  ControlReply setup(const SetupPacket& packet);

  /// The data stage of the request that setup() answered with kReceive. False when it has to be refused.
  bool received(std::span<const std::uint8_t> bytes);

  /// The host reset the bus: back to the default state.
  void bus_reset();

  bool configured() const { return configured_; }
  /// A program on the host has the port open (DTR).
  bool open() const { return configured_ && terminal_ready_; }

  /// The request to start anew, by the reset interface or by the touch of 1200 baud; given once.
  StartRequest take_start_request();

 private:
  ControlReply standard(const SetupPacket& packet);
  ControlReply get_descriptor(const SetupPacket& packet);
  ControlReply get_status(const SetupPacket& packet);
  ControlReply feature(const SetupPacket& packet, bool set);
  ControlReply set_configuration(const SetupPacket& packet);
  ControlReply serial_port(const SetupPacket& packet);
  ControlReply reset_interface(const SetupPacket& packet);
  ControlReply send(std::span<const std::uint8_t> bytes, const SetupPacket& packet);
  ControlReply send(std::uint8_t byte, const SetupPacket& packet);
  bool* halted(std::uint16_t endpoint);

  static constexpr std::array<std::uint8_t, 7> kInitialLineCoding{0x00, 0xC2, 0x01, 0x00, 0, 0, 8};  // 115200 8N1

  UniqueId id_;
  std::array<std::uint8_t, 7> line_coding_ = kInitialLineCoding;
  std::array<bool, 3> halted_{};  // notify, out, in
  bool configured_ = false;
  bool terminal_ready_ = false;
  StartRequest start_request_ = StartRequest::kNone;
  StringDescriptor string_;
  std::array<std::uint8_t, 2> small_{};
};

}  // namespace slamd
