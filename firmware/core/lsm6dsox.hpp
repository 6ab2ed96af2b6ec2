#pragma once
// Registers and values of the LSM6DSOX that the firmware uses (data sheet DS12814, application note AN5272). The
// sequence in which they are used is Sensor.

#include <array>
#include <cstdint>

namespace slamd::lsm6dsox {

constexpr std::uint8_t kBusAddress = 0x6A;

constexpr std::uint8_t kCounterControl = 0x0B, kInterrupt1 = 0x0D, kWhoAmI = 0x0F, kAccelControl = 0x10,
                       kGyroControl = 0x11, kControl3 = 0x12, kControl4 = 0x13, kSelfTest = 0x14, kControl6 = 0x15,
                       kControl7 = 0x16, kControl8 = 0x17, kControl9 = 0x18, kTemperature = 0x20;
constexpr std::uint8_t kId = 0x6C;

constexpr std::uint8_t kSoftwareReset = 0x01;            // in kControl3
constexpr std::uint8_t kAccel208Hz4g = 0x58;             // 0101 10 00
constexpr std::uint8_t kGyro208Hz500dps = 0x54;          // 0101 01 00
constexpr std::uint8_t kGyro208Hz2000dps = 0x5C;         // 0101 11 00
constexpr std::uint8_t kBlockUpdateAndIncrement = 0x44;  // halves of a value belong together; address counts up
constexpr std::uint8_t kMaskUnsettled = 0x08;            // no data-ready before the filters have settled
constexpr std::uint8_t kI2cOnly = 0xE2;                  // reset value, and I3C off
constexpr std::uint8_t kPulsedDataReady = 0x80;          // 75 us a sample, whether it is read or not
constexpr std::uint8_t kGyroReadyOnInterrupt1 = 0x02;
constexpr std::uint8_t kSelfTestPositive = 0x05;  // both sensors, positive sign

constexpr std::uint16_t kRateHz = 208, kGyroRangeDps = 500;
constexpr std::uint8_t kAccelRangeG = 4;

struct Setting {
  std::uint8_t address;
  std::uint8_t value;
};

/// From reset to measuring. The rates come last but one; data-ready is routed to the pin when all is set.
inline constexpr std::array kMeasure{Setting{kControl3, kBlockUpdateAndIncrement},
                                     Setting{kControl9, kI2cOnly},
                                     Setting{kControl4, kMaskUnsettled},
                                     Setting{kSelfTest, 0},
                                     Setting{kControl6, 0},  // both sensors in high-performance mode, default filters
                                     Setting{kControl7, 0},
                                     Setting{kControl8, 0},
                                     Setting{kCounterControl, kPulsedDataReady},
                                     Setting{kAccelControl, kAccel208Hz4g},
                                     Setting{kGyroControl, kGyro208Hz500dps},
                                     Setting{kInterrupt1, kGyroReadyOnInterrupt1}};

/// From measuring to the self-test's reference, then to its force. After the test the sensor is set up from reset.
inline constexpr std::array kSelfTestReference{Setting{kGyroControl, kGyro208Hz2000dps}};
inline constexpr std::array kSelfTestForce{Setting{kSelfTest, kSelfTestPositive}};

}  // namespace slamd::lsm6dsox
