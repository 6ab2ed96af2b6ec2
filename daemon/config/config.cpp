#include "daemon/config/config.hpp"

#include <utility>

namespace slamd {
namespace {

void append(ConfigFaults& faults, ConfigFaults more) {
  for (std::string& fault : more) faults.push_back(std::move(fault));
}

}  // namespace

Loaded<Config> load_config(const std::string& path, const std::vector<std::string>& overrides) {
  Loaded<Config> loaded;
  const std::vector<Field> fields = config_fields(loaded.value);
  if (!path.empty()) append(loaded.faults, read_yaml_file(path, fields));
  for (const std::string& assignment : overrides) append(loaded.faults, read_override(assignment, fields));
  return loaded;
}

Loaded<VehicleGeometry> load_vehicle(const std::string& path) {
  Loaded<VehicleGeometry> loaded{reference_vehicle(), {}};
  loaded.faults = read_yaml_file(path, vehicle_fields(loaded.value));
  return loaded;
}

std::string print_config(const Config& config) {
  Config copy = config;
  return "# Configuration of slamd: every key with its default. Unknown keys are errors; keys left out keep the "
         "default.\n"
         "# Check a file with `slamd --config FILE --check`; this file is the output of `slamd --print-config`.\n\n" +
         print_yaml(config_fields(copy));
}

}  // namespace slamd
