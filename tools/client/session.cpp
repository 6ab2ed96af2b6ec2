#include "tools/client/session.hpp"

#include <slamd/client.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "daemon/server/protocol/protocol.hpp"
#include "estimator/types/nav_state.hpp"

namespace slamd::client {
namespace {

using nlohmann::json;

constexpr std::size_t kMostNotifications = 10'000;

[[noreturn]] void fail(int code, const std::string& text) { throw Failure{code, text}; }

bool is_notification(const json& message) {
  return message.contains("method") && message["method"].is_string() && message.contains("params");
}

std::uint32_t status_of(const std::string& text) {
  for (std::uint32_t value = SLAMD_INITIALISING; value <= SLAMD_LOST; ++value) {
    if (text == name(static_cast<TrackingStatus>(value))) return value;
  }
  return SLAMD_LOST;  // of a later daemon: not to be trusted
}

/// Bits of the names; those of a later daemon are not known here and left out.
std::uint32_t reasons_of(const json& names) {
  std::uint32_t bits = 0;
  for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
    if (std::find(names.begin(), names.end(), name(static_cast<StatusReason>(bit))) != names.end()) bits |= bit;
  }
  return bits;
}

}  // namespace

Session::Session(const std::string& socket_path, std::chrono::milliseconds patience)
    : socket_{socket_path}, patience_{patience} {
  if (!socket_.connected()) fail(SLAMD_NO_CONNECTION, socket_path + ": " + std::strerror(errno));
  version_ = call(protocol::method::kVersion, {{"protocol", protocol::kVersion}}).result;
}

Session::Reply Session::call(const std::string& method, json params, const OnProgress& on_progress) {
  const std::int64_t id = ++last_id_;
  const json request{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(params)}};
  if (!socket_.send(request.dump() + '\n')) fail(SLAMD_NO_CONNECTION, "the daemon has hung up");
  while (true) {
    json message = receive();
    if (message.contains("method")) {
      const bool is_progress = is_notification(message) && message["method"] == protocol::notification::kProgress;
      is_progress && on_progress ? on_progress(message["params"]) : keep(std::move(message));
      continue;
    }
    if (const auto error = message.find("error"); error != message.end()) {
      fail(error->value("code", int{SLAMD_PROTOCOL}), error->value("message", "error"));
    }
    if (!message.contains("result")) continue;
    Reply reply{std::move(message["result"]), {}};
    const bool has_fd = reply.result.is_object() && reply.result.value(protocol::kFdField, false);
    if (has_fd && !(reply.fd = socket_.take_fd())) fail(SLAMD_PROTOCOL, "the answer came without its file descriptor");
    if (message.value("id", json{}) == id) return reply;  // else of a call given up before
  }
}

json Session::next(const char* method) {
  const auto wanted = [method](const json& message) { return method == nullptr || message["method"] == method; };
  const auto found = std::find_if(notifications_.begin(), notifications_.end(), wanted);
  if (found != notifications_.end()) {
    json notification = std::move(*found);
    notifications_.erase(found);
    return notification;
  }
  while (true) {
    json message = receive();
    if (is_notification(message) && wanted(message)) return message;
    keep(std::move(message));
  }
}

void Session::keep(json message) {
  if (!is_notification(message)) return;
  if (notifications_.size() == kMostNotifications) notifications_.pop_front();
  notifications_.push_back(std::move(message));
}

json Session::receive() {
  switch (socket_.receive(patience_)) {
    case LineSocket::Received::kTimeout:
      fail(SLAMD_TIMEOUT, "no answer from the daemon in time");
    case LineSocket::Received::kHungUp:
      fail(SLAMD_NO_CONNECTION, "the daemon has hung up");
    case LineSocket::Received::kTooLong:
      fail(SLAMD_PROTOCOL, "endless line from the daemon");
    case LineSocket::Received::kLine:
      break;
  }
  json message = json::parse(socket_.line(), nullptr, false);
  if (!message.is_object()) fail(SLAMD_PROTOCOL, "the daemon sent what is not JSON-RPC");
  return message;
}

PoseSample pose_of(const json& params) {
  PoseSample sample;
  const auto take = [](const json& from, auto& values) { values = from.get<std::remove_reference_t<decltype(values)>>(); };
  take(params.at("time_ns"), sample.host_time_ns);
  if (!params.at("utc_offset_ns").is_null()) take(params["utc_offset_ns"], sample.utc_offset_ns);
  take(params.at("sequence"), sample.sequence);
  take(params.at("T_map_base").at("translation_m"), sample.map_position_m);
  take(params["T_map_base"].at("rotation_quat_xyzw"), sample.map_rotation_xyzw);
  take(params.at("T_odom_base").at("translation_m"), sample.odom_position_m);
  take(params["T_odom_base"].at("rotation_quat_xyzw"), sample.odom_rotation_xyzw);
  take(params.at("velocity_mps"), sample.velocity_mps);
  take(params.at("angular_velocity_rads"), sample.angular_velocity_rads);
  take(params.at("covariance"), sample.covariance);
  take(params.at("degenerate_direction"), sample.degenerate_direction);
  sample.status = status_of(params.at("status").get<std::string>());
  sample.reasons = reasons_of(params.at("reasons"));
  take(params.at("lidar_test_ratio"), sample.lidar_test_ratio);
  take(params.at("map_corrections"), sample.map_corrections);
  return sample;
}

}  // namespace slamd::client
