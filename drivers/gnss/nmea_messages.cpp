#include "drivers/gnss/nmea_messages.hpp"

#include "drivers/gnss/nmea_fields.hpp"

namespace slamd {
namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;
constexpr double kMpsPerKmh = 1.0 / 3.6;

std::optional<double> scaled(std::optional<double> value, double unit) {
  return value ? std::optional{*value * unit} : std::nullopt;
}

std::optional<GeoPosition> position(const NmeaSentence& s, std::size_t first) {
  const auto latitude = nmea::latitude_deg(s.field(first), s.field(first + 1));
  const auto longitude = nmea::longitude_deg(s.field(first + 2), s.field(first + 3));
  if (!latitude || !longitude) return std::nullopt;
  return GeoPosition{*latitude, *longitude};
}

GnssQuality quality_of_digit(char digit) {
  switch (digit) {
    case '1':
    case '3':
    case '7':
      return GnssQuality::kAutonomous;
    case '2':
      return GnssQuality::kDifferential;
    case '4':
      return GnssQuality::kRtkFixed;
    case '5':
      return GnssQuality::kRtkFloat;
    case '6':
      return GnssQuality::kDeadReckoning;
    case '8':
      return GnssQuality::kSimulated;
    default:
      return GnssQuality::kNone;
  }
}

GnssQuality quality_of_mode(char mode) {
  switch (mode) {
    case 'D':
      return GnssQuality::kDifferential;
    case 'F':
      return GnssQuality::kRtkFloat;
    case 'R':
      return GnssQuality::kRtkFixed;
    case 'E':
      return GnssQuality::kDeadReckoning;
    case 'S':
      return GnssQuality::kSimulated;
    case 'N':
      return GnssQuality::kNone;
    default:
      return GnssQuality::kAutonomous;
  }
}

GgaMessage decode_gga(const NmeaSentence& s) {
  GgaMessage gga;
  gga.time_of_day = nmea::time_of_day(s.field(0));
  gga.position = position(s, 1);
  gga.quality = quality_of_digit(nmea::letter(s.field(5)));
  gga.satellites = nmea::small_count(s.field(6)).value_or(0);
  gga.hdop = nmea::non_negative(s.field(7));
  gga.altitude_m = nmea::number(s.field(8));
  gga.geoid_separation_m = nmea::number(s.field(10));
  return gga;
}

RmcMessage decode_rmc(const NmeaSentence& s) {
  RmcMessage rmc;
  rmc.time_of_day = nmea::time_of_day(s.field(0));
  const char mode = nmea::letter(s.field(11));
  rmc.active = nmea::letter(s.field(1)) == 'A' && mode != 'N';
  rmc.position = position(s, 2);
  rmc.speed_mps = scaled(nmea::non_negative(s.field(6)), kMpsPerKnot);
  rmc.course_deg = nmea::non_negative(s.field(7));
  rmc.date = nmea::date_ddmmyy(s.field(8));
  rmc.quality = rmc.active ? quality_of_mode(mode) : GnssQuality::kNone;
  return rmc;
}

GsaMessage decode_gsa(const NmeaSentence& s) {
  return {nmea::small_count(s.field(1)).value_or(1), nmea::non_negative(s.field(15))};
}

GstMessage decode_gst(const NmeaSentence& s) {
  return {nmea::time_of_day(s.field(0)), nmea::non_negative(s.field(5)), nmea::non_negative(s.field(6)),
          nmea::non_negative(s.field(7))};
}

VtgMessage decode_vtg(const NmeaSentence& s) {
  std::optional<double> speed = scaled(nmea::non_negative(s.field(4)), kMpsPerKnot);
  if (!speed) speed = scaled(nmea::non_negative(s.field(6)), kMpsPerKmh);
  return {speed, nmea::non_negative(s.field(0))};
}

ZdaMessage decode_zda(const NmeaSentence& s) {
  return {nmea::time_of_day(s.field(0)), nmea::date(s.field(1), s.field(2), s.field(3))};
}

}  // namespace

std::optional<NmeaMessage> decode(const NmeaSentence& sentence) {
  switch (sentence.type) {
    case NmeaType::kGga:
      return decode_gga(sentence);
    case NmeaType::kRmc:
      return decode_rmc(sentence);
    case NmeaType::kGsa:
      return decode_gsa(sentence);
    case NmeaType::kGst:
      return decode_gst(sentence);
    case NmeaType::kVtg:
      return decode_vtg(sentence);
    case NmeaType::kZda:
      return decode_zda(sentence);
    case NmeaType::kOther:
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace slamd
