#include "daemon/app.hpp"

#include <array>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/app_parts.hpp"
#include "daemon/server/host_clock.hpp"
#include "daemon/threads/source_health.hpp"

namespace slamd {
namespace {

/// The present in UTC, as a part of a file's name.
std::string utc_name() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text;
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return {text.data(), size};
}

}  // namespace

Result<std::unique_ptr<App>> App::open(const Config& config, const std::string& version,
                                       const std::string& record_folder, UniqueFd kept_page) {
  if (config.real_time.lock_memory) keep_stacks_small();
  Result<PosePublisher> publisher = PosePublisher::create(std::move(kept_page));
  if (!publisher) return Error{publisher.reason()};
  auto streams = std::make_unique<Streams>();
  Result<std::unique_ptr<LidarThread>> lidar = LidarThread::open(config.lidar, config.lidar_decoder, *streams);
  if (!lidar) return Error{lidar.reason()};

  const std::string checkpoint = config.mode == "planar" ? "" : config.checkpoint.path();
  Result<StoredMap> left = checkpoint.empty() ? StoredMap{} : by_this_clock(load_checkpoint(checkpoint, config.vehicle));
  const Config running = with_what_was_learnt(config, left);
  Result<std::unique_ptr<Recorder>> recorder = Recorder::open(record_folder, print_config(running), config.flight_recorder,
                                                               recorded_file(config.lidar));
  if (!recorder) return Error{recorder.reason()};

  std::unique_ptr<App> app{
      new App{config, running, version, std::move(publisher).value(), std::move(streams), std::move(lidar).value()}};
  if (app->is_planar()) app->resume(load_planar_checkpoint(planar_checkpoint_path(config.checkpoint), config.vehicle));
  else app->resume(std::move(left));
  const Result<void> recording = app->record(std::move(recorder).value(), running, record_folder);
  if (!recording) return Error{recording.reason()};
  if (!record_folder.empty()) app->watch_recording();
  return app;
}

/// Whether there is a map of the daemon before this one to be taken over, for the log.
bool App::tell_checkpoint(const char* refused, std::size_t keyframes) {
  supervisor_.watch_source("checkpoint", [this] {
    const CheckpointReport report = checkpoint_report();
    SourceHealth health;
    health.state = report.state == "failed" ? "failed" : "healthy";
    health.reason = report.reason;
    return health;
  });
  if (refused != nullptr) {
    log_.write(LogLevel::kWarning, std::string{"checkpoint state=refused, the map begins anew: reason=\""} + refused + '"');
  } else if (keyframes == 0) {
    log_.write(LogLevel::kInfo, "checkpoint state=none, the map begins anew");
  } else {
    log_.write(LogLevel::kInfo, "checkpoint state=read keyframes=" + std::to_string(keyframes));
  }
  return refused == nullptr && keyframes > 0;
}

/// Takes over the map of the daemon before this one; whether the vehicle is still in it is for the first scans to say.
void App::resume(Result<StoredMap> map) {
  mapping_.keep_checkpoints(checkpoints_);
  if (config_.checkpoint.path().empty()) return;
  if (!tell_checkpoint(map ? nullptr : map.reason(), map ? map->keyframes.size() : 0)) return;
  imu_.begin_at(map->T_map_base);
  mapping_.restore(std::move(map).value(), config_.back_end.loops.clouds.grid);
}

void App::resume(const Result<StoredPlanarMap>& map) {
  if (config_.checkpoint.path().empty()) return;
  if (!tell_checkpoint(map ? nullptr : map.reason(), map ? map->size() : 0)) return;
  const Eigen::Vector3d& last = map->back().pose;
  imu_.begin_at({Eigen::Quaterniond{Eigen::AngleAxisd{last[2], Eigen::Vector3d::UnitZ()}}, {last[0], last[1], 0.0}});
  planar_mapping_->restore(*map);
}

CheckpointReport App::checkpoint_report() const { return is_planar() ? planar_mapping_->state().checkpoint : checkpoints_.report(); }

RelocaliserCounts App::relocalisation() const {
  return is_planar() ? planar_mapping_->state().relocalisation : mapping_.state().relocalisation;
}

/// target  a file that ends in .mcap is recorded from now on; a folder is the recorder's own affair
Result<void> App::record(std::unique_ptr<Recorder> recorder, const Config& running, const std::string& target) {
  recorder_ = std::move(recorder);
  const RecordedDrivers drivers{lidar_model(running.lidar.model).value_or(LidarModel::kVlp16), running.lidar.port, running.lidar.position_port,
                                running.lidar_decoder, running.imu_frames, running.nmea, running.odometry.scans.assembler, running.vehicle};
  const Result<void> begun = recorder_->allow_mcap(
      std::make_unique<McapRecorder>(running.recording, print_config(running), drivers, [this] { return publisher_.newest(); }), target);
  lidar_->record_to(recorder_->lidar());
  imu_.record_to(recorder_->imu());
  gnss_.record_to(recorder_->gnss());
  wheel_.record_to(recorder_->wheel());
  estimator_.record_to(recorder_->limited());
  add_ring("record_lidar", [this] { return recorder_->lidar().counts(); });
  add_ring("record_imu", [this] { return recorder_->imu().counts(); });
  add_ring("record_gnss", [this] { return recorder_->gnss().counts(); });
  health_.add_object("flight_recorder", [this] {
    return nlohmann::json{{"bytes", recorder_->kept_bytes()}, {"dumps", recorder_->dumps()}, {"failed_dumps", recorder_->failed_dumps()}};
  });
  health_.add_object("recording", [this] { return to_json(recorder_->mcap()->report()); });
  return begun;
}

RecordingControl App::recording_control() {
  const auto start = [this](const std::string& name, double max_s, double max_bytes) {
    return recorder_->mcap()->start({name, static_cast<std::uint64_t>(max_bytes), from_seconds(max_s)});
  };
  const auto stop = [this]() -> Result<nlohmann::json> {
    const Result<RecordingReport> recorded = recorder_->mcap()->stop();
    if (!recorded) return Error{recorded.reason()};
    return nlohmann::json{{"path", recorded->path}, {"bytes", recorded->bytes}, {"messages", recorded->messages}, {"seconds", recorded->seconds}};
  };
  return {start, stop};
}

void App::watch_recording() {
  supervisor_.watch_source("recording", [this] {
    SourceHealth health;
    const bool failed = recorder_->failed() || recorder_->mcap()->report().state == std::string_view{"failed"};
    health.state = failed ? "failed" : "healthy";
    return health;
  });
}

App::App(const Config& configured, const Config& config, const std::string& version, PosePublisher publisher,
         std::unique_ptr<Streams> streams, std::unique_ptr<LidarThread> lidar)
    : config_{configured},
      log_{config.log},
      publisher_{std::move(publisher)},
      map_{config.map, config.vehicle.T_base_lidar},
      streams_{std::move(streams)},
      lidar_{std::move(lidar)},
      imu_{config.imu, config.imu_frames,
           PosePredictor{config.vehicle, config.odometry.dead_reckoning, config.odometry.imu}, *streams_,
           publisher_},
      gnss_{config.gnss, config.nmea, *streams_},
      wheel_{config.wheel, *streams_},
      estimator_{config.estimator, make_front_end(config, *streams_), *streams_},
      checkpoints_{config.checkpoint, configured.vehicle},
      mapping_{make_relocaliser(config.back_end, config.vehicle), *streams_, map_, trajectory_},
      planar_mapping_{is_planar() ? std::make_unique<PlanarMappingThread>(config.planar, PlanarKeeper{config.checkpoint, configured.vehicle},
                                                                          *streams_, grid_, trajectory_)
                                  : nullptr},
      health_{host_now()},
      supervisor_{config.log.repeat_period,
                  [this](LogLevel level, const std::string& line) { log_.write(level, line); }},
      server_{config.server,
              {publisher_, map_, trajectory_, health_, config.health.allow_inject ? &streams_->faults : nullptr,
               [this](const std::string& name) {
                 return recorder_->dump(name.empty() ? "dump-" + utc_name() : name, "asked for by a client");
               },
               [this](const PushedOdometry& pushed) {
                 return wheel_.push({pushed.device_us, pushed.x_m, pushed.y_m, pushed.yaw_rad}, host_now());
               },
               is_planar() ? &grid_ : nullptr, recording_control()},
              version} {
  register_probes();
  if (config.health.allow_inject) allow_faults();
}

Result<void> App::start(UniqueFd listening) {
  const RealTimeConfig& rt = config_.real_time;
  std::set<std::string> refusals;
  if (const Result<void> locked = rt.lock_memory ? lock_memory() : Result<void>{}; !locked) refusals.insert(locked.reason());
  if (rt.cpu_latency_us >= 0) {
    Result<UniqueFd> limit = limit_cpu_latency(rt.cpu_latency_us);
    if (limit) cpu_latency_ = std::move(limit).value();
    else refusals.insert(limit.reason());
  }
  start_thread({"slamd-recorder"}, *recorder_);
  if (is_planar()) {
    start_thread({"slamd-mapping"}, *planar_mapping_);
  } else {
    start_thread({"slamd-checkpoint"}, checkpoints_);
    start_thread({"slamd-mapping"}, mapping_);
  }
  start_thread({"slamd-estimator", rt.estimator_priority, rt.estimator_cpu}, estimator_);
  start_thread({"slamd-gnss", rt.gnss_priority, rt.driver_cpu}, gnss_);
  start_thread({"slamd-wheel", rt.gnss_priority, rt.driver_cpu}, wheel_);
  start_thread({"slamd-imu", rt.imu_priority, rt.driver_cpu}, imu_);
  start_thread({"slamd-lidar", rt.lidar_priority, rt.driver_cpu}, *lidar_);
  tell_refusals(std::move(refusals));
  const Result<void> served = server_.start(std::move(listening));
  if (!served) stop();
  return served;
}

bool App::supervise() {
  supervisor_.look(host_now());
  tell_map_events();
  dump_when_lost(host_now());
  for (const auto& worker : workers_) {
    if (!worker->failed()) continue;
    log_.write(LogLevel::kError, std::string{"thread state=failed name="} + worker->name());
    return false;
  }
  return true;
}

/// Once in the span that a dump holds: one that follows sooner has the same in it.
void App::dump_when_lost(HostTime now) {
  const std::optional<PoseSample> newest = publisher_.newest();
  const bool lost = newest && newest->status == static_cast<std::uint32_t>(TrackingStatus::kLost);
  const bool fell = lost && !std::exchange(was_lost_, lost);
  was_lost_ = lost;
  if (!fell || (dumped_at_ != HostTime{} && now - dumped_at_ < config_.flight_recorder.span)) return;
  dumped_at_ = now;
  const std::string name = "lost-" + utc_name();
  recorder_->request_dump(name, "the status fell to LOST");
  log_.write(LogLevel::kWarning, "flight_recorder state=dumping name=" + name);
}

/// Rare and for good, so each has a line of its own.
void App::tell_map_events() {
  const RelocaliserCounts now = relocalisation();
  if (now.relocalised != told_map_events_.relocalised) log_.write(LogLevel::kInfo, "map state=relocalised");
  if (now.begun_anew != told_map_events_.begun_anew) {
    log_.write(LogLevel::kWarning, "map state=begun_anew, continuing: the place was not recognised, the map of before is gone");
  }
  told_map_events_ = now;
}

std::vector<std::string> App::reload(const Config& wanted) {
  const ConfigChanges changed = changes(config_, wanted);
  if (!changed.fixed.empty()) return changed.fixed;
  config_.server = wanted.server;
  config_.log = wanted.log;
  server_.reconfigure(config_.server);
  supervisor_.set_repeat_period(config_.log.repeat_period);
  return {};
}

void App::watch(Watchdog& watchdog) {
  watchdog.watch("estimator", [this] { return estimator_.passes(); });
  watchdog.watch("imu", [this] { return imu_.passes(); });
  watchdog.watch("server", [this] { return server_.heartbeats(); });
}

void App::stop() {
  if (workers_.empty()) return;
  hurry(pthread_self());
  for (const auto& worker : workers_) worker->hurry();
  std::string slowest;
  Duration longest{-1};
  const HostTime begin = host_now();
  const auto end = [&](const std::string& part, const auto& stop_it) {
    const HostTime asked = host_now();
    stop_it();
    const Duration took = host_now() - asked;
    if (took <= longest) return;
    longest = took;
    slowest = part;
  };
  end("slamd-server", [this] { server_.stop(); });
  while (!workers_.empty()) end(workers_.back()->name(), [this] { workers_.pop_back(); });
  log_.write(LogLevel::kInfo, "service state=stopped took_s=" + std::to_string(to_seconds(host_now() - begin)) +
                                  " slowest=" + slowest + " slowest_s=" + std::to_string(to_seconds(longest)));
}

template <class Part>
void App::start_thread(const ThreadSchedule& schedule, Part& part) {
  workers_.push_back(std::make_unique<Worker>(schedule, [&part](const std::stop_token& stop) { part.run(stop); }));
}

void App::tell_refusals(std::set<std::string> reasons) {
  for (const auto& worker : workers_) {
    if (!worker->scheduled()) reasons.insert(worker->scheduled().reason());
  }
  for (const std::string& reason : reasons) {
    log_.write(LogLevel::kWarning, "real_time state=refused, continuing without: reason=\"" + reason + "\"");
  }
}

void App::register_probes() {
  register_sensors();
  add_ring("lidar", [this] { return streams_->lidar.counts(); });
  add_ring("imu", [this] { return streams_->imu.counts(); });
  add_ring("gnss", [this] { return streams_->gnss.counts(); });
  add_ring("keyframes", [this] { return is_planar() ? streams_->planar_keyframes.counts() : streams_->keyframes.counts(); });

  health_.add_stage("scan", estimator_.scan_time());
  health_.add_stage("scan_end_to_posterior", estimator_.scan_latency());
  health_.add_stage("imu_to_page", imu_.imu_to_page());
  health_.add_count("scans", [this] { return estimator_.scans(); });
  health_.add_count("late_events", [this] { return estimator_.late_events(); });
  health_.add_count("scans_thinned", [this] { return estimator_.thinned_scans(); });
  health_.add_count("scans_let_go", [this] { return estimator_.scans_let_go(); });
  supervisor_.watch_ring("scans", [this] {
    RingCounts counts;
    counts.dropped = estimator_.scans_let_go();
    return counts;
  });
  health_.add_count("keyframes", [this] { return estimator_.keyframes(); });
  health_.add_count("gnss_fixes", [this] { return mapping_.fixes(); });
  health_.add_object("back_end", [this] { return is_planar() ? to_json(planar_mapping_->state()) : to_json(mapping_.state()); });
  health_.add_object("checkpoint", [this] { return to_json(checkpoint_report()); });
  health_.add_count("log_lines_lost", [this] { return log_.lost(); });
  supervisor_.watch_pose([this] { return publisher_.newest(); });
  watch_budgets();
}

void App::watch_budgets() {
  supervisor_.watch_budget({"map", "without the oldest", [this] { return map_.counts().evicted_keyframes; }});
  supervisor_.watch_budget({"loops", "without loops to the oldest", [this] { return mapping_.state().forgotten_clouds; }});
  supervisor_.watch_budget({"graph", "by odometry alone", [this] { return mapping_.state().left_out_keyframes; }});
}

void App::register_sensors() {
  const auto add = [this](const std::string& name, const std::string& device, const SensorPatience& patience,
                          SensorWatch::Probe evidence, HealthBoard::SourceProbe counts) {
    const SensorWatch& watch = supervisor_.watch_sensor(patience, std::move(evidence));
    add_source(name, [=, &watch] {
      SourceHealth health = judged(counts(), watch.condition());
      health.device = device;
      return health;
    });
  };
  add("lidar", device_name(config_.lidar), config_.health.lidar,
      [this](HostTime now) { return evidence(lidar_->report(), publisher_.newest(), now); },
      [this] { return source_health(lidar_->report()); });
  add("imu", device_name(config_.imu.source), config_.health.imu,
      [this](HostTime) { return evidence(imu_.report(), publisher_.newest()); },
      [this] { return source_health(imu_.report()); });
  add("gnss", config_.gnss.serial.path, config_.health.gnss,
      [this](HostTime) { return evidence(gnss_.report(), mapping_.state().gnss); },
      [this] { return source_health(gnss_.report()); });
  const HealthBoard::SourceProbe wheel = [this] {
    SourceHealth health = source_health(wheel_.report());
    health.device = config_.wheel.serial.path;
    health.state = health.received == 0 ? "absent" : "healthy";
    health.reason = "none";
    return health;
  };
  health_.add_source("wheel", wheel);
  if (!config_.wheel.serial.path.empty()) supervisor_.watch_source("wheel", wheel);
}

void App::allow_faults() {
  lidar_->allow_faults();
  imu_.allow_faults();
  gnss_.allow_faults();
  const auto played = [this] {
    const HostTime now = host_now();
    const FaultBoard& board = streams_->faults;
    const std::initializer_list<std::pair<const char*, const FaultSwitch*>> switches{
        {"lidar", &board.lidar}, {"imu", &board.imu}, {"gnss", &board.gnss}};
    nlohmann::json all = nlohmann::json::object();
    for (const auto& [sensor, each] : switches) {
      if (each->verb(now) == FaultVerb::kNone) continue;
      all[sensor] = {{"verb", name(each->verb(now))}, {"left_s", each->seconds_left(now)}};
    }
    return all;
  };
  health_.add_object("injected", played);
  supervisor_.watch_source("injection", [played] {
    SourceHealth health;
    const nlohmann::json all = played();
    for (const auto& [sensor, each] : all.items()) {
      health.reason += (health.reason.empty() ? "" : ",") + sensor + "_" + each.at("verb").get<std::string>();
    }
    health.state = health.reason.empty() ? "healthy" : "failing";
    return health;
  });
}

void App::add_source(const std::string& name, const HealthBoard::SourceProbe& probe) {
  health_.add_source(name, probe);
  supervisor_.watch_source(name, probe);
}

void App::add_ring(const std::string& name, const HealthBoard::RingProbe& probe) {
  health_.add_ring(name, probe);
  supervisor_.watch_ring(name, probe);
}

}  // namespace slamd
