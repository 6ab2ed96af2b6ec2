#pragma once
// What the six supported NMEA sentences say, in SI units and degrees. Values a sentence leaves empty are absent.

#include <chrono>
#include <optional>
#include <variant>

#include "drivers/gnss/nmea_sentence.hpp"
#include "estimator/types/gnss_fix.hpp"

namespace slamd {

struct GeoPosition {
  double latitude_deg;
  double longitude_deg;
};

struct GgaMessage {
  std::optional<Duration> time_of_day;
  std::optional<GeoPosition> position;
  GnssQuality quality = GnssQuality::kNone;
  unsigned satellites = 0;
  std::optional<double> hdop;
  std::optional<double> altitude_m;          // above mean sea level
  std::optional<double> geoid_separation_m;  // mean sea level above the ellipsoid
};

struct RmcMessage {
  std::optional<Duration> time_of_day;
  std::optional<std::chrono::sys_days> date;
  bool active = false;  // status A, and a mode that is not N
  std::optional<GeoPosition> position;
  std::optional<double> speed_mps;
  std::optional<double> course_deg;
  GnssQuality quality = GnssQuality::kNone;  // from the mode letter; kAutonomous when it has none but is active
};

struct GsaMessage {
  unsigned dimension = 1;  // 1 no fix, 2 horizontal, 3 with height
  std::optional<double> hdop;
};

struct GstMessage {
  std::optional<Duration> time_of_day;
  std::optional<double> sigma_north_m;
  std::optional<double> sigma_east_m;
  std::optional<double> sigma_height_m;
};

struct VtgMessage {
  std::optional<double> speed_mps;
  std::optional<double> course_deg;
};

struct ZdaMessage {
  std::optional<Duration> time_of_day;
  std::optional<std::chrono::sys_days> date;
};

/// In the order of NmeaType.
using NmeaMessage = std::variant<GgaMessage, RmcMessage, GsaMessage, GstMessage, VtgMessage, ZdaMessage>;

/// The message of a sentence; nothing for types that are not supported.
std::optional<NmeaMessage> decode(const NmeaSentence& sentence);

inline NmeaType type_of(const NmeaMessage& message) {
  return static_cast<NmeaType>(message.index());
}

}  // namespace slamd
