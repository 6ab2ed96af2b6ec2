#pragma once
// Pins of the Arduino Nano RP2040 Connect that the firmware uses, by GPIO number of the RP2040. No others are touched
// but GPIO15 (UsbConnectFix).

namespace slamd::board {

constexpr unsigned kLedPin = 6;   // D13, the orange LED beside the USB socket
constexpr unsigned kSdaPin = 12;  // I2C0, to the LSM6DSOX
constexpr unsigned kSclPin = 13;
constexpr unsigned kDataReadyPin = 24;  // INT1 of the LSM6DSOX

}  // namespace slamd::board
