#include <slamd/client.h>

#include <bit>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "estimator/types/nav_state.hpp"
#include "tools/client/save_fd.hpp"
#include "tools/client/session.hpp"

struct slamd_connection {
  slamd::client::Session session;
  std::string version;
  std::string text;   // what the newest answer points to
  std::string topic;
};

struct slamd_page {
  slamd::PosePageReader reader;
};

namespace {

using namespace slamd;
using client::Failure;
using nlohmann::json;

static_assert(sizeof(slamd_pose) == sizeof(PoseSample));
static_assert(offsetof(slamd_pose, map_position_m) == offsetof(PoseSample, map_position_m));
static_assert(offsetof(slamd_pose, velocity_mps) == offsetof(PoseSample, velocity_mps));
static_assert(offsetof(slamd_pose, covariance) == offsetof(PoseSample, covariance));
static_assert(offsetof(slamd_pose, status) == offsetof(PoseSample, status));
static_assert(offsetof(slamd_pose, map_corrections) == offsetof(PoseSample, map_corrections));
static_assert(SLAMD_UTC_OFFSET_UNKNOWN == kUtcOffsetUnknown);

thread_local std::string last_error;

int failed(int code, const char* text) noexcept {
  try {
    last_error = text;
  } catch (...) {
    last_error.clear();
  }
  return code;
}

/// Runs what may throw; no exception leaves the C interface.
template <class Body>
int guarded(const Body& body) noexcept {
  try {
    body();
    return SLAMD_OK;
  } catch (const Failure& failure) {
    return failed(failure.code(), failure.what());
  } catch (const json::exception& error) {
    return failed(SLAMD_PROTOCOL, error.what());
  } catch (const std::exception& error) {
    return failed(SLAMD_SYSTEM, error.what());
  } catch (...) {
    return failed(SLAMD_SYSTEM, "unknown");
  }
}

void need(bool argument, const char* what) {
  if (!argument) throw Failure{SLAMD_USAGE, what};
}

json params_of(const slamd_request& request) {
  json params = request.params_json == nullptr ? json::object() : json::parse(request.params_json, nullptr, false);
  need(params.is_object(), "params_json is not a JSON object");
  return params;
}

client::Session::OnProgress progress_of(const slamd_request& request) {
  if (request.on_progress == nullptr) return {};
  return [&request](const json& params) { request.on_progress(request.user, params.dump().c_str()); };
}

}  // namespace

const char* slamd_last_error(void) { return last_error.c_str(); }

int slamd_connect(const char* socket_path, int timeout_ms, slamd_connection** connection) {
  return guarded([&] {
    need(connection != nullptr && timeout_ms > 0, "connection is NULL, or timeout_ms not positive");
    client::Session session{socket_path != nullptr ? socket_path : protocol::kDefaultSocketPath,
                            std::chrono::milliseconds{timeout_ms}};
    std::string version = session.version().dump();
    *connection = new slamd_connection{std::move(session), std::move(version), {}, {}};
  });
}

void slamd_disconnect(slamd_connection* connection) { delete connection; }

const char* slamd_version(const slamd_connection* connection) { return connection->version.c_str(); }

int slamd_call(slamd_connection* connection, const slamd_request* request, slamd_answer* answer) {
  return guarded([&] {
    need(connection != nullptr && request != nullptr && request->method != nullptr && answer != nullptr, "an argument is NULL");
    client::Session::Reply reply = connection->session.call(request->method, params_of(*request), progress_of(*request));
    connection->text = reply.result.dump();
    *answer = {connection->text.c_str(), reply.fd.release()};
  });
}

int slamd_subscribe(slamd_connection* connection, const char* topic, double rate_hz) {
  return guarded([&] {
    need(connection != nullptr && topic != nullptr, "an argument is NULL");
    connection->session.call(protocol::method::kSubscribe, {{"topic", topic}, {"rate_hz", rate_hz}});
  });
}

int slamd_unsubscribe(slamd_connection* connection, const char* topic) {
  return guarded([&] {
    need(connection != nullptr && topic != nullptr, "an argument is NULL");
    connection->session.call(protocol::method::kUnsubscribe, {{"topic", topic}});
  });
}

int slamd_next(slamd_connection* connection, const char** topic, const char** params_json) {
  return guarded([&] {
    need(connection != nullptr && topic != nullptr && params_json != nullptr, "an argument is NULL");
    const json notification = connection->session.next();
    connection->topic = notification["method"].get<std::string>();
    connection->text = notification["params"].dump();
    *topic = connection->topic.c_str();
    *params_json = connection->text.c_str();
  });
}

int slamd_next_pose(slamd_connection* connection, slamd_pose* pose) {
  return guarded([&] {
    need(connection != nullptr && pose != nullptr, "an argument is NULL");
    *pose = std::bit_cast<slamd_pose>(client::pose_of(connection->session.next(protocol::notification::kPose)["params"]));
  });
}

int slamd_open_page(slamd_connection* connection, slamd_page** page) {
  return guarded([&] {
    need(connection != nullptr && page != nullptr, "an argument is NULL");
    const client::Session::Reply reply = connection->session.call(protocol::method::kGetPosePage, json::object());
    std::optional<PosePageReader> reader = PosePageReader::map(reply.fd.get());
    if (!reader) throw Failure{SLAMD_PROTOCOL, "the pose page is of a version that this client does not know"};
    *page = new slamd_page{*std::move(reader)};
  });
}

void slamd_close_page(slamd_page* page) { delete page; }

int slamd_read_page(const slamd_page* page, slamd_pose* pose) {
  const std::optional<PoseSample> sample = page->reader.read();
  if (sample) std::memcpy(pose, &*sample, sizeof *pose);
  return sample ? 1 : 0;
}

uint32_t slamd_page_starts(const slamd_page* page) { return page->reader.starts(); }

const char* slamd_status_name(uint32_t status) { return name(static_cast<TrackingStatus>(status)); }

const char* slamd_reason_name(uint32_t bit) { return name(static_cast<StatusReason>(bit)); }

int slamd_save_fd(int fd, const char* path, slamd_bytes_fn on_bytes, void* user) {
  return guarded([&] {
    need(fd >= 0 && path != nullptr, "no descriptor or no path");
    client::save_fd(fd, path, [&](std::size_t bytes) {
      if (on_bytes != nullptr) on_bytes(user, bytes);
    });
  });
}
