#include "drivers/gnss/gnss_noise.hpp"

#include <algorithm>
#include <cmath>

namespace slamd {
namespace {

constexpr unsigned kEnoughSatellites = 8;
constexpr double kPerMissingSatellite = 0.15;

double correction_factor(GnssQuality quality) {
  switch (quality) {
    case GnssQuality::kDifferential:
      return 0.7;
    case GnssQuality::kRtkFloat:
      return 0.3;
    case GnssQuality::kRtkFixed:
      return 0.1;
    default:
      return 1.0;
  }
}

std::optional<double> hdop_of(const GnssEpoch& epoch) {
  if (epoch.gga && epoch.gga->hdop && *epoch.gga->hdop > 0.0) return epoch.gga->hdop;
  if (epoch.gsa && epoch.gsa->hdop && *epoch.gsa->hdop > 0.0) return epoch.gsa->hdop;
  return std::nullopt;
}

std::optional<double> from_dilution(const GnssEpoch& epoch, GnssQuality quality, const GnssNoiseConfig& config) {
  const std::optional<double> hdop = hdop_of(epoch);
  if (!hdop) return std::nullopt;
  double sigma = *hdop * config.range_error_m * correction_factor(quality);
  if (epoch.gga && epoch.gga->satellites < kEnoughSatellites) {
    sigma *= 1.0 + kPerMissingSatellite * (kEnoughSatellites - epoch.gga->satellites);
  }
  return sigma;
}

std::optional<double> from_gst(const GnssEpoch& epoch) {
  if (!epoch.gst || !epoch.gst->sigma_north_m || !epoch.gst->sigma_east_m) return std::nullopt;
  return std::hypot(*epoch.gst->sigma_north_m, *epoch.gst->sigma_east_m) / std::sqrt(2.0);
}

}  // namespace

GnssSigma estimate_sigma(const GnssEpoch& epoch, GnssQuality quality, const GnssNoiseConfig& config) {
  const bool without_satellites = quality == GnssQuality::kDeadReckoning || quality == GnssQuality::kSimulated;
  std::optional<double> horizontal = from_gst(epoch);
  if (!horizontal) horizontal = from_dilution(epoch, quality, config);
  if (without_satellites) horizontal = config.sigma_max_m;

  GnssSigma sigma{};
  sigma.horizontal_m = std::clamp(horizontal.value_or(config.sigma_max_m), config.sigma_min_m, config.sigma_max_m);
  const bool gst_height = epoch.gst && epoch.gst->sigma_height_m && !without_satellites;
  const double vertical = gst_height ? *epoch.gst->sigma_height_m : sigma.horizontal_m * config.vertical_factor;
  sigma.vertical_m =
      std::clamp(vertical, config.sigma_min_m * config.vertical_factor, config.sigma_max_m * config.vertical_factor);
  return sigma;
}

}  // namespace slamd
