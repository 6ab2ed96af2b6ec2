#include "daemon/store/file_name.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace slamd {

bool is_plain_file_name(std::string_view name) {
  constexpr std::size_t kLongest = 128;
  const auto good = [](char c) { return (std::isalnum(static_cast<unsigned char>(c)) != 0) || c == '.' || c == '_' || c == '-'; };
  return !name.empty() && name.size() <= kLongest && name.front() != '.' && std::ranges::all_of(name, good);
}

}  // namespace slamd
