#include "tools/slam-sim/output/motion_file.hpp"

#include <cerrno>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

namespace slamd::sim {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;

void write_line(std::FILE* file, std::int64_t stamp_ns, const Inertial& inertial) {
  const auto& w = inertial.rate_rads;
  const auto& f = inertial.specific_force_mps2;
  std::fprintf(file, "%" PRId64 ",%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n", stamp_ns, w.x(), w.y(), w.z(), f.x(), f.y(), f.z());
}

}  // namespace

void write_imu_motion(const std::filesystem::path& path, const Simulation& simulation, double gravity_mps2,
                      std::int64_t start_ns) {
  const std::filesystem::path unfinished = path.string() + ".part";
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{std::fopen(unfinished.c_str(), "w"), &std::fclose};
  if (!file) throw std::runtime_error(unfinished.string() + ": " + std::strerror(errno));
  std::fputs("t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2\n", file.get());
  const auto count = static_cast<std::int64_t>(std::floor(simulation.duration() * 1000.0));
  for (std::int64_t i = 0; i <= count; ++i) {
    const Motion motion = simulation.trajectory().at(static_cast<double>(i) * 1e-3);
    write_line(file.get(), start_ns + i * kPeriodNs, inertial_at(motion, simulation.vehicle().T_base_imu, gravity_mps2));
  }
  if (std::fflush(file.get()) != 0) throw std::runtime_error(unfinished.string() + ": " + std::strerror(errno));
  std::filesystem::rename(unfinished, path);
}

}  // namespace slamd::sim
