#pragma once
// The numbers and names of the socket's JSON-RPC protocol, for the daemon and its clients. Numbers are never reused.

#include <cstddef>

namespace slamd::protocol {

/// Grows when a method, parameter or field changes its meaning; not when one is added.
inline constexpr int kVersion = 1;
inline constexpr const char* kDefaultSocketPath = "/run/slamd/slamd.sock";

namespace error {
inline constexpr int kParse = -32700;           // the line is no JSON; the id is null
inline constexpr int kInvalidRequest = -32600;  // JSON, but no JSON-RPC 2.0 request (batches are refused with this too)
inline constexpr int kUnknownMethod = -32601;
inline constexpr int kInvalidParams = -32602;
inline constexpr int kInternal = -32603;
inline constexpr int kNotYet = -32000;          // no pose or grid so far
inline constexpr int kBusy = -32001;            // too many maps and files in work, or too many clients
inline constexpr int kRefused = -32002;         // a file name that may not be written
inline constexpr int kWriteFailed = -32003;     // disk full, no permission, no memory; the message says which
inline constexpr int kVersionUnknown = -32004;  // the client asked for a protocol that this daemon does not speak
inline constexpr int kTooLong = -32005;         // the request line was too long; the connection is closed
inline constexpr int kNotAllowed = -32006;      // the method needs a member of the control group
inline constexpr int kNotConfigured = -32007;   // the configuration does not allow the method
}  // namespace error

namespace method {
inline constexpr const char* kVersion = "version";
inline constexpr const char* kGetStatus = "get_status";
inline constexpr const char* kGetPose = "get_pose";
inline constexpr const char* kSubscribe = "subscribe";
inline constexpr const char* kUnsubscribe = "unsubscribe";
inline constexpr const char* kGetMap = "get_map";
inline constexpr const char* kGetGrid = "get_grid";
inline constexpr const char* kGetPosePage = "get_pose_page";
inline constexpr const char* kGetTrajectory = "get_trajectory";
inline constexpr const char* kSaveMap = "save_map";
inline constexpr const char* kInject = "inject";
inline constexpr const char* kDump = "dump";
inline constexpr const char* kPushOdometry = "push_odometry";
inline constexpr const char* kStartRecording = "start_recording";
inline constexpr const char* kStopRecording = "stop_recording";
}  // namespace method

/// Methods of the notifications that the daemon sends.
namespace notification {
inline constexpr const char* kPose = "pose";          // params: as the result of get_pose
inline constexpr const char* kStatus = "status";      // params: as the result of get_status
inline constexpr const char* kGrid = "grid";          // params: of the newest grid, as the result of get_grid without its bytes
inline constexpr const char* kProgress = "progress";  // params: id of the request, stage, share 0..1
inline constexpr const char* kLost = "lost";          // params: count of notifications that this client was too slow for
}  // namespace notification

/// Results whose "fd" is true come with one descriptor (SCM_RIGHTS) at the first byte of their line.
inline constexpr const char* kFdField = "fd";

}  // namespace slamd::protocol
