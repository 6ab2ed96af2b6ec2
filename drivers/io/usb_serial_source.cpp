#include "drivers/io/usb_serial_source.hpp"

#include <algorithm>
#include <utility>

namespace slamd {
namespace {

constexpr UsbInterfaceClass kCommunications{0x02, 0x02, 0x00};  // CDC 1.2: abstract control model, no protocol
constexpr UsbInterfaceClass kData{0x0A, 0x00, 0x00};
constexpr std::uint8_t kClassToInterface = 0x21;
constexpr UsbRequest kSetControlLines{kClassToInterface, 0x22, 0x0003};  // DTR and RTS: the host listens
constexpr Duration kWriteTimeout = std::chrono::seconds{1};

}  // namespace

UsbSerialSource::UsbSerialSource(UsbSerialSourceConfig config) : config_{std::move(config)}, reopen_{config_.reopen} {}

SourceRead UsbSerialSource::read(Duration timeout) {
  const HostTime deadline = ReopenTimer::now() + timeout;
  if (!is_open() && !open()) {
    reopen_.wait(deadline);
    return {};
  }
  const std::size_t room = std::min<std::size_t>(bulk_.packet_bytes, buffer_.size());
  const UsbTransfer transfer = device_.receive(bulk_, std::span{buffer_}.first(room), timeout);
  const HostTime arrival = ReopenTimer::now();
  if (transfer.fault == UsbFault::kStall) device_.clear_halt(bulk_);
  const bool stays = transfer || transfer.fault == UsbFault::kTimeout || transfer.fault == UsbFault::kStall;
  if (!stays) lose();
  stats_.bytes += transfer.size;
  if (transfer.size == 0) return {};
  return {{buffer_.data(), transfer.size}, arrival};
}

bool UsbSerialSource::write(std::span<const std::uint8_t> bytes) {
  if (!is_open()) return false;
  const UsbTransfer transfer = device_.send(bulk_, bytes, kWriteTimeout);
  return transfer && transfer.size == bytes.size();
}

/// Not before it is due.
bool UsbSerialSource::open() {
  if (!reopen_.is_due()) return false;
  for (const UsbListing& listing : UsbDevice::list(std::span{&config_.id, 1})) {
    const bool wanted = config_.serial.empty() || listing.serial == config_.serial;
    if (!wanted || device_.open(listing) != UsbFault::kNone) continue;
    if (claim()) {
      ++stats_.openings;
      reopen_.succeeded();
      return true;
    }
    device_.close();
  }
  ++stats_.failed_openings;
  reopen_.failed();
  return false;
}

bool UsbSerialSource::claim() {
  const UsbInterface control = device_.claim(kCommunications);
  bulk_ = device_.claim(kData);
  if (!control || !bulk_ || bulk_.bulk_in == 0 || bulk_.packet_bytes == 0) return false;
  return static_cast<bool>(device_.control(control, kSetControlLines));
}

void UsbSerialSource::lose() {
  device_.close();
  ++stats_.losses;
  reopen_.lost();
}

}  // namespace slamd
