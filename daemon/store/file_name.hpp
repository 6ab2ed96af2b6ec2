#pragma once
// Which names clients may give to files and folders that the daemon makes. Knows no folder and touches none.

#include <string_view>

namespace slamd {

/// Letters, digits, '.', '_', '-', at most 128, not beginning with a dot: no way out of the folder that it is put in.
bool is_plain_file_name(std::string_view name);

}  // namespace slamd
