#include <sched.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include "tools/slam-sim/output/drive_folder.hpp"
#include "tools/slam-sim/output/motion_file.hpp"
#include "tools/slam-sim/output/pty_port.hpp"
#include "tools/slam-sim/output/slice_queue.hpp"
#include "tools/slam-sim/output/stop_signals.hpp"
#include "tools/slam-sim/output/udp_sender.hpp"
#include "tools/slam-sim/sensors/rplidar_device.hpp"
#include "tools/progress/progress.hpp"
#include "tools/slam-sim/program/run.hpp"

namespace slamd::sim {
namespace {

constexpr std::size_t kAhead = 12, kReady = 3;  // slices of half a second

std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

void sleep_until(std::int64_t ns) {
  const timespec when{ns / 1'000'000'000, ns % 1'000'000'000};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

/// Packets shall leave on time on a busy machine too. Without the privilege everything works, less punctually.
void raise_priority() {
  const sched_param priority{.sched_priority = 10};
  ::sched_setscheduler(0, SCHED_FIFO, &priority);
}

/// The cables: every event goes out of the port of its channel.
class Cables {
 public:
  Cables(const LiveOptions& options, const DriveSpec& drive)
      : serial_lidar_{drive.lidar_kind == LidarKind::kRplidarA2}, ports_{ports_of(drive.lidar_kind)}, udp_{options.udp_host}, rplidar_{drive.rplidar} {
    if (!options.lidar_pty.empty()) lidar_ = std::make_unique<PtyPort>(options.lidar_pty);
    if (options.ports.points != 0) ports_.points = options.ports.points;
    if (options.ports.side != 0) ports_.side = options.ports.side;
    if (options.ports.imu != 0) ports_.imu = options.ports.imu;
    if (!options.imu_pty.empty()) imu_ = std::make_unique<PtyPort>(options.imu_pty);
    if (!options.gps_pty.empty()) gps_ = std::make_unique<PtyPort>(options.gps_pty);
    if (!options.wheel_pty.empty()) wheel_ = std::make_unique<PtyPort>(options.wheel_pty);
  }

  void send(const WireEvent& event) {
    bool sent = true;
    switch (event.channel) {
      case Channel::kLidar:
        sent = serial_lidar_ ? !lidar_ || !rplidar_.is_scanning() || lidar_->write(event.bytes) : udp_.send(ports_.points, event.bytes);
        break;
      case Channel::kPosition:
        sent = udp_.send(ports_.side, event.bytes);
        break;
      case Channel::kLidarImu:
        sent = udp_.send(ports_.imu, event.bytes);
        break;
      case Channel::kImu:
        sent = !imu_ || imu_->write(event.bytes);
        break;
      case Channel::kGps:
        sent = !gps_ || gps_->write(event.bytes);
        break;
      case Channel::kWheel:
        sent = !wheel_ || wheel_->write(event.bytes);
        break;
    }
    unread_ += sent ? 0 : 1;
  }
  /// Commands of hosts to devices that take any.
  void answer() {
    if (!lidar_) return;
    const std::vector<std::uint8_t> answer = rplidar_.take(lidar_->read());
    if (!answer.empty()) lidar_->write(answer);
  }
  std::uint64_t unread() const { return unread_; }

 private:
  bool serial_lidar_;
  LidarPorts ports_;
  UdpSender udp_;
  RplidarDevice rplidar_;
  std::unique_ptr<PtyPort> lidar_, imu_, gps_, wheel_;
  std::uint64_t unread_ = 0;
};

/// Writes the truth up to the present, 100 poses a second.
class TruthFile {
 public:
  TruthFile(const std::string& path, const Trajectory& trajectory, std::int64_t start_ns)
      : file_{path.empty() ? nullptr : std::fopen(path.c_str(), "w"), &std::fclose},
        trajectory_{trajectory},
        start_ns_{start_ns} {
    if (!path.empty() && !file_) throw std::runtime_error(path + ": " + std::strerror(errno));
  }
  void write_until(double t) {
    if (!file_) return;
    for (; static_cast<double>(count_) * 0.01 <= t + 1e-9; ++count_) {
      write_tum_line(file_.get(), start_ns_ + count_ * 10'000'000,
                     trajectory_.pose_at(static_cast<double>(count_) * 0.01));
    }
    std::fflush(file_.get());
  }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  const Trajectory& trajectory_;
  std::int64_t start_ns_;
  std::int64_t count_ = 0;
};

}  // namespace

int run_live(const Options& options) {
  StopSignals stop;
  Cables cables{options.live_options, options.drive};
  Simulation simulation{options.drive};
  const double duration = simulation.duration();
  SliceQueue queue{simulation, kAhead};
  queue.wait_for(kReady);
  raise_priority();
  const std::int64_t start_ns = now_ns() + std::llround(options.live_options.start_delay_s * 1e9);
  if (!options.live_options.imu_motion.empty())
    write_imu_motion(options.live_options.imu_motion, simulation, options.drive.imu.gravity_mps2, start_ns);
  TruthFile truth{options.live_options.truth, simulation.trajectory(), start_ns};
  Progress progress{options.scenario, duration, options.quiet};
  std::int64_t worst_late_ns = 0;
  double time = 0.0;
  for (auto slice = queue.pop(); slice && !stop.pending(); slice = queue.pop()) {
    for (const WireEvent& event : *slice) {
      if (stop.pending()) break;
      sleep_until(start_ns + event.arrival_ns);
      cables.answer();
      cables.send(event);
      worst_late_ns = std::max(worst_late_ns, now_ns() - start_ns - event.arrival_ns);
      time = std::min(static_cast<double>(event.arrival_ns) * 1e-9, duration);
      progress.show(time);
    }
    truth.write_until(time);
  }
  char summary[160];
  std::snprintf(summary, sizeof summary, "%.1f s sent, latest packet %.2f ms late, %llu not taken by a reader%s", time,
                static_cast<double>(worst_late_ns) * 1e-6, static_cast<unsigned long long>(cables.unread()),
                stop.pending() ? " (interrupted)" : "");
  progress.finish(summary);
  return stop.pending() ? 130 : 0;
}

}  // namespace slamd::sim
