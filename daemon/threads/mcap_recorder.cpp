#include "daemon/threads/mcap_recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/store/file_name.hpp"
#include "daemon/threads/state_directory.hpp"

namespace slamd {
namespace {

constexpr Duration kFlushPeriod = std::chrono::seconds{1};  // what a crash costs at most

}  // namespace

nlohmann::json to_json(const RecordingReport& report) {
  return {{"state", report.state}, {"reason", report.reason},     {"path", report.path},
          {"bytes", report.bytes}, {"messages", report.messages}, {"seconds", report.seconds}};
}

std::string RecordingConfig::recording_folder() const {
  if (!folder.empty()) return folder;
  const std::string state = state_directory();
  return state.empty() ? state : state + "/recordings";
}

McapRecorder::McapRecorder(RecordingConfig config, std::string config_yaml, const RecordedDrivers& drivers, PoseSource poses)
    : config_{std::move(config)}, config_yaml_{std::move(config_yaml)}, drivers_{drivers}, poses_{std::move(poses)} {}

Result<std::string> McapRecorder::start(const RecordingWish& wish) {
  const std::string folder = config_.recording_folder();
  if (folder.empty()) return Error{"no folder for recordings is configured (recording.folder)"};
  if (!is_plain_file_name(wish.name) || !wish.name.ends_with(".mcap")) return Error{"the name must be a plain file name that ends in .mcap"};
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{"the folder of recordings cannot be made"};
  return start_at(folder + '/' + wish.name, wish);
}

Result<std::string> McapRecorder::start_at(const std::string& path, const RecordingWish& wish) {
  const std::lock_guard lock{mutex_};
  if (open_) return Error{"something is being recorded already"};
  Result<std::unique_ptr<McapRecording>> opened = McapRecording::open(path, config_yaml_, drivers_, host_to_utc());
  if (!opened) return Error{opened.reason()};
  open_ = std::move(opened).value();
  limits_ = wish;
  if (limits_.max_bytes == 0 || limits_.max_bytes > config_.max_bytes) limits_.max_bytes = config_.max_bytes;
  if (limits_.max_length == Duration{} || limits_.max_length > config_.max_length) limits_.max_length = config_.max_length;
  begun_ = host_now();
  flushed_ = HostTime{};
  pose_sequence_ = 0;
  now_ = {.state = "recording", .reason = "", .path = path};
  tell(now_);
  return path;
}

Result<RecordingReport> McapRecorder::stop() {
  const std::lock_guard lock{mutex_};
  if (!open_) return Error{"nothing is being recorded"};
  end("finished", "asked for");
  if (now_.state == std::string_view{"failed"}) return Error{now_.reason};
  return now_;
}

RecordingReport McapRecorder::report() const {
  const std::lock_guard lock{report_mutex_};
  return report_;
}

void McapRecorder::tell(const RecordingReport& report) {
  const std::lock_guard lock{report_mutex_};
  report_ = report;
}

void McapRecorder::take(RecordedWire wire, const UdpPacket& read) {
  const std::lock_guard lock{mutex_};
  if (open_) open_->take(wire, read);
}

void McapRecorder::take(const LimitedScan& scan) {
  const std::lock_guard lock{mutex_};
  if (open_) open_->take(scan);
}

void McapRecorder::settle(HostTime now) {
  const std::lock_guard lock{mutex_};
  if (!open_) return;
  const std::optional<PoseSample> pose = poses_ ? poses_() : std::nullopt;
  if (pose && std::exchange(pose_sequence_, pose->sequence) != pose->sequence) open_->take(*pose);
  now_.bytes = open_->bytes();
  now_.messages = open_->messages();
  now_.seconds = to_seconds(now - begun_);
  tell(now_);
  if (now_.bytes >= limits_.max_bytes) return end("finished", "max_bytes reached");
  if (now - begun_ >= limits_.max_length) return end("finished", "max_s reached");
  if (now - flushed_ < kFlushPeriod) return;
  flushed_ = now;
  open_->repeat_transforms(now);
  if (const Result<void> flushed = open_->flush(); !flushed) end("failed", flushed.reason());
}

void McapRecorder::finish() {
  const std::lock_guard lock{mutex_};
  if (open_) end("finished", "the daemon ended");
}

/// With the mutex and an open recording.
void McapRecorder::end(const char* state, const char* reason) {
  const Result<void> finished = open_->finish();
  now_.bytes = open_->bytes();
  now_.messages = open_->messages();
  now_.state = finished ? state : "failed";
  now_.reason = finished ? reason : finished.reason();
  open_.reset();
  tell(now_);
}

}  // namespace slamd
