#pragma once
// Numbers as the cells of a Markdown table. Knows no table.

#include <array>
#include <cstdio>
#include <string>

#include "tools/slam-eval/tables/run_table.hpp"

namespace slamd::eval {

/// As printf, of short texts.
template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

/// "least / median / most"; number  printf's pattern of one.
inline std::string text(const Spread& s, const char* number) {
  const std::string pattern = std::string(number) + " / " + number + " / " + number;
  return format(pattern.c_str(), s.least, s.median, s.most);
}

}  // namespace slamd::eval
