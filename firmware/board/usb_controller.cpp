#include "firmware/board/usb_controller.hpp"

#include "firmware/board/start_up.hpp"
#include "firmware/board/usb_registers.hpp"

namespace slamd::board {
namespace {

constexpr std::uint32_t kControlIn = bit(0), kControlOut = bit(1), kPipeOut = bit(5),
                        kPipeIn = bit(4);  // of kBufferStatus
constexpr std::uint32_t kStallControl = bit(0) | bit(1);

volatile std::uint8_t* ram(Address at) {
  return reinterpret_cast<volatile std::uint8_t*>(at);
}

/// Hands a buffer to the controller. "Available" goes last: the controller may look at any time (data sheet 4.1.2.5.3).
void arm(Address control, std::uint32_t value) {
  reg(control) = value;
  asm volatile("nop\n nop\n nop");
  reg(control) = value | usb::kAvailable;
}

void write(Address buffer, std::span<const std::uint8_t> bytes) {
  volatile std::uint8_t* to = ram(buffer);
  for (const std::uint8_t byte : bytes) *to++ = byte;
}

std::uint32_t data_bit(bool data1) {
  return data1 ? usb::kData1 : 0;
}

}  // namespace

void UsbController::start() {
  release_from_reset(resets::kUsb);
  for (Address at = usb::kRam; at < usb::kRamEnd; at += 4) reg(at) = 0;
  reg(usb::kMuxing) = usb::kToPhy | usb::kSoftConnect;
  reg(usb::kPower) = usb::kVbusDetected | usb::kVbusOverride;
  reg(usb::kMainControl) = usb::kControllerEnable;
  reg(usb::kSieControl) = usb::kInterruptPerBuffer0;
  reg(usb::kInterruptEnable) =
      usb::kEventBuffer | usb::kEventBusReset | usb::kEventSetup | usb::kEventSuspend | usb::kEventResume;
  reg(usb::kSieControl) = usb::kInterruptPerBuffer0 | usb::kPullUp;
}

void UsbController::service(Micros now) {
  const std::uint32_t events = reg(usb::kInterrupts);
  if ((events & usb::kEventBusReset) != 0) bus_reset();
  if ((events & usb::kEventBuffer) != 0) {
    suspended_ = false;  // a transfer: the bus is awake
    const std::uint32_t done = reg(usb::kBufferStatus);
    // Before the next buffers go out: their end must not be cleared with this. The OUT pipe's bit stays until receive()
    // has fetched the bytes.
    reg(usb::kBufferStatus) = done & ~kPipeOut;
    if ((done & kControlIn) != 0) control_in_done();
    if ((done & kControlOut) != 0) control_out_done();
    if ((done & kPipeIn) != 0) in_pending_ = false;
  }
  if ((events & usb::kEventSetup) != 0) setup();
  if ((events & usb::kEventSuspend) != 0) {
    reg(usb::kSieStatus) = usb::kStatusSuspended;
    if (!suspended_) ++suspends_;
    suspended_ = true;
  }
  if ((events & usb::kEventResume) != 0) {
    reg(usb::kSieStatus) = usb::kStatusResume;
    suspended_ = false;
  }
  connect_fix_.step(now);
}

void UsbController::bus_reset() {
  ++resets_;
  close_pipes();
  control_.bus_reset();
  stage_ = Stage::kIdle;
  new_address_ = -1;
  suspended_ = false;
  reg(usb::kAddress) = 0;
  reg(usb::buffer_control_in(0)) = 0;
  reg(usb::buffer_control_out(0)) = 0;
  reg(usb::kSieStatus) = usb::kStatusBusReset;
  connect_fix_.begin();
}

void UsbController::setup() {
  std::array<std::uint8_t, 8> bytes;
  do {  // again when another one came while this was read: its bytes lie in the same place
    reg(usb::kSieStatus) = usb::kStatusSetup;
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = ram(usb::kRam)[i];
  } while ((reg(usb::kSieStatus) & usb::kStatusSetup) != 0);
  reg(usb::buffer_control_in(0)) = 0;
  reg(usb::buffer_control_out(0)) = 0;
  suspended_ = false;
  new_address_ = -1;
  control_data1_ = true;
  const SetupPacket packet = SetupPacket::from(bytes);
  const ControlReply reply = control_.setup(packet);
  needs_empty_ = reply.bytes.size() < packet.length && reply.bytes.size() % kUsbPacketBytes == 0;
  apply(reply);
}

void UsbController::apply(const ControlReply& reply) {
  switch (reply.effect) {
    case ControlReply::Effect::kNone:
      break;
    case ControlReply::Effect::kAddress:
      new_address_ = reply.argument;
      break;
    case ControlReply::Effect::kConfigure:
      open_pipes();
      break;
    case ControlReply::Effect::kDeconfigure:
      close_pipes();
      break;
    case ControlReply::Effect::kHalt:
      set_halt(reply.argument, true);
      break;
    case ControlReply::Effect::kUnhalt:
      set_halt(reply.argument, false);
      break;
  }
  switch (reply.stage) {
    case ControlReply::Stage::kStall:
      stall_control();
      break;
    case ControlReply::Stage::kSend:
      stage_ = Stage::kSend;
      to_send_ = reply.bytes;
      continue_sending();
      break;
    case ControlReply::Stage::kReceive:
      stage_ = Stage::kReceive;
      arm(usb::buffer_control_out(0), usb::kData1 | kUsbPacketBytes);
      break;
    case ControlReply::Stage::kAcknowledge:
      stage_ = Stage::kStatusIn;
      arm(usb::buffer_control_in(0), usb::kFull | usb::kData1);
      break;
  }
}

void UsbController::continue_sending() {
  const std::size_t size = to_send_.size() < kUsbPacketBytes ? to_send_.size() : kUsbPacketBytes;
  if (size == 0) needs_empty_ = false;
  write(usb::kBuffer0, to_send_.first(size));
  to_send_ = to_send_.subspan(size);
  arm(usb::buffer_control_in(0), usb::kFull | data_bit(control_data1_) | static_cast<std::uint32_t>(size));
  control_data1_ = !control_data1_;
}

void UsbController::control_in_done() {
  if (stage_ == Stage::kStatusIn) {
    if (new_address_ >= 0) reg(usb::kAddress) = static_cast<std::uint32_t>(new_address_);
    new_address_ = -1;
    stage_ = Stage::kIdle;
  } else if (stage_ == Stage::kSend) {
    if (!to_send_.empty() || needs_empty_) return continue_sending();
    stage_ = Stage::kStatusOut;
    arm(usb::buffer_control_out(0), usb::kData1);
  }
}

void UsbController::control_out_done() {
  if (stage_ != Stage::kReceive) {
    stage_ = Stage::kIdle;
    return;
  }
  const std::size_t size = reg(usb::buffer_control_out(0)) & usb::kLengthMask;
  for (std::size_t i = 0; i < size; ++i) received_[i] = ram(usb::kBuffer0)[i];
  if (!control_.received({received_.data(), size})) return stall_control();
  stage_ = Stage::kStatusIn;
  arm(usb::buffer_control_in(0), usb::kFull | usb::kData1);
}

void UsbController::stall_control() {
  stage_ = Stage::kIdle;
  reg(usb::kStallArm) = kStallControl;
  reg(usb::buffer_control_in(0)) = usb::kStall;
  reg(usb::buffer_control_out(0)) = usb::kStall;
}

void UsbController::open_pipes() {
  close_pipes();
  constexpr std::uint32_t kOn = usb::kEndpointEnable | usb::kEndpointInterrupt;
  reg(usb::endpoint_control_in(1)) = kOn | usb::kTypeInterrupt | (usb::kNotifyBuffer - usb::kRam);
  reg(usb::endpoint_control_out(2)) = kOn | usb::kTypeBulk | (usb::kOutBuffer - usb::kRam);
  reg(usb::endpoint_control_in(2)) = kOn | usb::kTypeBulk | (usb::kInBuffer - usb::kRam);
  arm_out();
}

void UsbController::close_pipes() {
  reg(usb::endpoint_control_in(1)) = 0;
  reg(usb::endpoint_control_out(2)) = 0;
  reg(usb::endpoint_control_in(2)) = 0;
  reg(usb::buffer_control_in(1)) = 0;
  reg(usb::buffer_control_out(2)) = 0;
  reg(usb::buffer_control_in(2)) = 0;
  reg(usb::kBufferStatus) = kPipeIn | kPipeOut;
  in_pending_ = false;
  in_data1_ = false;
  out_data1_ = false;
}

/// Halting drops what is pending; after the end of a halt the toggle starts anew (USB 2.0, 9.4.5).
void UsbController::set_halt(std::uint8_t endpoint, bool halt) {
  const std::uint32_t idle = halt ? usb::kStall : 0;
  if (endpoint == kNotifyEndpoint) {
    reg(usb::buffer_control_in(1)) = idle;
  } else if (endpoint == kInEndpoint) {
    reg(usb::buffer_control_in(2)) = idle;
    in_pending_ = halt;
    in_data1_ = false;
  } else {
    reg(usb::buffer_control_out(2)) = idle;
    out_data1_ = false;
    if (!halt) arm_out();
  }
}

void UsbController::arm_out() {
  arm(usb::buffer_control_out(2), data_bit(out_data1_) | kUsbPacketBytes);
  out_data1_ = !out_data1_;
}

std::span<const std::uint8_t> UsbController::receive() {
  if ((reg(usb::kBufferStatus) & kPipeOut) == 0) return {};
  reg(usb::kBufferStatus) = kPipeOut;
  const std::size_t size = reg(usb::buffer_control_out(2)) & usb::kLengthMask;
  for (std::size_t i = 0; i < size; ++i) received_[i] = ram(usb::kOutBuffer)[i];
  arm_out();
  return {received_.data(), size};
}

void UsbController::send(std::span<const std::uint8_t> bytes) {
  write(usb::kInBuffer, bytes);
  in_pending_ = true;
  arm(usb::buffer_control_in(2), usb::kFull | data_bit(in_data1_) | static_cast<std::uint32_t>(bytes.size()));
  in_data1_ = !in_data1_;
}

void UsbController::blank_pending() {
  if (!in_pending_) return;
  for (std::size_t i = 0; i < kUsbPacketBytes; ++i) ram(usb::kInBuffer)[i] = 0;
}

}  // namespace slamd::board
