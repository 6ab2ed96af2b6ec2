// Any bytes as a g2o file: refused with a reason, or read; what was read is written and read again as the same text.

#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "tools/slam-pgo/g2o_file.hpp"

using namespace slamd::pgo;

namespace {

std::string written(const AnyGraph& any) {
  std::ostringstream out;
  write_g2o(out, any);
  return out.str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream in{std::string{reinterpret_cast<const char*>(data), size}};
  const auto first = read_g2o(in);
  if (const auto* fault = std::get_if<G2oFault>(&first)) {
    if (fault->reason.empty()) std::abort();
    return 0;
  }
  const std::string once = written(std::get<AnyGraph>(first));
  std::istringstream again{once};
  const auto second = read_g2o(again);
  if (!std::holds_alternative<AnyGraph>(second) || written(std::get<AnyGraph>(second)) != once) std::abort();
  return 0;
}
