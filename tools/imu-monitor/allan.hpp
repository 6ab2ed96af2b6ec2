#pragma once
// Allan deviation of a sensor at rest, and the noise figures that follow from it. It reads no files and knows no
// sensor: any unit u in, u and seconds out.

#include <cstddef>
#include <span>
#include <vector>

namespace slamd::monitor {

struct AllanPoint {
  double tau_s = 0.0;
  double deviation = 0.0;  // u
  double freedom = 0.0;    // about how many independent differences it was made of
};

/// Overlapping Allan deviation of equally spaced samples, at up to 20 averaging times a decade from one period to a
/// ninth of the recording. Empty for fewer than 30 samples. O(samples x times). Source: IEEE Std 952-1997, annex C;
/// Riley, NIST SP 1065, 5.2.4 (overlapping estimator).
std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double period_s);

struct AllanFigures {
  double noise_density = 0.0;     // N, u/sqrt(Hz): the -1/2 slope at 1 s
  double bias_instability = 0.0;  // B, u: the flat part, its level divided by sqrt(2 ln 2 / pi) = 0.664
  double random_walk = 0.0;      // K, u/s/sqrt(Hz): the +1/2 slope at 3 s; 0 when the recording is too short to show it
  double flat_tau_s = 0.0;       // where the deviation is smallest
  bool flat_is_reached = false;  // false: it still falls at the end, bias_instability is an upper bound
};

/// N and K from the sum of slopes N^2/tau + B^2 2 ln 2/pi + K^2 tau/3 fitted to the squared deviation, each at least 0,
/// weighted by how well each point is known; B from the lowest point. All zero without points.
AllanFigures allan_figures(std::span<const AllanPoint> curve);

}  // namespace slamd::monitor
