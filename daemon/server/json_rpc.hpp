#pragma once
// JSON-RPC 2.0 as text: a request line in, answer and notification lines out. Knows no method and no socket.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>

namespace slamd {

struct RpcRequest {
  nlohmann::json id;             // string, integer, float or null
  bool wants_answer = true;      // false: sent without an id
  std::string method;
  nlohmann::json params;         // always an object
};

/// Why a request failed.
struct RpcError {
  int code = 0;
  std::string message;
};

/// A line that is no request, and the id to answer it with (null unless the line had a good one).
struct RpcFault {
  nlohmann::json id;
  RpcError error;
};

/// Reads one line. Anything at all may stand in it; it never throws.
std::variant<RpcRequest, RpcFault> parse_request(std::string_view line);

// One line each, with its line feed. Never throw; texts that are not UTF-8 are mended.
std::string result_line(const nlohmann::json& id, nlohmann::json result);
std::string error_line(const nlohmann::json& id, const RpcError& error);
std::string notification_line(const char* method, nlohmann::json params);
/// params_text  JSON already
std::string notification_line_of(const char* method, std::string_view params_text);

}  // namespace slamd
