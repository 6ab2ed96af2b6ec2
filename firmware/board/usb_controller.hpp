#pragma once
// The RP2040's USB controller as a device: stages of endpoint 0, one bulk pipe each way. What requests mean is
// UsbControl. Called by the main loop only; its interrupt does no more than wake that.

#include <array>
#include <cstdint>
#include <span>

#include "firmware/board/usb_connect_fix.hpp"
#include "firmware/core/micros.hpp"
#include "firmware/core/usb_control.hpp"

namespace slamd::board {

class UsbController {
 public:
  explicit UsbController(UsbControl& control) : control_{control} {}

  /// Switches the controller on and shows the device to the host. Needs the 48 MHz clock.
  void start();

  /// Serves what happened since the last call. Bounded: some 10 us.
  void service(Micros now);

  /// The bytes of one packet from the host, empty when there is none. Valid until the next call.
  std::span<const std::uint8_t> receive();

  /// The pipe to the host can take a packet.
  bool can_send() const { return !in_pending_ && control_.configured() && !suspended_; }
  /// Hands over a packet of 1..63 bytes; only when can_send().
  void send(std::span<const std::uint8_t> bytes);
  /// A packet that the host has not fetched becomes zeros: it is old by the time somebody opens the port.
  void blank_pending();

  bool suspended() const { return suspended_; }
  std::uint32_t resets() const { return resets_; }
  std::uint32_t suspends() const { return suspends_; }

 private:
  enum class Stage : std::uint8_t { kIdle, kSend, kReceive, kStatusIn, kStatusOut };

  void bus_reset();
  void setup();
  void apply(const ControlReply& reply);
  void continue_sending();
  void control_in_done();
  void control_out_done();
  void stall_control();
  void open_pipes();
  void close_pipes();
  void set_halt(std::uint8_t endpoint, bool halt);
  void arm_out();

  UsbControl& control_;
  UsbConnectFix connect_fix_;
  Stage stage_ = Stage::kIdle;
  bool control_data1_ = false;
  bool in_data1_ = false;
  bool out_data1_ = false;
  bool in_pending_ = false;
  bool suspended_ = false;
  bool needs_empty_ = false;       // the answer fills its last packet but is shorter than asked for
  std::int16_t new_address_ = -1;  // for after the status stage; -1 = none
  std::span<const std::uint8_t> to_send_;
  std::array<std::uint8_t, kUsbPacketBytes> received_{};
  std::uint32_t resets_ = 0;
  std::uint32_t suspends_ = 0;
};

}  // namespace slamd::board
