#include "drivers/imu/imu_source.hpp"

#include "drivers/io/usb_serial_source.hpp"
#include "firmware/protocol/usb_identity.hpp"

namespace slamd {

bool is_imu_source(const std::string& kind) {
  return kind == "serial" || kind == "usb";
}

std::unique_ptr<ByteSource> make_imu_source(const ImuSourceConfig& config) {
  if (config.kind != "usb") return std::make_unique<SerialSource>(config.serial);
  UsbSerialSourceConfig usb;
  usb.id = {kImuUsbVendor, kImuUsbProduct};
  usb.serial = config.usb_serial;
  usb.reopen = config.serial.reopen;
  return std::make_unique<UsbSerialSource>(usb);
}

std::string device_name(const ImuSourceConfig& config) {
  if (config.kind != "usb") return config.serial.path;
  return "usb:1209:0001" + (config.usb_serial.empty() ? "" : ":" + config.usb_serial);
}

}  // namespace slamd
