#pragma once
// How far a fix may be from the truth, from what the receiver said. A pure function; no filtering over time.

#include "drivers/gnss/epoch_assembler.hpp"

namespace slamd {

struct GnssNoiseConfig {
  double sigma_min_m = 1.0;      // strong fix: no receiver is believed beyond this
  double sigma_max_m = 5.0;      // weak fix
  double range_error_m = 1.25;   // per unit of HDOP, autonomous with many satellites
  double vertical_factor = 1.8;  // height against horizontal, where no GST says it
};

struct GnssSigma {
  double horizontal_m;  // per axis, sigma_min_m .. sigma_max_m
  double vertical_m;    // vertical_factor times these bounds
};

/// GST where present; else HDOP times the range error, less with corrections, more with few satellites; sigma_max_m
/// when the receiver said nothing or reckons without satellites.
GnssSigma estimate_sigma(const GnssEpoch& epoch, GnssQuality quality, const GnssNoiseConfig& config);

}  // namespace slamd
