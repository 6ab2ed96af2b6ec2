#pragma once
// The methods of the protocol: a request's name and parameters in, an answer or a job out. Knows no socket and no thread;
// quick methods answer at once, slow ones give a job for whoever has a thread to spare.

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/json_rpc.hpp"
#include "daemon/server/params.hpp"
#include "daemon/server/server.hpp"
#include "daemon/server/subscriptions.hpp"

namespace slamd {

struct Reply {
  nlohmann::json result;
  UniqueFd fd;
};
using Outcome = std::variant<Reply, RpcError>;

/// What a client may do: everybody who may connect may read, not everybody may write.
enum class Right { kRead, kControl };

/// Told the stage and its share done; false = nobody wants the result any more.
using JobProgress = std::function<bool(const char* stage, double share)>;
struct Job {
  std::function<Outcome(const JobProgress&)> work;  // any thread; touches only the stores and files
  bool tell_progress = false;
};

class Methods {
 public:
  using Handled = std::variant<Reply, RpcError, Job>;
  using CountsSource = std::function<nlohmann::json()>;

  /// server_counts  gives what get_status shows under "server"
  Methods(const ServerConfig& config, const ServerSources& sources, std::string version, CountsSource server_counts);

  /// Server's thread. Does what the request asks; bad parameters, unknown names and a missing right are errors, never
  /// exceptions.
  Handled call(const RpcRequest& request, Right right, Subscriptions& subscriptions);

  /// What get_status gives: at most kStatusAge old, so that many clients that ask cost no more than one.
  const nlohmann::json& status();
  /// The next status() is a new one.
  void outdate_status() { status_ = nullptr; }
  static constexpr Duration kStatusAge = std::chrono::milliseconds{100};

 private:
  struct Entry;  // one method: its name, the right it needs and what does it
  static std::span<const Entry> entries();

  nlohmann::json fresh_status(HostTime now) const;
  Handled tell_status(Params& params);
  Handled version(Params& params) const;
  Handled pose(Params& params) const;
  Handled subscribe(Params& params, Subscriptions& subscriptions) const;
  Handled unsubscribe(Params& params, Subscriptions& subscriptions) const;
  Handled pose_page(Params& params) const;
  Handled map(Params& params) const;
  Handled save_map(Params& params) const;
  Handled grid(Params& params) const;
  Handled trajectory(Params& params) const;
  Handled inject(Params& params) const;
  Handled dump(Params& params) const;
  Handled push_odometry(Params& params) const;
  Handled start_recording(Params& params) const;
  Handled stop_recording(Params& params) const;

  const ServerConfig& config_;
  ServerSources sources_;
  std::string version_;
  CountsSource server_counts_;
  nlohmann::json status_;
  HostTime status_time_;
};

}  // namespace slamd
