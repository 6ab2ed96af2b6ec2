#pragma once
// The C++ client of slamd's socket, header-only over the C interface of libslamd (client.h): connect, call, subscribe, take
// the map and the pose page. Blocking, one connection, one thread at a time. Nothing of the daemon is in it.

#include <slamd/client.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace slamd::client {

using Pose = slamd_pose;

/// Why a call has no result. code: negative where the daemon answered so (docs/protocol.md), else one of the constants.
class ClientError : public std::runtime_error {
 public:
  static constexpr int kNoConnection = SLAMD_NO_CONNECTION;
  static constexpr int kTimeout = SLAMD_TIMEOUT;
  static constexpr int kProtocol = SLAMD_PROTOCOL;
  static constexpr int kUsage = SLAMD_USAGE;
  static constexpr int kSystem = SLAMD_SYSTEM;

  ClientError(int code, const std::string& text) : std::runtime_error{text}, code_{code} {}
  int code() const { return code_; }

 private:
  int code_;
};

/// Throws what the C interface told.
inline void check(int code) {
  if (code != SLAMD_OK) throw ClientError{code, slamd_last_error()};
}

/// Owner of a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_{fd} {}
  Descriptor(Descriptor&& other) noexcept : fd_{std::exchange(other.fd_, -1)} {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_;
};

struct Notification {
  std::string topic;  // "pose", "status", "grid", "progress", "lost"
  nlohmann::json params;
};

struct Answer {
  nlohmann::json result;
  Descriptor fd;  // where the result says "fd": true
};

/// The occupancy grid of planar mode. cells: row by row from the lowest y; -1 unknown, 0 free, 100 occupied.
struct Grid {
  std::int64_t time_ns = 0;      // CLOCK_MONOTONIC, when it was made
  std::uint64_t changes = 0;     // grids so far
  double resolution_m = 0.0;
  double origin_x_m = 0.0, origin_y_m = 0.0;  // in map, of the lower left corner of the first cell
  std::uint32_t width = 0, height = 0;
  std::vector<std::int8_t> cells;
};

/// Shared memory with the newest pose. Any thread.
class PosePage {
 public:
  explicit PosePage(slamd_page* page) : page_{page} {}

  /// The newest pose, no system call, below 100 ns; nullopt before the daemon's first one, or when it died in the middle of
  /// a write. A page that no longer changes is a daemon that has gone: compare host_time_ns with CLOCK_MONOTONIC.
  std::optional<Pose> read() const {
    std::optional<Pose> pose{std::in_place};
    if (slamd_read_page(page_.get(), &*pose) == 0) pose.reset();
    return pose;
  }

  /// How many daemons have written this page. After a change odom and map begin anew, and sequence counts from 1.
  std::uint32_t starts() const { return slamd_page_starts(page_.get()); }

 private:
  struct Close {
    void operator()(slamd_page* page) const { slamd_close_page(page); }
  };
  std::unique_ptr<slamd_page, Close> page_;
};

class Connection {
 public:
  using Patience = std::chrono::milliseconds;

  /// Connects and agrees on the protocol's version. Throws ClientError, as all that follow.
  explicit Connection(const std::string& socket_path = "/run/slamd/slamd.sock", Patience patience = std::chrono::seconds{10}) {
    slamd_connection* connection = nullptr;
    check(slamd_connect(socket_path.c_str(), static_cast<int>(patience.count()), &connection));
    connection_.reset(connection);
  }

  /// One request and its answer. Notifications that come meanwhile wait for next(), except that `on_progress`, when
  /// given, is told of the request's progress (params as the protocol documents); it must not throw.
  using OnProgress = std::function<void(const nlohmann::json& params)>;
  Answer call(const std::string& method, const nlohmann::json& params = nlohmann::json::object(),
              OnProgress on_progress = {}) {
    const std::string text = params.dump();
    const slamd_request request{method.c_str(), text.c_str(), on_progress ? &tell : nullptr, &on_progress};
    slamd_answer answer{};
    check(slamd_call(connection_.get(), &request, &answer));
    Descriptor fd{answer.fd};
    return {nlohmann::json::parse(answer.result_json), std::move(fd)};
  }

  /// topic "pose", "status" or "grid"; then next() gives its notifications. The newest 10,000 that nobody took are kept.
  void subscribe(const std::string& topic, double rate_hz) {
    check(slamd_subscribe(connection_.get(), topic.c_str(), rate_hz));
  }
  void unsubscribe(const std::string& topic) { check(slamd_unsubscribe(connection_.get(), topic.c_str())); }

  /// The oldest notification not yet taken; waits for one up to the patience.
  Notification next() {
    const char *topic = nullptr, *params = nullptr;
    check(slamd_next(connection_.get(), &topic, &params));
    return {topic, nlohmann::json::parse(params)};
  }

  /// The oldest pose not yet taken, without its detour over JSON; other notifications stay for next().
  Pose next_pose() {
    Pose pose;
    check(slamd_next_pose(connection_.get(), &pose));
    return pose;
  }

  /// Read-only shared memory with the newest pose; stays readable after the connection has gone.
  PosePage pose_page() {
    slamd_page* page = nullptr;
    check(slamd_open_page(connection_.get(), &page));
    return PosePage{page};
  }

  /// The newest occupancy grid. Throws -32000 before the first one, -32007 when the daemon is not in planar mode.
  Grid grid() {
    const Answer answer = call("get_grid");
    const nlohmann::json& told = answer.result;
    Grid grid{told.at("time_ns"), told.at("changes"), told.at("resolution_m"), told.at("origin_m").at(0), told.at("origin_m").at(1),
              told.at("width"), told.at("height"), {}};
    grid.cells.resize(std::size_t{grid.width} * grid.height);
    std::size_t done = 0;
    while (done < grid.cells.size()) {
      const ssize_t count = ::pread(answer.fd.get(), grid.cells.data() + done, grid.cells.size() - done, static_cast<off_t>(done));
      if (count <= 0) throw ClientError{ClientError::kProtocol, "the grid is not as large as it says"};
      done += static_cast<std::size_t>(count);
    }
    return grid;
  }

  /// The daemon's answer to "version".
  nlohmann::json version() const { return nlohmann::json::parse(slamd_version(connection_.get())); }

 private:
  static void tell(void* on_progress, const char* params) {
    (*static_cast<OnProgress*>(on_progress))(nlohmann::json::parse(params));
  }
  struct Disconnect {
    void operator()(slamd_connection* connection) const { slamd_disconnect(connection); }
  };
  std::unique_ptr<slamd_connection, Disconnect> connection_;
};

/// Copies all of a descriptor's content to `path`, by way of a temporary file beside it that is then renamed.
/// on_bytes, when given, is told how much is written; it must not throw.
inline void save_fd(int fd, const std::string& path, std::function<void(std::size_t bytes)> on_bytes = {}) {
  const auto tell = [](void* told, std::size_t bytes) { (*static_cast<std::function<void(std::size_t)>*>(told))(bytes); };
  check(slamd_save_fd(fd, path.c_str(), on_bytes ? +tell : nullptr, &on_bytes));
}

}  // namespace slamd::client
