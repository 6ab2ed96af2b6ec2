#include "drivers/imu/imu_csv_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "drivers/imu/imu_scale.hpp"

namespace slamd {
namespace {

constexpr const char* kHeader = "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c\n";

TEST(ImuCsvReader, ReadsEveryColumn) {
  std::istringstream lines{std::string{kHeader} + "1780300800000498571,-0.1,0.2,-0.3,0.4,-0.5,9.8,31.25\r\n"};
  ImuCsvReader reader{lines, {}};
  const auto sample = reader.next();
  ASSERT_TRUE(sample);
  EXPECT_EQ(to_ns(sample->arrival), 1780300800000498571);
  EXPECT_EQ(sample->gyro_rads, Eigen::Vector3d(-0.1, 0.2, -0.3));
  EXPECT_EQ(sample->accel_mps2, Eigen::Vector3d(0.4, -0.5, 9.8));
  EXPECT_FLOAT_EQ(sample->temperature_c, 31.25F);
  EXPECT_LT(sample->time, sample->arrival);
  EXPECT_FALSE(reader.next());
}

TEST(ImuCsvReader, CountsBadLinesByCauseAndReadsOn) {
  std::istringstream lines{std::string{kHeader} +
                           "1000000,0,0,0,0,0,9.8,20\n"
                           "nonsense\n"
                           "6000000,0,0,0,0,0\n"
                           "6000000,nan,0,0,0,0,9.8,20\n"
                           "6000000,0,inf,0,0,0,9.8,20\n"
                           "6000000,0,0,0,0,0,9.8,20,5\n"
                           "6000000,0,0,0x,0,0,9.8,20\n"
                           "6000000,0,100,0,0,0,9.8,20\n"
                           "6000000,0,0,0,0,0,-1e4,20\n"
                           "500000,0,0,0,0,0,9.8,20\n"
                           "\n"
                           "6000000,0,0,0,0,0,39.205,20\n"
                           "11000000,0,0,0,0,0,9.8\n"};
  ImuCsvReader reader{lines, {}};
  int samples = 0;
  while (reader.next()) ++samples;
  EXPECT_EQ(samples, 3);
  EXPECT_EQ(reader.stats().bad_lines, 6U);
  EXPECT_EQ(reader.stats().out_of_range, 2U);
  EXPECT_EQ(reader.stats().backward, 1U);
  EXPECT_EQ(reader.stats().clipped, 1U);
}

/// The generator took a sample exactly every 5 ms from the drive's first second on.
TEST(ImuCsvReader, FindsTheTrueTimesOfTheSampleDrive) {
  std::ifstream file{std::string{SLAMD_SHARED_DATA} + "/drive_sample/imu.csv"};
  if (!file) GTEST_SKIP() << "shared data is not here";
  ImuCsvReader reader{file, {}};
  double sum_us2 = 0.0, first_us = 0.0, settled_us = 0.0;
  std::int64_t i = 0;
  for (; const auto sample = reader.next(); ++i) {
    const double error_us =
        static_cast<double>(to_ns(sample->time) - (1'780'300'800'000'000'000 + i * 5'000'000)) * 1e-3;
    sum_us2 += error_us * error_us;
    (i < 1000 ? first_us : settled_us) = std::max(i < 1000 ? first_us : settled_us, std::abs(error_us));
  }
  EXPECT_EQ(i, 4801);
  EXPECT_EQ(reader.clock().missing(), 0U);
  EXPECT_LT(std::sqrt(sum_us2 / static_cast<double>(i)), 6.0);
  EXPECT_LT(first_us, 15.0);
  EXPECT_LT(settled_us, 15.0);
  RecordProperty("rms_us", std::to_string(std::sqrt(sum_us2 / static_cast<double>(i))));
}

}  // namespace
}  // namespace slamd
