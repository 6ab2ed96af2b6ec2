#include "daemon/server/params.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "daemon/server/protocol/protocol.hpp"

namespace slamd {

using nlohmann::json;

const json* Params::find(const char* key) {
  known_.emplace_back(key);
  const auto found = object_.find(key);
  return found == object_.end() ? nullptr : &*found;
}

void Params::complain(const char* key, const std::string& what) {
  if (!fault_) fault_ = RpcError{protocol::error::kInvalidParams, std::string{key} + " must be " + what};
}

double Params::number(const char* key, double fallback, double lowest, double highest) {
  const json* value = find(key);
  if (value == nullptr) return fallback;
  if (value->is_number() && value->get<double>() >= lowest && value->get<double>() <= highest) {
    return value->get<double>();
  }
  char range[64];
  std::snprintf(range, sizeof range, "a number from %g to %g", lowest, highest);
  complain(key, range);
  return fallback;
}

bool Params::flag(const char* key, bool fallback) {
  const json* value = find(key);
  if (value == nullptr) return fallback;
  if (value->is_boolean()) return value->get<bool>();
  complain(key, "true or false");
  return fallback;
}

std::string Params::choice(const char* key, const std::vector<std::string>& choices) {
  const std::string value = text(key, choices.front());
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  std::string all;
  for (const std::string& one : choices) all += (all.empty() ? "" : ", ") + one;
  complain(key, "one of: " + all);
  return choices.front();
}

std::string Params::text(const char* key, std::string fallback) {
  const json* value = find(key);
  if (value == nullptr) return fallback;
  if (value->is_string()) return value->get<std::string>();
  complain(key, "a string");
  return fallback;
}

std::optional<std::array<double, 3>> Params::vector3(const char* key) {
  const json* value = find(key);
  if (value == nullptr) return std::nullopt;
  const bool good = value->is_array() && value->size() == 3 &&
                    std::all_of(value->begin(), value->end(), [](const json& element) { return element.is_number(); });
  if (good) return value->get<std::array<double, 3>>();
  complain(key, "three numbers");
  return std::nullopt;
}

json Params::object(const char* key) {
  const json* value = find(key);
  if (value == nullptr) return json::object();
  if (value->is_object()) return *value;
  complain(key, "an object");
  return json::object();
}

void Params::adopt(const Params& nested) {
  if (!fault_) fault_ = nested.fault();
}

std::optional<RpcError> Params::fault() const {
  if (fault_) return fault_;
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      return RpcError{protocol::error::kInvalidParams, "unknown parameter " + key.substr(0, 64)};
    }
  }
  return std::nullopt;
}

}  // namespace slamd
