#pragma once
// The lower envelope of arrival delay over a sliding window: a Bayesian fit of the line below all delays. It knows only
// numbers: jumps, output smoothing and clocks are ClockSync's.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace slamd {

/// Delays are (arrival - device time), minus any constant. Model: delay = offset + skew * x + excess, excess >= 0, with
/// an unknown density of excess near zero, which is learnt from a low quantile. Near its edge any such density looks
/// like a Poisson process, whose likelihood for a line of height h at the mean abscissa is exp(h * n * density); with a
/// Gaussian prior on the skew the posterior is one-dimensional and log-concave: integrated by quadrature.
class DelayEnvelope {
 public:
  struct Config {
    double window_s = 10.0;           // longest memory
    double expected_jitter_s = 1e-3;  // width of the excess before it is learnt
    double skew_sigma_ppm = 100.0;    // prior of the skew
    double noise_floor_s = 2e-6;      // resolution of stamps: the excess is never believed to be narrower
  };
  struct Line {
    double x_s = 0.0;         // where offset_ns holds
    double offset_ns = 0.0;   // posterior mean of the smallest delay at x_s
    double skew = 0.0;        // dimensionless
    double sigma_ns = 0.0;    // posterior deviation of offset_ns
    double skew_sigma = 0.0;  // posterior deviation of skew
    double at(double x) const { return offset_ns + skew * (x - x_s) * 1e9; }
    double sigma_at(double x) const { return std::hypot(sigma_ns, skew_sigma * (x - x_s) * 1e9); }
  };

  explicit DelayEnvelope(const Config& config);

  /// One delay; x_s never decreases. Returns the line, which is fitted anew when the delay can matter to it. No
  /// allocation; about 2 us when fitted.
  const Line& add(double x_s, double delay_ns);
  const Line& line() const { return line_; }
  std::uint32_t count() const { return count_; }
  /// Width of the excess as learnt, nanoseconds (inverse density at its lower edge).
  double jitter_ns() const;

  /// Forgets every delay but keeps the learnt jitter and, as a prior, the skew. Abscissae may start anew.
  void restart();

 private:
  static constexpr std::size_t kBins = 64;
  struct Bin {
    double begin_s, x_s, delay_ns;  // first abscissa; the lowest delay (against the skew of its time) and where
    double sum_x_s;
    std::uint32_t count;
  };
  struct Hull;
  class Posterior;

  bool insert(double x_s, double delay_ns);
  void merge_pairs();
  void evict(double x_s);
  double above_line(double x_s, double delay_ns) const;
  Hull lower_hull() const;
  void fit(double x_s);
  void learn_jitter(double excess_ns);

  Config config_;
  std::array<Bin, kBins> bins_{};
  std::size_t bin_count_ = 0;
  double bin_width_s_ = 0.0;
  std::uint32_t count_ = 0;   // delays since restart()
  std::uint32_t learnt_ = 0;  // excesses that quantile_ns_ has seen, saturating
  double quantile_ns_ = 0.0;  // a low quantile of the excess
  double prior_skew_ = 0.0;
  double prior_sigma_ = 0.0;
  Line line_;
};

}  // namespace slamd
