#include "tools/imu-flash/picoboot_client.hpp"

#include <array>
#include <cstdio>

namespace slamd::flash {
namespace {

constexpr std::uint32_t kMagic = 0x431F'D10B;
constexpr std::uint8_t kTowardsHost = 0x80;
constexpr Duration kTimeout = std::chrono::seconds{3};  // the slowest is an erase: 0.4 s a sector at worst

void store(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8U * i));
}

const char* status_name(std::uint32_t status) {
  constexpr std::array kNames{"no error",
                              "unknown command",
                              "wrong length of the command",
                              "wrong transfer length",
                              "invalid address",
                              "bad alignment",
                              "write in between",
                              "rebooting",
                              "unknown error"};
  return status < kNames.size() ? kNames[status] : "unknown status";
}

}  // namespace

struct PicobootClient::Command {
  const char* name;
  std::uint8_t id;
  std::uint8_t argument_bytes;
  std::array<std::uint32_t, 3> arguments;
  std::uint32_t transfer_bytes = 0;
};

PicobootOutcome PicobootClient::begin() {
  const UsbTransfer reset = transport_.reset_interface();
  if (!reset)
    return {reset.fault, std::string{"the boot loader does not take the reset of its interface: "} + name(reset.fault)};
  return run({"exclusive access", 0x01, 1, {1}}, {}, {});
}

PicobootOutcome PicobootClient::exit_xip() {
  return run({"exit XIP", 0x06, 0, {}}, {}, {});
}

PicobootOutcome PicobootClient::erase(std::uint32_t address, std::uint32_t size) {
  return run({"erase", 0x03, 8, {address, size}}, {}, {});
}

PicobootOutcome PicobootClient::write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  return run({"write", 0x05, 8, {address, size}, size}, bytes, {});
}

PicobootOutcome PicobootClient::read(std::uint32_t address, std::span<std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  return run({"read", 0x84, 8, {address, size}, size}, {}, bytes);
}

PicobootOutcome PicobootClient::reboot(std::uint32_t delay_ms) {
  return run({"reboot", 0x02, 12, {0, 0, delay_ms}}, {}, {});
}

/// Command, data in its direction, empty packet in the other one.
PicobootOutcome PicobootClient::run(const Command& command, std::span<const std::uint8_t> out,
                                    std::span<std::uint8_t> in) {
  std::array<std::uint8_t, kCommandBytes> packet{};
  store(packet, 0, kMagic);
  store(packet, 4, ++token_);
  packet[8] = command.id;
  packet[9] = command.argument_bytes;
  store(packet, 12, command.transfer_bytes);
  for (std::size_t i = 0; i < command.arguments.size(); ++i) store(packet, 16 + 4 * i, command.arguments[i]);

  UsbTransfer transfer = transport_.send(packet, kTimeout);
  if (transfer && !out.empty()) transfer = transport_.send(out, kTimeout);
  if (transfer && !in.empty()) {
    transfer = transport_.receive(in, kTimeout);
    if (transfer && transfer.size != in.size()) transfer.fault = UsbFault::kOther;
  }
  if (!transfer) return fail(command, transfer);

  std::array<std::uint8_t, 1> nothing{};
  const bool towards_host = (command.id & kTowardsHost) != 0;
  const UsbTransfer acknowledged = towards_host ? transport_.send({}, kTimeout) : transport_.receive(nothing, kTimeout);
  return acknowledged ? PicobootOutcome{} : fail(command, acknowledged);
}

/// Asks the boot loader for its reason, and leaves its interface usable.
PicobootOutcome PicobootClient::fail(const Command& command, const UsbTransfer& transfer) {
  char at[24] = "";
  if (command.argument_bytes == 8) std::snprintf(at, sizeof at, " at 0x%08x", command.arguments[0]);
  PicobootOutcome outcome{transfer.fault, std::string{command.name} + at + ": " + name(transfer.fault)};
  if (transfer.fault == UsbFault::kGone) return outcome;
  std::array<std::uint8_t, kStatusBytes> status{};
  const UsbTransfer answer = transport_.command_status(status);
  if (answer && answer.size == status.size()) {
    const std::uint32_t code = status[4] | static_cast<std::uint32_t>(status[5]) << 8U;
    outcome.text += std::string{" (boot loader: "} + status_name(code) + ")";
  }
  transport_.reset_interface();
  return outcome;
}

}  // namespace slamd::flash
