// Any bytes as slamd.yaml, as vehicle.yaml and as `--set`: nothing is thrown, every fault names file and line, and what
// was read is inside its range and prints as a file that reads back to the same values.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/config/config.hpp"

namespace {

using namespace slamd;

void require(bool property) {
  if (!property) std::abort();
}

/// "fuzz.yaml:LINE: key: reason"
void check_fault(const std::string& fault) {
  const std::string name = "fuzz.yaml:";
  require(fault.starts_with(name));
  const std::size_t digits_end = fault.find_first_not_of("0123456789", name.size());
  require(digits_end != std::string::npos && digits_end > name.size());
  require(fault.compare(digits_end, 2, ": ") == 0);
  require(fault.find(": ", digits_end + 2) != std::string::npos);
}

/// A value outside its range would be refused when read again. before  as the fields print when nothing was read
void check_values(const std::vector<Field>& fields, const std::string& before) {
  const std::string printed = print_yaml(fields);
  if (printed == before) return;
  require(read_yaml_text("printed", printed, fields).empty());
  require(print_yaml(fields) == printed);
}

void check_text(const std::string& text, const std::vector<Field>& fields, const std::string& before) {
  for (const std::string& fault : read_yaml_text("fuzz.yaml", text, fields)) check_fault(fault);
  check_values(fields, before);
}

void check_override(const std::string& text, const std::vector<Field>& fields, const std::string& before) {
  for (const std::string& fault : read_override(text, fields)) require(fault.starts_with("--set "));
  check_values(fields, before);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text{reinterpret_cast<const char*>(bytes), size};
  Config whole, changed;
  DriveVehicle vehicle;
  static const std::string kWhole = print_yaml(config_fields(whole));
  static const std::string kVehicle = print_yaml(drive_vehicle_fields(vehicle));
  check_text(text, config_fields(whole), kWhole);
  check_text(text, drive_vehicle_fields(vehicle), kVehicle);
  check_override(text, config_fields(changed), kWhole);
  return 0;
}
