#include "tools/slam-replay/bag/bag_sensors.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "tools/slam-replay/bag/cloud_stream.hpp"
#include "tools/slam-replay/bag/topic_probe.hpp"
#include "tools/slam-replay/bag/topic_reads.hpp"
#include "tools/slam-replay/bag/topic_streams.hpp"
#include "tools/slam-replay/drive/wire_streams.hpp"

namespace slamd::replay {
namespace {

constexpr double kStandardGravity_mps2 = 9.80665;
constexpr double kMostOfG = 3.0;           // a specific force at rest below this is in g
constexpr double kLagOfSweepsEnd = 0.75;   // of a period: a cloud recorded so long after its stamp was stamped at its begin

struct Candidate {
  std::string_view role, type;
};

/// In order of preference.
constexpr std::array<Candidate, 7> kCandidates{{{"lidar", VelodyneScanMessage::kType},
                                                {"lidar", PointCloud2Message::kType},
                                                {"imu", ImuMessage::kType},
                                                {"gps", SentenceMessage::kType},
                                                {"gps", NavSatFixMessage::kType},
                                                {"odometry", OdometryMessage::kType},
                                                {"scan", LaserScanMessage::kType}}};

bool can_be(const Topic& topic, std::string_view role) {
  return topic.encoding && std::any_of(kCandidates.begin(), kCandidates.end(),
                                       [&](const Candidate& c) { return c.role == role && c.type == topic.type; });
}

class SensorMaker {
 public:
  SensorMaker(const Bag& bag, const DriverConfigs& drivers) : bag_{bag}, drivers_{drivers} {}

  BagSensors make(const std::vector<TopicUse>& uses) {
    std::vector<std::size_t> used;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      if (uses[i].role.empty()) continue;
      used.push_back(i);
      probes_.push_back(probe(bag_, i));
    }
    const std::vector<TopicClock> clocks = replay::clocks(probes_);
    for (std::size_t i = 0; i < used.size(); ++i) {
      const TopicUse& use = uses[used[i]];
      TopicSource source{bag_.read(used[i]), *use.topic.encoding, clocks[i], use.role == "odometry" ? "wheel" : use.role};
      open(use, std::move(source), probes_[i]);
    }
    return std::move(made_);
  }

 private:
  void open(const TopicUse& use, TopicSource source, const TopicProbe& probe) {
    const std::string& type = use.topic.type;
    Sensors& sensors = made_.sensors;
    if (!probe.stamped) made_.notes.push_back(use.topic.name + ": its headers have no stamps: the times of recording are taken");
    if (type == VelodyneScanMessage::kType) sensors.lidar = std::make_unique<SpinningStream>(velodyne_reads(std::move(source)), LidarSetup{.decoder = drivers_.lidar.decoder});
    else if (type == PointCloud2Message::kType) sensors.lidar = cloud_stream(std::move(source), cloud_config(probe));
    else if (type == ImuMessage::kType) sensors.imu = imu_stream(std::move(source), accel_scale(use, probe));
    else if (type == SentenceMessage::kType) sensors.gnss = std::make_unique<GnssWireStream>(sentence_reads(std::move(source)), drivers_.nmea);
    else if (type == NavSatFixMessage::kType) sensors.gnss = fix_stream(std::move(source), drivers_.nmea.noise);
    else if (type == OdometryMessage::kType) sensors.wheel = odometry_stream(std::move(source));
    else if (type == LaserScanMessage::kType) sensors.laser = laser_stream(std::move(source));
  }

  CloudStreamConfig cloud_config(const TopicProbe& probe) const {
    CloudStreamConfig config{{}, drivers_.lidar.decoder.min_range_m, drivers_.lidar.decoder.max_range_m};
    if (probe.period_s > 0.0) config.timing.period_s = probe.period_s;
    config.timing.stamp_is_begin = probe.stamped && to_seconds(probe.least_lag) > kLagOfSweepsEnd * config.timing.period_s &&
                                   to_seconds(probe.least_lag) < 1.0;
    return config;
  }

  double accel_scale(const TopicUse& use, const TopicProbe& probe) {
    if (probe.accel_norm <= 0.0 || probe.accel_norm > kMostOfG) return 1.0;
    made_.notes.push_back(use.topic.name + ": its specific force is in g and taken as such");
    return kStandardGravity_mps2;
  }

  const Bag& bag_;
  const DriverConfigs& drivers_;
  std::vector<TopicProbe> probes_;
  BagSensors made_;
};

std::string wrong_wish(const std::vector<TopicUse>& uses, const TopicWishes& wishes) {
  for (const auto& wish : wishes) {
    const std::string& role = wish.first;
    const std::string& name = wish.second;
    const bool is_role = std::any_of(kCandidates.begin(), kCandidates.end(), [&](const Candidate& c) { return c.role == role; });
    if (!is_role) return "--topic " + role + "=" + name + ": a topic may be lidar, imu, gps, odometry or scan";
    if (name.empty()) continue;
    const auto found = std::find_if(uses.begin(), uses.end(), [&](const TopicUse& use) { return use.topic.name == name; });
    if (found == uses.end()) return "--topic " + role + "=" + name + ": there is no such topic";
    if (!can_be(found->topic, role)) return "--topic " + role + "=" + name + ": its messages are " + found->topic.type + ", which is no " + role;
  }
  return {};
}

}  // namespace

std::vector<TopicUse> assign_roles(const std::vector<Topic>& topics, const TopicWishes& wishes) {
  std::vector<TopicUse> uses;
  for (const Topic& topic : topics) uses.push_back({topic, ""});
  std::map<std::string, bool> taken;
  for (const auto& [role, name] : wishes) {
    taken[role] = true;
    for (TopicUse& use : uses) {
      if (!name.empty() && use.topic.name == name && can_be(use.topic, role)) use.role = role;
    }
  }
  for (const Candidate& candidate : kCandidates) {
    TopicUse* best = nullptr;
    for (TopicUse& use : uses) {
      const bool fits = use.topic.type == candidate.type && use.topic.encoding && use.role.empty() && use.topic.messages > 0;
      if (fits && (best == nullptr || use.topic.messages > best->topic.messages)) best = &use;
    }
    if (best == nullptr || std::exchange(taken[std::string{candidate.role}], true)) continue;
    best->role = candidate.role;
  }
  return uses;
}

BagSensors open_sensors(const Bag& bag, const TopicWishes& wishes, const DriverConfigs& drivers) {
  const std::vector<TopicUse> uses = assign_roles(bag.topics(), wishes);
  if (std::string fault = wrong_wish(uses, wishes); !fault.empty()) return {{}, {}, std::move(fault)};
  return SensorMaker{bag, drivers}.make(uses);
}

std::string list_text(const std::string& path, const Bag& bag, const TopicWishes& wishes) {
  std::string text = path + ": " + bag.form() + "\n";
  for (const TopicUse& use : assign_roles(bag.topics(), wishes)) {
    std::array<char, 512> line;
    std::snprintf(line.data(), line.size(), "%-9s %9llu  %-32s %s%s\n", use.role.empty() ? "-" : use.role.c_str(),
                  static_cast<unsigned long long>(use.topic.messages), use.topic.type.c_str(), use.topic.name.c_str(),
                  use.topic.encoding ? "" : "  (an encoding that cannot be read here)");
    text += line.data();
  }
  return text;
}

}  // namespace slamd::replay
