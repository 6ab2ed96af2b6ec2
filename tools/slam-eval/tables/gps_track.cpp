#include "tools/slam-eval/tables/gps_track.hpp"

#include <yaml-cpp/yaml.h>

#include <cstdlib>
#include <fstream>
#include <optional>

#include "drivers/gnss/nmea_parser.hpp"
#include "estimator/math/geodesy.hpp"
#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"

namespace slamd::eval {
namespace {

constexpr std::size_t kFewest = 3;  // that an alignment needs

/// A drive has either the file and this key or neither.
Eigen::Vector3d antenna_of(const std::filesystem::path& vehicle) {
  if (!std::filesystem::exists(vehicle)) return Eigen::Vector3d::Zero();
  try {
    const YAML::Node p = YAML::LoadFile(vehicle.string())["p_base_antenna"];
    return p ? Eigen::Vector3d{p[0].as<double>(), p[1].as<double>(), p[2].as<double>()} : Eigen::Vector3d{Eigen::Vector3d::Zero()};
  } catch (const YAML::Exception& error) {
    throw InputError(vehicle.string() + ": " + error.what());
  }
}

/// Fixes of a drive's gps.csv, lines `t_ns,sentence`.
template <class Sink>
void read_fixes(const std::filesystem::path& gps_csv, Sink&& sink) {
  std::ifstream in{gps_csv};
  NmeaParser parser;
  for (std::string line; std::getline(in, line);) {
    const std::size_t comma = line.find(',');
    char* end = nullptr;
    const std::int64_t arrival_ns = std::strtoll(line.c_str(), &end, 10);
    if (comma == std::string::npos || end != line.c_str() + comma) continue;
    const std::string sentence = line.substr(comma + 1) + "\r\n";
    parser.feed({reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()}, from_ns<HostTime>(arrival_ns), sink);
  }
  parser.finish(sink);
}

}  // namespace

GpsTrack load_gps_track(const std::filesystem::path& drive) {
  GpsTrack track{.antenna = {}, .p_base_antenna = antenna_of(drive / "vehicle.yaml")};
  std::optional<LocalEnu> enu;
  read_fixes(drive / "gps.csv", [&](const GnssFix& fix) {
    if (fix.quality == GnssQuality::kNone || fix.stale) return;
    const GeodeticPosition position{fix.latitude_deg, fix.longitude_deg, fix.height_valid ? fix.height_m : 0.0};
    if (!enu) enu.emplace(position);
    track.antenna.stamps_s.push_back(to_seconds(fix.time.time_since_epoch()));
    track.antenna.poses.push_back({Eigen::Quaterniond::Identity(), enu->to_enu(position)});
  });
  return track;
}

Statistics ape_to_gps(const GpsTrack& track, const Trajectory& estimate) {
  if (track.antenna.poses.size() < kFewest) return {};
  const MatchedPoses matched = associate(estimate, track.antenna, {.interpolate = true});
  if (matched.truth.size() < kFewest) return {};
  std::vector<Pose> fixes = matched.estimate, antenna = matched.truth;
  for (Pose& pose : fixes) pose.translation.z() = 0.0;
  for (Pose& pose : antenna) pose = {Eigen::Quaterniond::Identity(), pose * track.p_base_antenna};
  for (Pose& pose : antenna) pose.translation.z() = 0.0;
  return statistics(ape(fixes, aligned(fit(Alignment::kSe3Umeyama, fixes, antenna), antenna), PoseRelation::kTranslationPart));
}

}  // namespace slamd::eval
