#pragma once
// Which way the bytes of the IMU board come in: through its tty, or straight from its USB endpoint. It parses nothing.

#include <memory>
#include <string>

#include "drivers/io/byte_source.hpp"
#include "drivers/io/serial_source.hpp"

namespace slamd {

struct ImuSourceConfig {
  std::string kind = "serial";  // "serial": through the tty; "usb": without one
  SerialSourceConfig serial{.path = "/dev/ttyACM0"};
  std::string usb_serial{};  // of the board; empty: the first one
};

/// The kinds that there are.
bool is_imu_source(const std::string& kind);

/// Opens nothing yet. Any kind but "usb" gives the tty.
std::unique_ptr<ByteSource> make_imu_source(const ImuSourceConfig& config);

/// For people: "/dev/slamd-imu", "usb:1209:0001" with the serial number when one is wanted.
std::string device_name(const ImuSourceConfig& config);

}  // namespace slamd
