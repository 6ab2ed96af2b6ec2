#pragma once
// Uniform B-spline of degree 5 with its derivatives (C4). It smooths: the curve passes near its samples, not through.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

namespace slamd::sim {

/// Basis weights of the uniform B-spline of one degree, oldest control point first; 0 <= u < 1.
template <int kDegree>
std::array<double, kDegree + 1> spline_weights(double u) {
  if constexpr (kDegree == 0) {
    return {1.0};
  } else {
    const auto low = spline_weights<kDegree - 1>(u);
    std::array<double, kDegree + 1> w{};
    for (int j = 0; j <= kDegree; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (j > 0) w[at] += (u + kDegree - j) * low[at - 1];
      if (j < kDegree) w[at] += (j + 1 - u) * low[at];
      w[at] /= kDegree;
    }
    return w;
  }
}

template <int kDim>
class UniformSpline {
 public:
  using Vector = Eigen::Matrix<double, kDim, 1>;
  struct Value {
    Vector value, first, second;  // with respect to the parameter
  };

  UniformSpline() = default;
  /// samples[i] belongs to the parameter start + i * step; at least one. It runs straight on at the ends.
  UniformSpline(double start, double step, const std::vector<Vector>& samples)
      : start_{start}, step_{step}, intervals_{static_cast<int>(samples.size()) - 1} {
    control_.reserve(samples.size() + 6);
    const auto sample = [&](int i) { return samples[static_cast<std::size_t>(std::clamp(i, 0, intervals_))]; };
    for (int i = -2; i <= intervals_ + 3; ++i) {
      if (i < 0) {
        control_.push_back(2.0 * sample(0) - sample(-i));
      } else if (i > intervals_) {
        control_.push_back(2.0 * sample(intervals_) - sample(2 * intervals_ - i));
      } else {
        control_.push_back(sample(i));
      }
    }
  }

  double start() const { return start_; }
  double end() const { return start_ + step_ * intervals_; }

  /// t is clamped to start .. end + step: beyond, the derivatives are those of the end.
  Value at(double t) const {
    const double x = std::clamp((t - start_) / step_, 0.0, static_cast<double>(intervals_) + 1.0 - 1e-9);
    const int i = static_cast<int>(x);
    const double u = x - i;
    const Vector* c = &control_[static_cast<std::size_t>(i)];
    const auto w5 = spline_weights<5>(u);
    const auto w4 = spline_weights<4>(u);
    const auto w3 = spline_weights<3>(u);
    Value out{Vector::Zero(), Vector::Zero(), Vector::Zero()};
    for (std::size_t j = 0; j < 6; ++j) out.value += w5[j] * c[j];
    for (std::size_t j = 0; j < 5; ++j) out.first += w4[j] / step_ * (c[j + 1] - c[j]);
    for (std::size_t j = 0; j < 4; ++j) out.second += w3[j] / (step_ * step_) * (c[j + 2] - 2.0 * c[j + 1] + c[j]);
    return out;
  }

 private:
  double start_ = 0.0;
  double step_ = 1.0;
  int intervals_ = 0;
  std::vector<Vector> control_;  // samples -2 .. n+2, mirrored through the ends
};

}  // namespace slamd::sim
