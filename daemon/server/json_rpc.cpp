#include "daemon/server/json_rpc.hpp"

#include <utility>

#include "daemon/server/protocol/protocol.hpp"

namespace slamd {
namespace {

using nlohmann::json;
namespace error = protocol::error;

constexpr std::size_t kMaxIdLength = 256;

std::string line_of(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace) + '\n'; }

bool is_good_id(const json& id) {
  return id.is_null() || id.is_number() || (id.is_string() && id.get_ref<const std::string&>().size() <= kMaxIdLength);
}

RpcFault fault(json id, int code, const char* message) { return {std::move(id), {code, message}}; }

}  // namespace

std::variant<RpcRequest, RpcFault> parse_request(std::string_view line) {
  json message = json::parse(line, nullptr, false);
  if (message.is_discarded()) return fault(nullptr, error::kParse, "not JSON");
  if (message.is_array()) return fault(nullptr, error::kInvalidRequest, "batches are not supported");
  if (!message.is_object()) return fault(nullptr, error::kInvalidRequest, "not an object");

  RpcRequest request;
  request.wants_answer = message.contains("id");
  if (request.wants_answer) request.id = std::move(message["id"]);
  if (!is_good_id(request.id)) return fault(nullptr, error::kInvalidRequest, "id must be a short string or a number");

  const auto version = message.find("jsonrpc");
  if (version == message.end() || *version != "2.0") {
    return fault(std::move(request.id), error::kInvalidRequest, "jsonrpc must be \"2.0\"");
  }
  const auto method = message.find("method");
  if (method == message.end() || !method->is_string()) {
    return fault(std::move(request.id), error::kInvalidRequest, "method must be a string");
  }
  request.method = method->get<std::string>();
  request.params = json::object();
  if (const auto params = message.find("params"); params != message.end()) request.params = std::move(*params);
  if (!request.params.is_object()) {
    return fault(std::move(request.id), error::kInvalidParams, "params must be an object");
  }
  return request;
}

std::string result_line(const json& id, json result) {
  return line_of({{"jsonrpc", "2.0"}, {"id", id}, {"result", std::move(result)}});
}

std::string error_line(const json& id, const RpcError& error) {
  const json body = {{"code", error.code}, {"message", error.message}};
  return line_of({{"jsonrpc", "2.0"}, {"id", id}, {"error", body}});
}

std::string notification_line(const char* method, json params) {
  return line_of({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}});
}

std::string notification_line_of(const char* method, std::string_view params_text) {
  std::string line = R"({"jsonrpc":"2.0","method":")";
  line.reserve(line.size() + params_text.size() + 64);
  line += method;
  line += R"(","params":)";
  line += params_text;
  line += "}\n";
  return line;
}

}  // namespace slamd
