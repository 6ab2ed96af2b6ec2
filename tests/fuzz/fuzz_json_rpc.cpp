// Any bytes as a request line: the answer is one line of valid JSON-RPC with a result or an error, or nothing when the
// line was a request without an id. Nothing is written, whatever the line asks.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "daemon/server/methods.hpp"
#include "daemon/server/protocol/protocol.hpp"

namespace {

using namespace slamd;

[[noreturn]] void fail() { std::abort(); }

struct Daemon {
  ServerConfig config{.socket_path = "", .save_dir = "/nonexistent", .limits = {}};
  PosePublisher pose = PosePublisher::create().value();
  MapStore map;
  TrajectoryStore trajectory;
  HealthBoard health{HostTime{}};
  Methods methods{config, {pose, map, trajectory, health}, "fuzz", [] { return nlohmann::json::object(); }};
  Subscriptions subscriptions;

  Daemon() {
    Keyframe keyframe;
    for (int i = 0; i < 20; ++i) keyframe.points.push_back({static_cast<float>(i), 1.0F, 2.0F, 3.0F});
    map.add(keyframe);
    trajectory.add(from_ns<HostTime>(1), Pose{});
    pose.publish(NavState{});
  }
};

std::string text_of(const nlohmann::json& id, const Outcome& outcome) {
  if (const RpcError* error = std::get_if<RpcError>(&outcome)) return error_line(id, *error);
  return result_line(id, std::get<Reply>(outcome).result);
}

std::string answer(Daemon& daemon, const RpcRequest& request) {
  Methods::Handled handled = daemon.methods.call(request, Right::kControl, daemon.subscriptions);
  if (Job* job = std::get_if<Job>(&handled)) {
    return text_of(request.id, job->work([](const char*, double) { return true; }));
  }
  if (RpcError* error = std::get_if<RpcError>(&handled)) return error_line(request.id, *error);
  return result_line(request.id, std::get<Reply>(handled).result);
}

void check(const std::string& line, const nlohmann::json& id) {
  if (line.empty() || line.find('\n') != line.size() - 1) fail();
  const nlohmann::json message = nlohmann::json::parse(line, nullptr, false);
  if (!message.is_object() || message.value("jsonrpc", "") != "2.0") fail();
  if (message.contains("result") == message.contains("error")) fail();
  if (!message.contains("id") || message["id"] != id) fail();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static Daemon daemon;
  const std::string_view line{reinterpret_cast<const char*>(bytes), size};
  const auto parsed = parse_request(line);
  if (const RpcFault* fault = std::get_if<RpcFault>(&parsed)) {
    check(error_line(fault->id, fault->error), fault->id);
    return 0;
  }
  const RpcRequest& request = std::get<RpcRequest>(parsed);
  check(answer(daemon, request), request.id);
  return 0;
}
