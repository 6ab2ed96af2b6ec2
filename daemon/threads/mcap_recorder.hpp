#pragma once
// MCAP recordings that begin and end when somebody asks, within limits of size and time. Handed what the recorder's thread has
// taken off its rings; no real-time thread calls in here.

#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "daemon/threads/mcap_recording.hpp"

namespace slamd {

struct RecordingConfig {
  std::string folder;                                // empty: "recordings" in the service manager's state directory
  std::uint64_t max_bytes = std::uint64_t{8} << 30U;  // of one file; then it is closed
  Duration max_length = std::chrono::hours{2};       // likewise

  /// Where recordings go; empty: nowhere.
  std::string recording_folder() const;
};

/// Of the newest recording.
struct RecordingReport {
  const char* state = "none";  // none, recording, finished, failed
  const char* reason = "";     // why it ended, or failed
  std::string path;
  std::uint64_t bytes = 0, messages = 0;
  double seconds = 0.0;
};

nlohmann::json to_json(const RecordingReport& report);

/// What a client may ask for within the configured limits; 0: these.
struct RecordingWish {
  std::string name;  // plain file name that ends in .mcap
  std::uint64_t max_bytes = 0;
  Duration max_length{};
};

class McapRecorder {
 public:
  using PoseSource = std::function<std::optional<PoseSample>()>;

  /// poses  the newest pose, from any thread; may be empty
  McapRecorder(RecordingConfig config, std::string config_yaml, const RecordedDrivers& drivers, PoseSource poses);

  // Any thread but the recorder's.
  /// The path of the file, made in the configured folder. Fails when one is being recorded.
  Result<std::string> start(const RecordingWish& wish);
  /// Fails when none is being recorded, or the file could not be written to its end.
  Result<RecordingReport> stop();
  RecordingReport report() const;

  /// Before the threads: records to this very path, by the configured limits.
  Result<std::string> start_at(const std::string& path, const RecordingWish& limits);

  // The recorder's thread.
  void take(RecordedWire wire, const UdpPacket& read);
  void take(const LimitedScan& scan);
  /// After each look at the rings: the newest pose, what is due to the disk, the limits.
  void settle(HostTime now);
  /// At the thread's end.
  void finish();

 private:
  void end(const char* state, const char* reason);
  void tell(const RecordingReport& report);

  const RecordingConfig config_;
  const std::string config_yaml_;
  const RecordedDrivers drivers_;
  const PoseSource poses_;
  mutable std::mutex mutex_;  // over what follows
  std::unique_ptr<McapRecording> open_;  // null: nothing is recorded
  RecordingWish limits_;
  RecordingReport now_;
  HostTime begun_, flushed_;
  std::uint64_t pose_sequence_ = 0;  // of the newest recorded
  mutable std::mutex report_mutex_;  // of its own: a status does not wait for the disk
  RecordingReport report_;
};

}  // namespace slamd
