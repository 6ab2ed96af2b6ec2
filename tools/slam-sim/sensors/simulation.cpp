#include "tools/slam-sim/sensors/simulation.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "tools/slam-sim/sensors/airy_sensor.hpp"
#include "tools/slam-sim/sensors/fault_injector.hpp"
#include "tools/slam-sim/sensors/position_sensor.hpp"
#include "tools/slam-sim/sensors/vlp16_sensor.hpp"

namespace slamd::sim {
namespace {

constexpr double kSlice = 0.5;

Path path_of(const World& world, const CourseSpec& course) {
  switch (course.kind) {
    case CourseKind::kFigureEight:
      return Path{world.figure_eight};
    case CourseKind::kLineAndBack:
      return Path{world.line};
    case CourseKind::kTwoLaps:
      return Path{world.short_loop, 2 * course.laps};
    default:
      return Path{world.loop, course.laps};
  }
}

std::vector<Leg> legs_of(const CourseSpec& course, double length) {
  if (course.kind == CourseKind::kStandstill) return {};
  if (course.kind == CourseKind::kLineAndBack) return {{0.0, length, 3.0}, {length, 0.0, 2.0}};
  std::vector<Leg> legs;
  double from = 0.0;
  for (; course.stop_every_m > 0.0 && from + 1.5 * course.stop_every_m < length; from += course.stop_every_m) {
    legs.push_back({from, from + course.stop_every_m, 2.0});
  }
  legs.push_back({from, length, 2.0});
  return legs;
}

TrajectoryPlan plan_of(const DriveSpec& spec, const World& world, const Path& path) {
  const CourseSpec& course = spec.course;
  TrajectoryPlan plan;
  plan.seed = spec.seed;
  plan.wobble = course.wobble;
  plan.slalom_m = course.slalom_m;
  plan.speed.limits = course.limits;
  if (course.limits.speed_mps <= 0.0) plan.speed.limits.speed_mps = world.speed_limit_mps;
  plan.speed.rest_at_start_s = course.moving_start ? 0.0 : course.rest_s;
  plan.speed.speed_at_start_mps = course.moving_start ? plan.speed.limits.speed_mps : 0.0;
  const double length = course.length_m > 0.0 ? std::min(course.length_m, path.length()) : path.length();
  plan.speed.legs = legs_of(course, length);
  if (course.kind == CourseKind::kStandstill)
    plan.speed.rest_at_start_s = spec.max_duration_s > 0.0 ? spec.max_duration_s : 60.0;
  return plan;
}

void apply_clock_faults(const std::vector<Fault>& faults, Channel sensor, SensorClock& clock) {
  for (const Fault& fault : faults) {
    if (fault.sensor != sensor) continue;
    if (fault.kind == FaultKind::kClockJump) clock.step_at(fault.from_s, fault.value * 1e-3);
    if (fault.kind == FaultKind::kClockSkew) clock.drift_between(fault.from_s, fault.to_s, fault.value);
  }
}

SensorClock lidar_clock(const DriveSpec& spec) {
  Rng rng{spec.seed, Stream::kLidarUnit, 1};
  const double start = spec.lidar.pps_locked ? std::fmod(spec.gps.utc_start_s, 3600.0) : rng.uniform(0.0, 3600.0);
  SensorClock clock{start, spec.lidar.pps_locked ? 0.0 : spec.lidar.clock_skew_ppm};
  apply_clock_faults(spec.faults, Channel::kLidar, clock);
  return clock;
}

SensorClock imu_clock(const DriveSpec& spec) {
  Rng rng{spec.seed, Stream::kImuUnit, 1};
  SensorClock clock{rng.uniform(5.0, 500.0), spec.imu.clock_skew_ppm};
  apply_clock_faults(spec.faults, Channel::kImu, clock);
  return clock;
}

SensorClock wheel_clock(const DriveSpec& spec) {
  Rng rng{spec.seed, Stream::kWheelUnit, 1};
  SensorClock clock{rng.uniform(5.0, 500.0), spec.wheel.clock_skew_ppm};
  apply_clock_faults(spec.faults, Channel::kWheel, clock);
  return clock;
}

/// An RPLIDAR where nobody mounted it otherwise sits level; an Airy's own IMU is the vehicle's where there is no other.
DriveSpec fitted(DriveSpec spec) {
  VehicleGeometry& told = spec.mounting.told;
  const Pose reference = reference_vehicle().T_base_lidar;
  const bool unmoved = told.T_base_lidar.translation == reference.translation &&
                       told.T_base_lidar.rotation.coeffs() == reference.rotation.coeffs();
  if (spec.lidar_kind == LidarKind::kRplidarA2 && unmoved) told.T_base_lidar = level_lidar_mount();
  if (spec.lidar_kind == LidarKind::kAiry && !spec.with_imu) told.T_base_imu = told.T_base_lidar * airy_imu_in_lidar();
  return spec;
}

/// Runs job(0..count-1) on several threads; which thread takes which index does not matter to the result.
template <class Job>
void in_parallel(int threads, std::size_t count, const Job& job) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) job(i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
}

}  // namespace

const char* name(LidarKind kind) {
  switch (kind) {
    case LidarKind::kVlp16: return "vlp16";
    case LidarKind::kAiry: return "airy";
    case LidarKind::kRplidarA2: return "rplidar_a2";
    case LidarKind::kLaserScan: break;
  }
  return "laser_scan";
}

LidarPorts ports_of(LidarKind kind) {
  switch (kind) {
    case LidarKind::kVlp16: return {2368, 8308, 0};
    case LidarKind::kAiry: return {6699, 7788, 6688};
    case LidarKind::kRplidarA2:
    case LidarKind::kLaserScan: break;
  }
  return {0, 0, 0};
}

struct Simulation::Parts {
  explicit Parts(const DriveSpec& wanted)
      : spec{fitted(wanted)},
        world{make_world(wanted.world, wanted.seed)},
        path{path_of(world, wanted.course)},
        trajectory{world, path, plan_of(wanted, world, path)},
        traffic{world, trajectory, path, wanted.crowd, wanted.seed},
        vehicle{spec.mounting.actual()},
        planar_lidar{wanted.planar_lidar, {world, traffic, trajectory, vehicle}, wanted.seed},
        imu{wanted.imu, trajectory, vehicle.T_base_imu, imu_clock(wanted), wanted.seed},
        gps{wanted.gps, trajectory, vehicle.p_base_antenna, wanted.seed},
        wheel{wanted.wheel, trajectory, wheel_clock(wanted), wanted.seed},
        injector{wanted.faults, wanted.seed} {
    add_packet_sensors();
    if (spec.threads <= 0) spec.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    for (const Fault& fault : spec.faults) {
      if (fault.kind == FaultKind::kJump) gps.disturb({fault.from_s, fault.to_s, fault.value});
    }
  }

  double duration() const {
    return spec.max_duration_s > 0.0 ? std::min(spec.max_duration_s, trajectory.duration()) : trajectory.duration();
  }
  void add_packet_sensors();
  std::vector<WireEvent> take_packets(std::size_t which, double until);
  /// Events of a sensor that makes them one by one.
  template <class Sensor>
  void take(Sensor& sensor, double until) {
    while (auto event = sensor.next(until)) admit({std::move(*event)});
  }
  void admit(std::vector<WireEvent> events);
  std::vector<WireEvent> release(std::int64_t until_ns);

  DriveSpec spec;
  World world;
  Path path;
  Trajectory trajectory;
  Traffic traffic;
  VehicleGeometry vehicle;
  std::vector<std::pair<std::unique_ptr<PacketSensor>, std::int64_t>> packet_sensors;  // with the packets taken so far
  std::optional<AiryImuSensor> lidar_imu;
  PlanarLidarSensor planar_lidar;
  ImuSensor imu;
  GpsSensor gps;
  WheelSensor wheel;
  FaultInjector injector;
  std::vector<WireEvent> pending;
  std::array<std::int64_t, kChannels> last_arrival_ns{};
  double time = 0.0;
};

/// Of the LiDAR that the drive has.
void Simulation::Parts::add_packet_sensors() {
  const Surroundings around{world, traffic, trajectory, vehicle};
  const SensorClock clock = lidar_clock(spec);
  if (!spec.with_lidar) return;
  if (spec.lidar_kind == LidarKind::kVlp16) {
    packet_sensors.emplace_back(std::make_unique<Vlp16Sensor>(spec.lidar, around, clock, spec.seed), 0);
    packet_sensors.emplace_back(std::make_unique<PositionSensor>(spec.lidar, spec.gps, trajectory, clock, spec.seed), 0);
  } else if (spec.lidar_kind == LidarKind::kAiry) {
    packet_sensors.emplace_back(std::make_unique<AirySensor>(spec.lidar, around, clock, spec.seed), 0);
    packet_sensors.emplace_back(std::make_unique<AiryDeviceSensor>(spec.lidar, spec.seed), 0);
    lidar_imu.emplace(spec.imu, trajectory, vehicle.T_base_lidar, clock, spec.seed + 1);
  } else if (spec.lidar_kind == LidarKind::kRplidarA2) {
    packet_sensors.emplace_back(std::make_unique<RplidarSensor>(spec.lidar, spec.rplidar, around, clock, spec.seed), 0);
  }
}

/// Of the first sensor, the LiDAR itself, only packets that are over before the drive ends.
std::vector<WireEvent> Simulation::Parts::take_packets(std::size_t which, double until) {
  auto& [sensor, taken] = packet_sensors[which];
  const std::int64_t begin = taken;
  while (sensor->packet_time(taken) < until && (which > 0 || sensor->packet_time(taken + 1) < duration())) ++taken;
  std::vector<WireEvent> events(static_cast<std::size_t>(taken - begin));
  in_parallel(spec.threads, events.size(),
              [&, &made = *sensor](std::size_t i) { events[i] = made.packet(begin + static_cast<std::int64_t>(i)); });
  return events;
}

/// Faults, then the order of each cable: nothing overtakes on one channel.
void Simulation::Parts::admit(std::vector<WireEvent> events) {
  for (WireEvent& event : events) {
    auto left = injector.apply(std::move(event));
    if (!left) continue;
    std::int64_t& last = last_arrival_ns[static_cast<std::size_t>(left->channel)];
    left->arrival_ns = std::max(left->arrival_ns, last + 10'000);
    last = left->arrival_ns;
    pending.push_back(std::move(*left));
  }
}

std::vector<WireEvent> Simulation::Parts::release(std::int64_t until_ns) {
  std::stable_sort(pending.begin(), pending.end(),
                   [](const auto& a, const auto& b) { return a.arrival_ns < b.arrival_ns; });
  const auto end =
      std::partition_point(pending.begin(), pending.end(), [&](const auto& e) { return e.arrival_ns < until_ns; });
  std::vector<WireEvent> out(std::make_move_iterator(pending.begin()), std::make_move_iterator(end));
  pending.erase(pending.begin(), end);
  return out;
}

Simulation::Simulation(const DriveSpec& spec) : parts_{std::make_unique<Parts>(spec)} {}
Simulation::~Simulation() = default;

std::vector<WireEvent> Simulation::next_slice() {
  Parts& p = *parts_;
  p.time = std::min(p.time + kSlice, p.duration());
  if (p.spec.with_lidar && p.spec.lidar_kind == LidarKind::kLaserScan) p.take(p.planar_lidar, p.time);
  for (std::size_t i = 0; i < p.packet_sensors.size(); ++i) p.admit(p.take_packets(i, p.time));
  if (p.lidar_imu) p.take(*p.lidar_imu, p.time);
  if (p.spec.with_imu) p.take(p.imu, p.time);
  if (p.spec.with_wheel) p.take(p.wheel, p.time);
  while (p.spec.with_gps) {
    auto sentences = p.gps.next(p.time);
    if (sentences.empty()) break;
    p.admit(std::move(sentences));
  }
  return p.release(done() ? std::numeric_limits<std::int64_t>::max() : std::llround(p.time * 1e9));
}

bool Simulation::done() const {
  return parts_->time >= parts_->duration();
}
double Simulation::time() const {
  return parts_->time;
}
double Simulation::duration() const {
  return parts_->duration();
}
const Trajectory& Simulation::trajectory() const {
  return parts_->trajectory;
}
const World& Simulation::world() const {
  return parts_->world;
}
const VehicleGeometry& Simulation::vehicle() const {
  return parts_->spec.mounting.told;
}

}  // namespace slamd::sim
