#pragma once
// Joins neighbouring returns of a ring into segments as they arrive: 29,000 returns become some 3,000 means.
// Every return is used, and every laser keeps its share, which taking each fourth point does not give.

#include <array>

#include "estimator/types/scan.hpp"

namespace slamd {

struct SegmenterConfig {
  float max_length_m = 0.4F;         // chord of a segment
  float max_step_m = 0.15F;          // between neighbouring returns, at least
  float max_step_per_range = 0.012F; // likewise in proportion to range (0.2 deg = 0.0035)
  float min_range_m = 1.0F;          // nearer returns are the vehicle itself
  float max_range_m = 100.0F;
};

class Segmenter {
 public:
  static constexpr std::size_t kMaxRings = 128;

  explicit Segmenter(const SegmenterConfig& config) : config_{config} {}

  /// Adds one return; time_s is after the scan's begin. Segments that end are appended to `out`, while it has capacity.
  void add(const LidarPoint& point, float time_s, std::vector<ScanSegment>& out);
  /// Ends all open segments.
  void finish(std::vector<ScanSegment>& out);

 private:
  struct Open {
    float first[3], last[3], sum[3];
    float time_sum_s = 0.0F;
    std::uint16_t count = 0;
  };
  void close(std::uint8_t ring, std::vector<ScanSegment>& out);

  SegmenterConfig config_;
  std::array<Open, kMaxRings> open_{};
};

}  // namespace slamd
