#pragma once
// Reads the parameters of a request, one by one with its range, and knows which were not asked for. No method's meaning.

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "daemon/server/json_rpc.hpp"

namespace slamd {

/// Each getter gives the fallback when the key is absent. The first thing that is wrong stays as the fault; what getters
/// give after that is of no use.
class Params {
 public:
  explicit Params(const nlohmann::json& object) : object_{object} {}

  double number(const char* key, double fallback, double lowest, double highest);
  bool flag(const char* key, bool fallback);
  /// One of the choices; the first of them when absent.
  std::string choice(const char* key, const std::vector<std::string>& choices);
  std::string text(const char* key, std::string fallback);
  /// Three finite numbers; nullopt when absent.
  std::optional<std::array<double, 3>> vector3(const char* key);
  /// An object of its own; empty when absent.
  nlohmann::json object(const char* key);

  /// Takes over the fault of a nested object's Params, if it has one.
  void adopt(const Params& nested);

  /// After all getters: what is wrong, unknown keys included; nullopt when nothing is.
  std::optional<RpcError> fault() const;

 private:
  const nlohmann::json* find(const char* key);
  void complain(const char* key, const std::string& what);

  const nlohmann::json& object_;
  std::vector<std::string> known_;
  std::optional<RpcError> fault_;
};

}  // namespace slamd
