// Any bytes as a PCD file: refused with its path, or read to finite points, no more than its bytes can hold.

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "daemon/ring/unique_fd.hpp"
#include "tools/plot/canvas.hpp"
#include "tools/plot/pcd_file.hpp"

namespace {

using namespace slamd;

constexpr std::size_t kLzfGrowth = 300;  // a compressed file's points of one byte: three bytes of LZF give 264 at most

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const UniqueFd file{::memfd_create("fuzz", MFD_CLOEXEC)};
  require(file && ::write(file.get(), bytes, size) == static_cast<ssize_t>(size));
  const std::string path = "/proc/self/fd/" + std::to_string(file.get());
  try {
    const PointCloud points = plot::read_pcd(path);
    require(!points.empty() && points.size() <= kLzfGrowth * size);
    for (const auto& point : points) {
      require(std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z) && std::isfinite(point.intensity));
    }
  } catch (const plot::PlotError& fault) {
    require(std::string{fault.what()}.starts_with(path));
  }
  return 0;
}
