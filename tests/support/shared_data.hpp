#pragma once
// Where recordings and reference numbers lie. Tests skip with a message when they are absent.

#include <filesystem>
#include <string>

namespace slamd::test {

inline std::string shared_data(const std::string& name) { return std::string{SLAMD_SHARED_DATA} + "/" + name; }
inline bool is_there(const std::string& path) { return std::filesystem::exists(path); }

}  // namespace slamd::test
