#include "daemon/server/methods.hpp"

#include <fcntl.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/server/grid_job.hpp"
#include "daemon/server/host_clock.hpp"
#include "daemon/server/map_job.hpp"
#include "daemon/server/pose_json.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "daemon/store/file_name.hpp"

namespace slamd {
namespace {

using nlohmann::json;
namespace error = protocol::error;
namespace method = protocol::method;

json pose_row(const StampedPose& pose) {
  const Eigen::Vector3d& p = pose.T_odom_base.translation;
  const Eigen::Quaterniond& q = pose.T_odom_base.rotation;
  return json::array({to_ns(pose.time), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

/// Root of the three axes' variances; in the plane of two.
double position_sigma_m(const PoseSample& sample, bool is_planar) {
  return std::sqrt(sample.covariance[0] + sample.covariance[7] + (is_planar ? 0.0 : sample.covariance[14]));
}

constexpr const char* kNoGrid = "mode is not planar: there is no grid";
const std::vector<std::string> kTopics{"pose", "status", "grid"};

RateGate& gate(Subscriptions& subscriptions, const std::string& topic) {
  return topic == "pose" ? subscriptions.pose : topic == "status" ? subscriptions.status : subscriptions.grid;
}

}  // namespace

struct Methods::Entry {
  const char* name;
  Right right;
  Handled (*call)(Methods& self, Params& params, Subscriptions& subscriptions);
};

std::span<const Methods::Entry> Methods::entries() {
  static constexpr std::array<Entry, 15> kEntries{{
      {method::kGetPose, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.pose(params); }},
      {method::kVersion, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.version(params); }},
      {method::kGetStatus, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.tell_status(params); }},
      {method::kSubscribe, Right::kRead, [](Methods& self, Params& params, Subscriptions& all) { return self.subscribe(params, all); }},
      {method::kUnsubscribe, Right::kRead, [](Methods& self, Params& params, Subscriptions& all) { return self.unsubscribe(params, all); }},
      {method::kGetMap, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.map(params); }},
      {method::kGetGrid, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.grid(params); }},
      {method::kGetPosePage, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.pose_page(params); }},
      {method::kGetTrajectory, Right::kRead, [](Methods& self, Params& params, Subscriptions&) { return self.trajectory(params); }},
      {method::kSaveMap, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.save_map(params); }},
      {method::kInject, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.inject(params); }},
      {method::kDump, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.dump(params); }},
      {method::kPushOdometry, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.push_odometry(params); }},
      {method::kStartRecording, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.start_recording(params); }},
      {method::kStopRecording, Right::kControl, [](Methods& self, Params& params, Subscriptions&) { return self.stop_recording(params); }},
  }};
  return kEntries;
}

Methods::Methods(const ServerConfig& config, const ServerSources& sources, std::string version,
                 CountsSource server_counts)
    : config_{config}, sources_{sources}, version_{std::move(version)}, server_counts_{std::move(server_counts)} {}

Methods::Handled Methods::call(const RpcRequest& request, Right right, Subscriptions& subscriptions) {
  Params params{request.params};
  for (const Entry& entry : entries()) {
    if (request.method != entry.name) continue;
    if (entry.right == Right::kControl && right != Right::kControl) {
      return RpcError{error::kNotAllowed, request.method + " needs a member of the group " + config_.control_group};
    }
    return entry.call(*this, params, subscriptions);
  }
  return RpcError{error::kUnknownMethod, "unknown method"};
}

const json& Methods::status() {
  const HostTime now = host_now();
  if (status_.is_null() || now - status_time_ > kStatusAge) {
    status_ = fresh_status(now);
    status_time_ = now;
  }
  return status_;
}

Methods::Handled Methods::tell_status(Params& params) {
  if (auto fault = params.fault()) return *std::move(fault);
  return Reply{status(), {}};
}

json Methods::fresh_status(HostTime now) const {
  json pose = {{"status", "INITIALISING"}, {"reasons", json::array()}, {"age_s", nullptr}, {"sequence", 0}};
  if (const std::optional<PoseSample> sample = sources_.pose.newest()) {
    pose = {{"status", name(static_cast<TrackingStatus>(sample->status))},
            {"reasons", reason_names(sample->reasons)},
            {"age_s", to_seconds(now - from_ns<HostTime>(sample->host_time_ns))},
            {"sigma_m", position_sigma_m(*sample, sources_.grid != nullptr)},
            {"lidar_test_ratio", sample->lidar_test_ratio},
            {"sequence", sample->sequence}};
  }
  const MapCounts counts = sources_.map.counts();
  const json map = {{"keyframes", counts.keyframes},
                    {"points", counts.points},
                    {"bytes", counts.bytes},
                    {"byte_budget", counts.byte_budget},
                    {"budget_reached", counts.evicted_keyframes > 0},
                    {"changes", counts.changes},
                    {"moved_keyframes", counts.moved_keyframes},
                    {"moving_points", counts.moving_points},
                    {"evicted_keyframes", counts.evicted_keyframes},
                    {"rejected_keyframes", counts.rejected_keyframes},
                    {"rejected_points", counts.rejected_points}};
  const json path = {{"poses", sources_.trajectory.size()},
                     {"stride", sources_.trajectory.stride()},
                     {"rejected", sources_.trajectory.rejected()}};
  return {{"time_ns", to_ns(now)}, {"pose", std::move(pose)},           {"map", map}, {"trajectory", path},
          {"version", version_},   {"health", sources_.health.to_json(now)}, {"server", server_counts_()}};
}

Methods::Handled Methods::version(Params& params) const {
  const double wanted = params.number("protocol", protocol::kVersion, 0, 1e6);
  if (auto fault = params.fault()) return *std::move(fault);
  if (wanted != protocol::kVersion) {
    return RpcError{error::kVersionUnknown, "this daemon speaks protocol " + std::to_string(protocol::kVersion)};
  }
  json methods = json::array();
  for (const Entry& entry : entries()) methods.push_back(entry.name);
  return Reply{{{"daemon", "slamd"}, {"version", version_}, {"protocol", protocol::kVersion}, {"methods", methods}}, {}};
}

Methods::Handled Methods::pose(Params& params) const {
  if (auto fault = params.fault()) return *std::move(fault);
  const std::optional<PoseSample> sample = sources_.pose.newest();
  if (!sample) return RpcError{error::kNotYet, "no pose yet"};
  return Reply{json::parse(pose_text(*sample)), {}};
}

Methods::Handled Methods::subscribe(Params& params, Subscriptions& subscriptions) const {
  const std::string topic = params.choice("topic", kTopics);
  const double rate_hz = topic == "pose" ? params.number("rate_hz", 10.0, 0.01, 1000.0) : params.number("rate_hz", 1.0, 0.01, 4.0);
  if (auto fault = params.fault()) return *std::move(fault);
  if (topic == "grid" && sources_.grid == nullptr) return RpcError{error::kNotConfigured, kNoGrid};
  gate(subscriptions, topic).open(from_seconds(1.0 / rate_hz));
  return Reply{{{"topic", topic}, {"rate_hz", rate_hz}}, {}};
}

Methods::Handled Methods::unsubscribe(Params& params, Subscriptions& subscriptions) const {
  const std::string topic = params.choice("topic", kTopics);
  if (auto fault = params.fault()) return *std::move(fault);
  gate(subscriptions, topic).shut();
  return Reply{{{"topic", topic}}, {}};
}

Methods::Handled Methods::pose_page(Params& params) const {
  if (auto fault = params.fault()) return *std::move(fault);
  UniqueFd fd{::fcntl(sources_.pose.page_fd(), F_DUPFD_CLOEXEC, 0)};
  if (!fd) return RpcError{error::kInternal, "no more file descriptors"};
  return Reply{{{"version", PosePageLayout::kVersion},
                {"bytes", PosePageLayout::kBytes},
                {"sample_bytes", sizeof(PoseSample)},
                {protocol::kFdField, true}},
               std::move(fd)};
}

Methods::Handled Methods::map(Params& params) const {
  MapRequest request = read_map_request(params);
  request.format = params.choice("format", {"pcd", "ply"}) == "pcd" ? CloudFormat::kPcd : CloudFormat::kPly;
  const bool tell_progress = params.flag("progress", false);
  if (auto fault = params.fault()) return *std::move(fault);
  return Job{[&store = sources_.map, request](const JobProgress& progress) { return make_map(store, request, progress); },
             tell_progress};
}

Methods::Handled Methods::save_map(Params& params) const {
  MapRequest request = read_map_request(params);
  const std::string file = params.text("name", "map.pcd");
  const bool tell_progress = params.flag("progress", false);
  if (auto fault = params.fault()) return *std::move(fault);
  if (!is_good_map_name(file)) {
    return RpcError{error::kRefused, "name must be a plain file name that ends in .pcd or .ply"};
  }
  request.format = file.ends_with(".pcd") ? CloudFormat::kPcd : CloudFormat::kPly;
  return Job{[&store = sources_.map, request, path = config_.save_dir + '/' + file](const JobProgress& progress) {
               return slamd::save_map(store, request, path, progress);
             },
             tell_progress};
}

Methods::Handled Methods::grid(Params& params) const {
  const bool as_picture = params.choice("format", {"cells", "pgm"}) == "pgm";
  const std::string name = params.text("name", "map.pgm");
  if (auto fault = params.fault()) return *std::move(fault);
  if (!is_plain_file_name(name) || !name.ends_with(".pgm")) return RpcError{error::kRefused, "name must be a plain file name that ends in .pgm"};
  if (sources_.grid == nullptr) return RpcError{error::kNotConfigured, kNoGrid};
  return Job{[&store = *sources_.grid, request = GridRequest{as_picture, name}](const JobProgress&) { return make_grid(store, request); }};
}

Methods::Handled Methods::inject(Params& params) const {
  const std::string sensor = params.choice("sensor", {"lidar", "imu", "gnss"});
  std::vector<std::string> verbs;
  for (const FaultVerb verb : kFaultVerbs) verbs.emplace_back(name(verb));
  const std::string verb = params.choice("verb", verbs);
  const double for_s = params.number("for_s", 10.0, 0.1, 600.0);
  if (auto fault = params.fault()) return *std::move(fault);
  if (sources_.faults == nullptr) return RpcError{error::kNotConfigured, "health.allow_inject is false"};
  FaultBoard& board = *sources_.faults;
  FaultSwitch& target = sensor == "lidar" ? board.lidar : sensor == "imu" ? board.imu : board.gnss;
  target.set(*fault_verb(verb), host_now() + from_seconds(for_s));
  return Reply{{{"sensor", sensor}, {"verb", verb}, {"for_s", for_s}}, {}};
}

Methods::Handled Methods::trajectory(Params& params) const {
  constexpr double kMostPoses = 2000;  // in one line; the whole path goes as a file
  const bool tum = params.choice("format", {"json", "tum"}) == "tum";
  const auto max_poses = static_cast<std::size_t>(params.number("max_poses", 1000, 1, kMostPoses));
  if (auto fault = params.fault()) return *std::move(fault);
  if (tum) return Job{[&store = sources_.trajectory](const JobProgress&) { return make_tum(store); }};
  json rows = json::array();
  for (const StampedPose& pose : sources_.trajectory.snapshot(max_poses)) rows.push_back(pose_row(pose));
  return Reply{{{"format", "json"}, {"frame", "odom"}, {"stride", sources_.trajectory.stride()}, {"poses", rows}}, {}};
}

Methods::Handled Methods::dump(Params& params) const {
  const std::string folder_name = params.text("name", "");
  if (auto fault = params.fault()) return *std::move(fault);
  if (!sources_.dump) return RpcError{error::kRefused, "there is no flight recorder"};
  return Job{[write = sources_.dump, folder_name](const JobProgress&) -> Outcome {
    const Result<std::string> path = write(folder_name);
    if (!path) return RpcError{error::kWriteFailed, path.reason()};
    return Reply{{{"path", *path}}, {}};
  }};
}

Methods::Handled Methods::push_odometry(Params& params) const {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  constexpr double kMostMetres = 1e7, kMostRadians = 1e6, kMostCount = 4'294'967'295.0;
  const double device_us = params.number("device_us", kAbsent, 0.0, kMostCount);
  PushedOdometry pushed;
  pushed.x_m = params.number("x_m", kAbsent, -kMostMetres, kMostMetres);
  pushed.y_m = params.number("y_m", kAbsent, -kMostMetres, kMostMetres);
  pushed.yaw_rad = params.number("yaw_rad", kAbsent, -kMostRadians, kMostRadians);
  if (auto fault = params.fault()) return *std::move(fault);
  if (std::isnan(device_us + pushed.x_m + pushed.y_m + pushed.yaw_rad)) {
    return RpcError{error::kInvalidParams, "device_us, x_m, y_m and yaw_rad must be given"};
  }
  pushed.device_us = static_cast<std::uint32_t>(device_us);
  if (!sources_.push_odometry || !sources_.push_odometry(pushed)) return RpcError{error::kBusy, "too many readings wait"};
  return Reply{json::object(), {}};
}

Methods::Handled Methods::start_recording(Params& params) const {
  const std::string name = params.text("name", "");
  const double max_s = params.number("max_s", 0.0, 0.0, 604'800.0);
  const double max_bytes = params.number("max_bytes", 0.0, 0.0, 1e13);
  if (auto fault = params.fault()) return *std::move(fault);
  if (!is_plain_file_name(name) || !name.ends_with(".mcap")) return RpcError{error::kRefused, "name must be a plain file name that ends in .mcap"};
  if (!sources_.recording.start) return RpcError{error::kRefused, "there is no recorder"};
  return Job{[start = sources_.recording.start, name, max_s, max_bytes](const JobProgress&) -> Outcome {
    const Result<std::string> path = start(name, max_s, max_bytes);
    if (!path) return RpcError{error::kWriteFailed, path.reason()};
    return Reply{{{"path", *path}}, {}};
  }};
}

Methods::Handled Methods::stop_recording(Params& params) const {
  if (auto fault = params.fault()) return *std::move(fault);
  if (!sources_.recording.stop) return RpcError{error::kRefused, "there is no recorder"};
  return Job{[stop = sources_.recording.stop](const JobProgress&) -> Outcome {
    const Result<json> recorded = stop();
    if (!recorded) return RpcError{error::kWriteFailed, recorded.reason()};
    return Reply{*recorded, {}};
  }};
}

}  // namespace slamd
