// The track of a GPS receiver as a reference: the antenna's place, the turn of east and north against the map, the receiver's error.
#include "tools/slam-eval/tables/gps_track.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>

#include "estimator/math/geodesy.hpp"
#include "estimator/types/time.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;

constexpr double kRadius_m = 40.0;
constexpr double kLatency_s = 0.12;  // the parser's own assumption
constexpr int kSeconds = 60;
const Eigen::Vector3d kAntenna{-0.5, 0.8, 2.0};

/// Base on a circle, once round in a minute, x ahead.
Pose base_at(double t_s) {
  const double angle = 2.0 * std::numbers::pi * t_s / kSeconds;
  return {Eigen::Quaterniond{Eigen::AngleAxisd{angle + 0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()}},
          kRadius_m * Eigen::Vector3d{std::cos(angle), std::sin(angle), 0.0}};
}

std::string with_checksum(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  std::array<char, 8> text;
  std::snprintf(text.data(), text.size(), "*%02X", sum);
  return "$" + body + text.data();
}

std::string gga(int second, const GeodeticPosition& p) {
  const auto minutes = [](double deg) { return std::floor(std::abs(deg)) * 100.0 + (std::abs(deg) - std::floor(std::abs(deg))) * 60.0; };
  std::array<char, 160> text;
  std::snprintf(text.data(), text.size(), "GPGGA,1200%02d.00,%012.7f,N,%013.7f,E,1,10,0.9,%.3f,M,0.0,M,,", second, minutes(p.latitude_deg),
                minutes(p.longitude_deg), p.height_m);
  return with_checksum(text.data());
}

class GpsTrackTest : public ::testing::Test {
 protected:
  GpsTrackTest() { fs::create_directories(folder_); }
  ~GpsTrackTest() override { fs::remove_all(folder_); }

  /// off  what the receiver adds to the antenna's place, ENU
  void drive(const std::function<Eigen::Vector3d(int)>& off) {
    const LocalEnu enu{{59.0, 18.0, 20.0}};
    const Eigen::AngleAxisd turn{0.7, Eigen::Vector3d::UnitZ()};
    std::ofstream gps{folder_ / "gps.csv"};
    gps << "t_ns,sentence\n";
    for (int t = 0; t < kSeconds; ++t) {
      const GeodeticPosition fix = enu.to_geodetic(turn * (base_at(t) * kAntenna) + off(t));
      gps << static_cast<std::int64_t>((100.0 + t + kLatency_s) * 1e9) << ',' << gga(t, fix) << '\n';
    }
    std::ofstream{folder_ / "vehicle.yaml"} << "p_base_antenna: [-0.5, 0.8, 2.0]\n";
  }
  static Trajectory estimate() {
    Trajectory trajectory;
    for (int i = 0; i <= 10 * kSeconds; ++i) {
      trajectory.stamps_s.push_back(100.0 + 0.1 * i);
      trajectory.poses.push_back(base_at(0.1 * i));
    }
    return trajectory;
  }

  fs::path folder_ = fs::path{testing::TempDir()} / ("slamd_gps_track_" + std::to_string(::getpid()));
};

TEST_F(GpsTrackTest, ARightReceiverAgreesWithARightEstimateWhateverTheTurnBetweenThem) {
  drive([](int) { return Eigen::Vector3d::Zero(); });
  const GpsTrack track = load_gps_track(folder_);
  EXPECT_GT(track.antenna.poses.size(), 55U);
  EXPECT_EQ(track.p_base_antenna, kAntenna);
  const Statistics errors = ape_to_gps(track, estimate());
  EXPECT_GT(errors.count, 55U);
  EXPECT_LT(errors.max, 0.05);
}

TEST_F(GpsTrackTest, TheReceiversErrorIsWhatIsLeft) {
  drive([](int t) { return Eigen::Vector3d{t % 2 == 0 ? 1.0 : -1.0, 0.0, 30.0 * (t % 3)}; });
  EXPECT_NEAR(ape_to_gps(load_gps_track(folder_), estimate()).rmse, 1.0, 0.05) << "height does not count";
}

TEST_F(GpsTrackTest, ADriveWithoutAReceiverHasNoErrorsToIt) {
  EXPECT_EQ(ape_to_gps(load_gps_track(folder_), estimate()).count, 0U);
  std::ofstream{folder_ / "vehicle.yaml"} << "p_base_antenna: [here]\n";
  EXPECT_THROW(load_gps_track(folder_), InputError);
}

}  // namespace
}  // namespace slamd::eval
