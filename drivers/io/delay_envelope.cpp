#include "drivers/io/delay_envelope.hpp"

#include <algorithm>
#include <limits>

namespace slamd {
namespace {

constexpr double kQuantile = 0.1;  // of the excess: quantile / kQuantile is the inverse density at the lower edge
constexpr double kSlowestLearning = 0.02;
constexpr double kKeptSkewSigma = 20e-6;  // a crystal keeps its skew across a restart within this
constexpr double kPriorSpan = 8.0;        // the skew is searched within so many sigmas of its prior
constexpr double kLearntSpan = 7.9;       // and is none at the end of the search: a queue that emptied asked for it
constexpr double kNegligible = 14.0;      // log-likelihood drop beyond which the posterior is not integrated
constexpr int kSearchSteps = 44;
constexpr int kBisectSteps = 26;
constexpr int kNodes = 24;
constexpr std::uint32_t kAlwaysFit = 256;  // first delays: every one moves the line
constexpr std::size_t kFewestBins = 16;    // kept however old they are: slow streams

/// Mean and deviation of weighted values.
class WeightedMoments {
 public:
  void add(double weight, double value) {
    weight_ += weight;
    sum_ += weight * value;
    sum_2_ += weight * value * value;
  }
  double mean() const { return sum_ / weight_; }
  double deviation() const { return std::sqrt(std::max(0.0, sum_2_ / weight_ - mean() * mean())); }

 private:
  double weight_ = 0.0, sum_ = 0.0, sum_2_ = 0.0;
};

}  // namespace

struct DelayEnvelope::Hull {
  struct Point {
    double x_s, delay_ns;
  };
  std::array<Point, kBins> points;
  std::size_t size = 0;
};

/// Posterior of the skew, up to a factor, and what follows from a skew.
class DelayEnvelope::Posterior {
 public:
  Posterior(const Hull& hull, double mean_x_s, double edge_density, double prior_skew, double prior_sigma)
      : hull_{hull}, mean_x_s_{mean_x_s}, density_{edge_density}, prior_{prior_skew}, sigma_{prior_sigma} {}

  /// Height at the mean abscissa of the highest line of this skew below all delays.
  double height_ns(double skew) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull_.size; ++i) {
      lowest = std::min(lowest, hull_.points[i].delay_ns - skew * 1e9 * (hull_.points[i].x_s - mean_x_s_));
    }
    return lowest;
  }
  double log(double skew) const {
    const double z = (skew - prior_) / sigma_;
    return density_ * height_ns(skew) - 0.5 * z * z;
  }
  /// Golden-section search: log() is concave.
  double mode() const {
    constexpr double kGolden = 0.6180339887498949;
    double low = prior_ - kPriorSpan * sigma_;
    double high = prior_ + kPriorSpan * sigma_;
    double left = high - kGolden * (high - low);
    double right = low + kGolden * (high - low);
    double log_left = log(left);
    double log_right = log(right);
    for (int i = 0; i < kSearchSteps; ++i) {
      if (log_left < log_right) {
        low = left;
        left = right;
        log_left = log_right;
        log_right = log(right = low + kGolden * (high - low));
      } else {
        high = right;
        right = left;
        log_right = log_left;
        log_left = log(left = high - kGolden * (high - low));
      }
    }
    return 0.5 * (low + high);
  }
  /// Where log() has fallen by kNegligible on the side of `direction`, or the search ends: data that ask for a skew beyond it (a
  /// queue that empties at once) would let log() grow there without bound.
  double edge(double mode, double direction) const {
    const double floor = log(mode) - kNegligible;
    double inside = mode;
    double outside = prior_ + direction * kPriorSpan * sigma_;
    for (int i = 0; i < kBisectSteps; ++i) {
      const double middle = 0.5 * (inside + outside);
      (log(middle) > floor ? inside : outside) = middle;
    }
    return outside;
  }
  /// The line at x_s: midpoint rule between the edges, relative to the mode so that no digits are lost.
  Line integrate(double x_s) const {
    const double top = mode();
    const double low = edge(top, -1.0);
    const double step = (edge(top, 1.0) - low) / kNodes;
    const double log_top = log(top);
    const double reference_ns = height_ns(top);
    WeightedMoments skew;
    WeightedMoments offset_ns;
    for (int i = 0; i < kNodes; ++i) {
      const double s = low + (i + 0.5) * step;
      const double weight = std::exp(log(s) - log_top);
      skew.add(weight, s - top);
      offset_ns.add(weight, height_ns(s) - reference_ns + s * 1e9 * (x_s - mean_x_s_));
    }
    return {x_s, reference_ns + offset_ns.mean(), top + skew.mean(), offset_ns.deviation(), skew.deviation()};
  }

 private:
  const Hull& hull_;
  double mean_x_s_, density_, prior_, sigma_;
};

DelayEnvelope::DelayEnvelope(const Config& config)
    : config_{config},
      quantile_ns_{kQuantile * config.expected_jitter_s * 1e9},
      prior_sigma_{config.skew_sigma_ppm * 1e-6} {}

double DelayEnvelope::jitter_ns() const {
  return std::max(quantile_ns_ / kQuantile, config_.noise_floor_s * 1e9);
}

const DelayEnvelope::Line& DelayEnvelope::add(double x_s, double delay_ns) {
  if (count_ > 0) learn_jitter(delay_ns - line_.at(x_s));
  const bool matters = insert(x_s, delay_ns);
  ++count_;
  if (matters || count_ <= kAlwaysFit) fit(x_s);
  return line_;
}

void DelayEnvelope::restart() {
  if (count_ > 0 && std::abs(line_.skew - prior_skew_) < kLearntSpan * prior_sigma_) {
    prior_skew_ = line_.skew;
    prior_sigma_ = std::min(config_.skew_sigma_ppm * 1e-6, std::hypot(kKeptSkewSigma, line_.skew_sigma));
  }
  bin_count_ = 0;
  bin_width_s_ = 0.0;
  count_ = 0;
}

/// Stochastic approximation of the quantile, in its logarithm: the scale is found from any start.
void DelayEnvelope::learn_jitter(double excess_ns) {
  const double gain = std::max(kSlowestLearning, 2.0 / (20.0 + learnt_));
  learnt_ = std::min(learnt_ + 1, 1'000U);
  quantile_ns_ *= std::exp(gain * (kQuantile - (excess_ns < quantile_ns_ ? 1.0 : 0.0)));
  quantile_ns_ = std::max(quantile_ns_, kQuantile * config_.noise_floor_s * 1e9);
}

double DelayEnvelope::above_line(double x_s, double delay_ns) const {
  return delay_ns - line_.skew * x_s * 1e9;
}

/// True when the delay opened a bin or is the lowest of its bin: only then can it change the hull.
bool DelayEnvelope::insert(double x_s, double delay_ns) {
  if (bin_count_ > 0 && x_s - bins_[bin_count_ - 1].begin_s < bin_width_s_) {
    Bin& bin = bins_[bin_count_ - 1];
    bin.sum_x_s += x_s;
    ++bin.count;
    if (above_line(x_s, delay_ns) >= above_line(bin.x_s, bin.delay_ns)) return false;
    bin.x_s = x_s;
    bin.delay_ns = delay_ns;
    return true;
  }
  evict(x_s);
  bins_[bin_count_++] = {x_s, x_s, delay_ns, x_s, 1};
  return true;
}

/// Makes room for one bin: old ones go; while the window is not yet full, neighbours are merged instead.
void DelayEnvelope::evict(double x_s) {
  std::size_t old = 0;
  while (bin_count_ - old > kFewestBins && x_s - bins_[old].begin_s > config_.window_s) ++old;
  if (old > 0) {
    std::move(bins_.begin() + static_cast<std::ptrdiff_t>(old), bins_.begin() + static_cast<std::ptrdiff_t>(bin_count_),
              bins_.begin());
    bin_count_ -= old;
  }
  if (bin_count_ == kBins) merge_pairs();
}

void DelayEnvelope::merge_pairs() {
  for (std::size_t i = 0; i < kBins / 2; ++i) {
    const Bin& a = bins_[2 * i];
    const Bin& b = bins_[2 * i + 1];
    const bool a_lower = above_line(a.x_s, a.delay_ns) <= above_line(b.x_s, b.delay_ns);
    const Bin& low = a_lower ? a : b;
    bins_[i] = {a.begin_s, low.x_s, low.delay_ns, a.sum_x_s + b.sum_x_s, a.count + b.count};
  }
  bin_count_ = kBins / 2;
  bin_width_s_ = std::max(2.0 * bin_width_s_, (bins_[bin_count_ - 1].begin_s - bins_[0].begin_s) / (kBins / 2));
}

/// Andrew's monotone chain, lower half. The bins are sorted by abscissa already.
DelayEnvelope::Hull DelayEnvelope::lower_hull() const {
  Hull hull;
  for (std::size_t i = 0; i < bin_count_; ++i) {
    const Hull::Point p{bins_[i].x_s, bins_[i].delay_ns};
    while (hull.size >= 2) {
      const Hull::Point& a = hull.points[hull.size - 2];
      const Hull::Point& b = hull.points[hull.size - 1];
      if ((b.x_s - a.x_s) * (p.delay_ns - a.delay_ns) > (b.delay_ns - a.delay_ns) * (p.x_s - a.x_s)) break;
      --hull.size;
    }
    hull.points[hull.size++] = p;
  }
  return hull;
}

void DelayEnvelope::fit(double x_s) {
  const Hull hull = lower_hull();
  double count = 0.0;
  double sum_x_s = 0.0;
  for (std::size_t i = 0; i < bin_count_; ++i) {
    count += bins_[i].count;
    sum_x_s += bins_[i].sum_x_s;
  }
  const Posterior posterior{hull, sum_x_s / count, count / jitter_ns(), prior_skew_, prior_sigma_};
  line_ = posterior.integrate(x_s);
  const double gap_ns = jitter_ns() / (count + 1.0);  // expected distance of the lowest of `count` above the edge
  line_.offset_ns -= gap_ns;
  line_.sigma_ns = std::hypot(line_.sigma_ns, gap_ns, 0.5 * config_.noise_floor_s * 1e9);
}

}  // namespace slamd
