// Allan figures of imu-monitor against synthetic noise of known density, and the live figures against known samples.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "tools/imu-monitor/live_window.hpp"
#include "tools/imu-monitor/rest_recording.hpp"

namespace slamd::monitor {
namespace {

constexpr double kPeriodS = 1.0 / 208.0;

/// White noise of density N and a random walk K, at rest.
std::vector<double> noise(std::size_t count, double density, double walk, unsigned seed) {
  std::mt19937_64 engine{seed};
  std::normal_distribution<double> normal;
  std::vector<double> samples(count);
  double bias = 0.0;
  for (double& sample : samples) {
    bias += walk * std::sqrt(kPeriodS) * normal(engine);
    sample = 3.0 + bias + density / std::sqrt(kPeriodS) * normal(engine);
  }
  return samples;
}

TEST(Allan, WhiteNoiseGivesItsDensityAndTheSlopeOfOneHalf) {
  const std::vector<AllanPoint> curve = allan_deviation(noise(400'000, 1e-4, 0.0, 1), kPeriodS);
  ASSERT_GT(curve.size(), 50U);
  EXPECT_NEAR(curve.front().deviation, 1e-4 / std::sqrt(kPeriodS), 1e-5);
  for (const AllanPoint& p : curve) {
    const double relative_sigma = 1.0 / std::sqrt(p.freedom);
    EXPECT_NEAR(p.deviation * std::sqrt(p.tau_s), 1e-4, 1e-4 * 4.0 * relative_sigma) << p.tau_s;
  }
  const AllanFigures figures = allan_figures(curve);
  EXPECT_NEAR(figures.noise_density, 1e-4, 2e-6);
  EXPECT_FALSE(figures.flat_is_reached);
}

TEST(Allan, DensityAndRandomWalkAreToldApart) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const AllanFigures figures = allan_figures(allan_deviation(noise(1'000'000, 2e-3, 1e-4, seed), kPeriodS));
    EXPECT_NEAR(figures.noise_density, 2e-3, 6e-5) << seed;
    EXPECT_NEAR(figures.random_walk, 1e-4, 2e-5) << seed;
    EXPECT_TRUE(figures.flat_is_reached);
    // The lowest point of N^2/tau + K^2 tau/3 lies at tau = sqrt(3) N/K, at a variance of 2 N K/sqrt(3).
    EXPECT_NEAR(figures.bias_instability, std::sqrt(2.0 * 2e-3 * 1e-4 / std::sqrt(3.0)) / 0.664, 8e-5) << seed;
    EXPECT_NEAR(figures.flat_tau_s, std::sqrt(3.0) * 20.0, 20.0) << seed;
  }
}

TEST(Allan, AFlatPartIsItsLevel) {
  // flicker noise: the sum of Ornstein-Uhlenbeck processes of equal strength, one a decade of correlation time
  std::mt19937_64 engine{5};
  std::normal_distribution<double> normal;
  std::array<double, 5> states{};
  std::vector<double> samples(500'000);
  for (double& sample : samples) {
    sample = 0.0;
    double tau_s = 0.05;
    for (double& state : states) {
      const double keep = std::exp(-kPeriodS / tau_s);
      state = keep * state + std::sqrt(1.0 - keep * keep) * normal(engine);
      sample += 1e-3 * state;
      tau_s *= 10.0;
    }
  }
  const std::vector<AllanPoint> curve = allan_deviation(samples, kPeriodS);
  double lowest = 1.0;
  double highest = 0.0;
  for (const AllanPoint& p : curve) {
    if (p.tau_s < 0.1 || p.tau_s > 50.0) continue;
    lowest = std::min(lowest, p.deviation);
    highest = std::max(highest, p.deviation);
  }
  EXPECT_LT(highest / lowest, 1.35);  // flat over nearly three decades
  EXPECT_NEAR(lowest, 0.62e-3, 0.15e-3);
}

TEST(Allan, TooFewSamplesGiveNothing) {
  EXPECT_TRUE(allan_deviation(std::vector<double>(29, 1.0), kPeriodS).empty());
  EXPECT_TRUE(allan_deviation(std::vector<double>(1000, 1.0), 0.0).empty());
  EXPECT_EQ(allan_figures({}).noise_density, 0.0);
}

TEST(Allan, ConstantSamplesHaveNoNoise) {
  EXPECT_LT(allan_figures(allan_deviation(std::vector<double>(5000, 9.81), kPeriodS)).noise_density, 1e-12);
}

TEST(RestRecording, ARecordingGivesTheFiguresInTheUnitsOfTheConfiguration) {
  std::array<std::vector<double>, kAxes> truth;
  for (std::size_t i = 0; i < kAxes; ++i) {
    truth[i] = noise(60'000, i < 3 ? 1e-4 * static_cast<double>(i + 1) : 2e-3, 0.0, static_cast<unsigned>(i + 1));
  }
  std::stringstream lines;
  lines.precision(12);
  lines << "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c\n";
  for (std::size_t k = 0; k < truth[0].size(); ++k) {
    lines << static_cast<std::int64_t>(1e9 + static_cast<double>(k) * kPeriodS * 1e9 + 3e5);
    for (const auto& axis : truth) lines << ',' << axis[k];
    lines << ",25\n";
  }
  const RestRecording recording = read_rest_recording(lines);
  ASSERT_EQ(recording.refusal, "");
  EXPECT_NEAR(recording.period_s, kPeriodS, 1e-7);
  const AllanResult result = evaluate(recording);
  EXPECT_NEAR(result[2].figures.noise_density, 3e-4, 2e-5);
  EXPECT_NEAR(result[4].figures.noise_density, 2e-3, 1e-4);
  const std::string report = allan_report(recording, result);
  double worst = 0.0;
  ASSERT_EQ(std::sscanf(report.c_str() + report.find("gyro_noise_rads_rthz"), "gyro_noise_rads_rthz: %lf", &worst), 1);
  EXPECT_NEAR(worst, 3e-4, 2e-5);
  EXPECT_NE(report.find("accel_noise_mps2_rthz: 0.00"), std::string::npos);
}

TEST(RestRecording, AShortRecordingIsRefused) {
  std::stringstream lines{"1000000000,0,0,0,0,0,9.81,25\n"};
  EXPECT_NE(read_rest_recording(lines).refusal.find("has 1 samples"), std::string::npos);
}

TEST(LiveWindow, RateNoiseGravityAndTemperatureAreThoseOfTheSamples) {
  LiveWindow window;
  for (int i = 0; i < 201; ++i) {
    ImuSample sample;
    ImuFrame frame;
    frame.device_us = 1'000'000 + 5000 * static_cast<std::uint64_t>(i);
    window.add(frame);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    sample.gyro_rads = {0.003 * sign, 0.0, 0.0};
    sample.accel_mps2 = {0.0, 0.02 * sign, 9.8};
    sample.temperature_c = i % 2 == 0 ? 30.0F : 32.0F;
    window.add(sample);
  }
  EXPECT_NEAR(window.rate_hz(), 200.0, 1e-9);
  EXPECT_NEAR(window.gyro().deviation().x(), 0.003, 2e-5);
  EXPECT_NEAR(window.accel().deviation().y(), 0.02, 1e-4);
  EXPECT_EQ(window.gyro().deviation().z(), 0.0);
  EXPECT_NEAR(window.gravity_mps2(), 9.8, 1e-6);
  EXPECT_NEAR(window.temperature_c(), 31.0, 0.01);
  EXPECT_TRUE(window.is_at_rest());
  ImuSample jolt;
  jolt.accel_mps2 = {0.0, 0.0, 20.0};
  window.add(jolt);
  EXPECT_FALSE(window.is_at_rest());
}

}  // namespace
}  // namespace slamd::monitor
