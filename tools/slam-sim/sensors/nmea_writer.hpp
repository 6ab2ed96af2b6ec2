#pragma once
// NMEA 0183 sentences of one fix. Text only: what the fix is worth and when it is sent is gps_sensor's.

#include <string>

namespace slamd::sim {

/// utc_s: seconds since 1970-01-01 UTC. Altitude above mean sea level; course clockwise from north.
struct NmeaFix {
  double utc_s = 0.0;
  double latitude_deg = 0.0, longitude_deg = 0.0;
  double altitude_msl_m = 0.0, geoid_separation_m = 0.0;
  double speed_mps = 0.0, course_deg = 0.0;
  double hdop = 0.9;
  int satellites = 11;
  int quality = 1;  // of GGA; 0 = no fix
  double sigma_horizontal_m = 1.2, sigma_vertical_m = 2.2;
};

/// "$" + body + "*hh\r\n" with the checksum of the body.
std::string framed(const std::string& body);

std::string gga(const NmeaFix& fix);
std::string rmc(const NmeaFix& fix);
std::string gsa(const NmeaFix& fix);
std::string gst(const NmeaFix& fix);
std::string vtg(const NmeaFix& fix);
std::string zda(const NmeaFix& fix);

/// GGA RMC GSA GST VTG ZDA.
bool is_sentence(const std::string& kind);
/// By its kind; empty for an unknown one.
std::string sentence(const std::string& kind, const NmeaFix& fix);

}  // namespace slamd::sim
