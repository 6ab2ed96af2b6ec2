// Any bytes as a TUM and as a KITTI trajectory: refused with name and line, or read to finite poses that read back the same.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "tools/slam-eval/trajectory.hpp"

namespace {

using namespace slamd;
using namespace slamd::eval;

void require(bool holds) {
  if (!holds) std::abort();
}

std::string as_tum(const Trajectory& trajectory) {
  std::string text;
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const Pose& pose = trajectory.poses[i];
    const Eigen::Quaterniond& q = pose.rotation;
    char line[400];
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", trajectory.stamps_s[i],
                  pose.translation.x(), pose.translation.y(), pose.translation.z(), q.x(), q.y(), q.z(), q.w());
    text += line;
  }
  return text;
}

void check(const Trajectory& trajectory) {
  for (const Pose& pose : trajectory.poses) {
    require(pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-6);
  }
}

template <class Read>
void check_fault(Read read) {
  try {
    check(read());
  } catch (const InputError& fault) {
    require(std::string{fault.what()}.starts_with("fuzz:"));
  }
}

void check_tum(const std::string& text) {
  std::istringstream in{text};
  const Trajectory first = read_tum(in, "fuzz");
  check(first);
  std::istringstream again{as_tum(first)};
  const Trajectory second = read_tum(again, "fuzz");
  require(second.stamps_s == first.stamps_s && second.poses.size() == first.poses.size());
  for (std::size_t i = 0; i < first.poses.size(); ++i) {
    require(second.poses[i].translation == first.poses[i].translation);
    require(second.poses[i].rotation.angularDistance(first.poses[i].rotation) < 1e-6);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string text{reinterpret_cast<const char*>(bytes), size};
  check_fault([&text] {
    check_tum(text);
    return Trajectory{};
  });
  check_fault([&text] {
    std::istringstream in{text};
    return read_kitti(in, "fuzz");
  });
  return 0;
}
