#include "drivers/robosense/airy_stamp.hpp"

#include <chrono>

#include "drivers/io/byte_reader.hpp"

namespace slamd {
namespace {

constexpr std::uint64_t kLastSecond = 7'258'118'400;  // the year 2200: nanoseconds since 1970 end in 2262

std::optional<DeviceTime> read_count(std::span<const std::uint8_t, kRobosenseStampBytes> bytes) {
  ByteReader reader{bytes};
  const std::uint64_t high = reader.u16_be();
  const std::uint64_t seconds = (high << 32U) | reader.u32_be();
  const std::uint32_t microseconds = reader.u32_be();
  if (seconds >= kLastSecond || microseconds >= 1'000'000U) return std::nullopt;
  return DeviceTime{std::chrono::seconds{static_cast<std::int64_t>(seconds)} + std::chrono::microseconds{microseconds}};
}

std::optional<DeviceTime> read_calendar(std::span<const std::uint8_t, kRobosenseStampBytes> bytes) {
  using namespace std::chrono;
  const year_month_day date{year{2000 + bytes[0]}, month{bytes[1]}, day{bytes[2]}};
  ByteReader fraction{bytes.subspan<6>()};
  const unsigned ms = fraction.u16_be();
  const unsigned us = fraction.u16_be();
  if (!date.ok() || bytes[0] > 199 || bytes[3] > 23 || bytes[4] > 59 || bytes[5] > 60 || ms > 999 || us > 999) return std::nullopt;
  const auto of_day = hours{bytes[3]} + minutes{bytes[4]} + seconds{bytes[5]} + milliseconds{ms} + microseconds{us};
  return DeviceTime{sys_days{date}.time_since_epoch() + of_day};
}

}  // namespace

std::optional<DeviceTime> read_robosense_stamp(std::span<const std::uint8_t, kRobosenseStampBytes> bytes) {
  return bytes[0] == 0 ? read_count(bytes) : read_calendar(bytes);
}

}  // namespace slamd
