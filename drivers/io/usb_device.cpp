#include "drivers/io/usb_device.hpp"

#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <utility>

namespace slamd {
namespace {

constexpr unsigned kControlTimeoutMs = 1000;

UsbFault fault_of(int error) {
  switch (error) {
    case LIBUSB_SUCCESS:
      return UsbFault::kNone;
    case LIBUSB_ERROR_PIPE:
      return UsbFault::kStall;
    case LIBUSB_ERROR_TIMEOUT:
      return UsbFault::kTimeout;
    case LIBUSB_ERROR_NO_DEVICE:
      return UsbFault::kGone;
    case LIBUSB_ERROR_ACCESS:
      return UsbFault::kNoPermission;
    case LIBUSB_ERROR_BUSY:
      return UsbFault::kBusy;
    case LIBUSB_ERROR_NOT_FOUND:
      return UsbFault::kNoInterface;
    default:
      return UsbFault::kOther;
  }
}

unsigned milliseconds(Duration timeout) {
  // libusb takes 0 for "for ever"
  return static_cast<unsigned>(
      std::max<std::int64_t>(1, std::chrono::ceil<std::chrono::milliseconds>(timeout).count()));
}

using Context = std::unique_ptr<libusb_context, void (*)(libusb_context*)>;

/// A context of its own for each look at the bus: a long-lived one learns of new devices only where udevd runs.
Context make_context() {
  libusb_context* context = nullptr;
  if (libusb_init(&context) != LIBUSB_SUCCESS) context = nullptr;
  return {context, libusb_exit};
}

std::string port_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  std::string text = std::to_string(libusb_get_bus_number(device));
  for (int i = 0; i < count; ++i) text += (i == 0 ? "-" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  return text;
}

std::string node_of(libusb_device* device) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "/dev/bus/usb/%03u/%03u", unsigned{libusb_get_bus_number(device)},
                unsigned{libusb_get_device_address(device)});
  return text.data();
}

std::string string_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 128> text{};
  if (index == 0) return {};
  const int size = libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
  return size > 0 ? std::string{text.begin(), text.begin() + size} : std::string{};
}

/// Calls visit(device, descriptor) for every device on the bus until it returns true.
void for_each_device(libusb_context* context,
                     const std::function<bool(libusb_device*, const libusb_device_descriptor&)>& visit) {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context, &devices);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[i], &descriptor) != LIBUSB_SUCCESS) continue;
    if (visit(devices[i], descriptor)) break;
  }
  if (devices != nullptr) libusb_free_device_list(devices, 1);
}

UsbListing describe(libusb_device* device, const libusb_device_descriptor& descriptor) {
  UsbListing listing;
  listing.id = {descriptor.idVendor, descriptor.idProduct};
  listing.release = descriptor.bcdDevice;
  listing.port = port_of(device);
  listing.node = node_of(device);
  libusb_device_handle* handle = nullptr;
  listing.fault = fault_of(libusb_open(device, &handle));
  if (handle == nullptr) return listing;
  listing.serial = string_of(handle, descriptor.iSerialNumber);
  listing.product_name = string_of(handle, descriptor.iProduct);
  libusb_close(handle);
  return listing;
}

void take_endpoints(const libusb_interface_descriptor& descriptor, UsbInterface& interface) {
  for (int i = 0; i < descriptor.bNumEndpoints; ++i) {
    const libusb_endpoint_descriptor& endpoint = descriptor.endpoint[i];
    if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) continue;
    const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
    if (in) interface.packet_bytes = endpoint.wMaxPacketSize;
    (in ? interface.bulk_in : interface.bulk_out) = endpoint.bEndpointAddress;
  }
}

UsbInterface find_interface(const libusb_config_descriptor& config, const UsbInterfaceClass& which) {
  for (std::size_t i = 0; i < config.bNumInterfaces; ++i) {
    if (config.interface[i].num_altsetting < 1) continue;
    const libusb_interface_descriptor& descriptor = config.interface[i].altsetting[0];
    if (descriptor.bInterfaceClass != which.class_code || descriptor.bInterfaceSubClass != which.subclass ||
        descriptor.bInterfaceProtocol != which.protocol) {
      continue;
    }
    UsbInterface interface;
    interface.number = descriptor.bInterfaceNumber;
    take_endpoints(descriptor, interface);
    return interface;
  }
  return {.fault = UsbFault::kNoInterface};
}

}  // namespace

const char* name(UsbFault fault) {
  switch (fault) {
    case UsbFault::kNone:
      return "no fault";
    case UsbFault::kStall:
      return "stall";
    case UsbFault::kTimeout:
      return "timeout";
    case UsbFault::kGone:
      return "unplugged";
    case UsbFault::kNoPermission:
      return "no permission";
    case UsbFault::kBusy:
      return "in use by another program";
    case UsbFault::kNoInterface:
      return "has no such interface";
    case UsbFault::kOther:
      break;
  }
  return "transfer error";
}

struct UsbDevice::Handle {
  Context context;
  libusb_device_handle* device = nullptr;

  explicit Handle(Context owned) : context{std::move(owned)} {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (device != nullptr) libusb_close(device);  // releases what is claimed
  }
};

UsbDevice::UsbDevice() = default;
UsbDevice::UsbDevice(UsbDevice&&) noexcept = default;
UsbDevice& UsbDevice::operator=(UsbDevice&&) noexcept = default;
UsbDevice::~UsbDevice() = default;

std::vector<UsbListing> UsbDevice::list(std::span<const UsbId> ids) {
  std::vector<UsbListing> listings;
  const Context context = make_context();
  if (!context) return listings;
  for_each_device(context.get(), [&](libusb_device* device, const libusb_device_descriptor& descriptor) {
    const UsbId id{descriptor.idVendor, descriptor.idProduct};
    if (std::ranges::find(ids, id) != ids.end()) listings.push_back(describe(device, descriptor));
    return false;
  });
  std::ranges::sort(listings, {}, &UsbListing::port);
  return listings;
}

UsbFault UsbDevice::open(const UsbListing& listing) {
  close();
  auto handle = std::make_unique<Handle>(make_context());
  if (!handle->context) return UsbFault::kOther;
  UsbFault fault = UsbFault::kGone;
  for_each_device(handle->context.get(), [&](libusb_device* device, const libusb_device_descriptor& descriptor) {
    if (UsbId{descriptor.idVendor, descriptor.idProduct} != listing.id || port_of(device) != listing.port) return false;
    fault = fault_of(libusb_open(device, &handle->device));
    return true;
  });
  if (fault != UsbFault::kNone) return fault;
  libusb_set_auto_detach_kernel_driver(handle->device, 1);
  handle_ = std::move(handle);
  return UsbFault::kNone;
}

void UsbDevice::close() {
  handle_.reset();
}

bool UsbDevice::is_open() const {
  return handle_ != nullptr;
}

UsbInterface UsbDevice::claim(const UsbInterfaceClass& which) {
  if (!is_open()) return {.fault = UsbFault::kGone};
  libusb_config_descriptor* config = nullptr;
  const int error = libusb_get_active_config_descriptor(libusb_get_device(handle_->device), &config);
  if (error != LIBUSB_SUCCESS) return {.fault = fault_of(error)};
  UsbInterface interface = find_interface(*config, which);
  libusb_free_config_descriptor(config);
  if (interface) interface.fault = fault_of(libusb_claim_interface(handle_->device, interface.number));
  return interface;
}

UsbTransfer UsbDevice::send(const UsbInterface& to, std::span<const std::uint8_t> bytes, Duration timeout) {
  if (!is_open()) return {UsbFault::kGone};
  int moved = 0;
  auto* data = const_cast<std::uint8_t*>(bytes.data());  // libusb's type serves both directions; OUT only reads
  const int error = libusb_bulk_transfer(handle_->device, to.bulk_out, data, static_cast<int>(bytes.size()), &moved,
                                         milliseconds(timeout));
  return {fault_of(error), static_cast<std::size_t>(moved)};
}

UsbTransfer UsbDevice::receive(const UsbInterface& from, std::span<std::uint8_t> bytes, Duration timeout) {
  if (!is_open()) return {UsbFault::kGone};
  int moved = 0;
  const int error = libusb_bulk_transfer(handle_->device, from.bulk_in, bytes.data(), static_cast<int>(bytes.size()),
                                         &moved, milliseconds(timeout));
  return {fault_of(error), static_cast<std::size_t>(moved)};
}

UsbTransfer UsbDevice::control(const UsbInterface& to, const UsbRequest& request, std::span<std::uint8_t> bytes) {
  if (!is_open()) return {UsbFault::kGone};
  const int moved = libusb_control_transfer(handle_->device, request.type, request.request, request.value, to.number,
                                            bytes.data(), static_cast<std::uint16_t>(bytes.size()), kControlTimeoutMs);
  if (moved < 0) return {fault_of(moved)};
  return {UsbFault::kNone, static_cast<std::size_t>(moved)};
}

void UsbDevice::clear_halt(const UsbInterface& of) {
  if (!is_open()) return;
  for (const std::uint8_t endpoint : {of.bulk_in, of.bulk_out}) {
    if (endpoint != 0) libusb_clear_halt(handle_->device, endpoint);
  }
}

}  // namespace slamd
