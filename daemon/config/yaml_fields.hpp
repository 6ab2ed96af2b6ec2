#pragma once
// Reads YAML into a table of fields and prints the table as YAML. Does not know which keys exist: the tables do.

#include <string>
#include <vector>

#include "daemon/config/field.hpp"

namespace slamd {

/// Everything wrong in the input, one line each: "FILE:LINE: key: reason". Empty = all was read.
using ConfigFaults = std::vector<std::string>;

/// Reads the YAML file into the fields' slots; keys that the file does not have keep their value. Not only the first
/// but every fault is returned: unreadable file, bad syntax, unknown key, key given twice, wrong type, out of range.
ConfigFaults read_yaml_file(const std::string& path, const std::vector<Field>& fields);

/// The same from a text; `name` stands for the file in the faults.
ConfigFaults read_yaml_text(const std::string& name, const std::string& text, const std::vector<Field>& fields);

/// One "key=value" (value in YAML, e.g. `a.b=[1, 2, 3]`) into its slot; faults begin with "--set key=value".
ConfigFaults read_override(const std::string& assignment, const std::vector<Field>& fields);

/// The fields as YAML in the table's order, each with its sentence, unit and range as comment. Reads back identically.
std::string print_yaml(const std::vector<Field>& fields);

}  // namespace slamd
