#include "drivers/gnss/nmea_parser.hpp"

namespace slamd {
namespace {

constexpr double kMovingMps = 1.0;          // at this speed a fix that does not change is not new
constexpr std::uint32_t kFrozenFixes = 10;  // without a speed: so many equal fixes in a row, height included

/// Both sentences must agree that there is a fix, where both are sent.
bool has_fix(const GnssEpoch& epoch) {
  const bool gga_says_no = epoch.gga && epoch.gga->quality == GnssQuality::kNone;
  const bool rmc_says_no = epoch.rmc && !epoch.rmc->active;
  const bool position = (epoch.gga && epoch.gga->position) || (epoch.rmc && epoch.rmc->position);
  return position && !gga_says_no && !rmc_says_no;
}

void fill_position(const GnssEpoch& epoch, GnssFix& fix) {
  const GeoPosition position = epoch.gga && epoch.gga->position ? *epoch.gga->position : *epoch.rmc->position;
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  fix.quality = epoch.gga ? epoch.gga->quality : epoch.rmc->quality;
  if (!epoch.gga) return;
  fix.satellites = static_cast<std::uint8_t>(epoch.gga->satellites);
  fix.hdop = static_cast<float>(epoch.gga->hdop.value_or(0.0));
  const bool flat = epoch.gsa && epoch.gsa->dimension == 2;
  if (epoch.gga->altitude_m && epoch.gga->geoid_separation_m && !flat) {
    fix.height_m = *epoch.gga->altitude_m + *epoch.gga->geoid_separation_m;
    fix.height_valid = true;
  }
}

/// RMC's where it has one, else VTG's.
void fill_velocity(const GnssEpoch& epoch, GnssFix& fix) {
  const bool from_rmc = epoch.rmc && epoch.rmc->speed_mps;
  const VtgMessage motion =
      from_rmc ? VtgMessage{epoch.rmc->speed_mps, epoch.rmc->course_deg} : epoch.vtg.value_or(VtgMessage{});
  fix.velocity_valid = motion.speed_mps && motion.course_deg;
  if (motion.speed_mps) fix.speed_mps = *motion.speed_mps;
  if (motion.course_deg) fix.course_deg = *motion.course_deg;
}

}  // namespace

NmeaParser::Config NmeaParser::Config::defaults() {
  Config config;
  config.clock.min_latency = std::chrono::milliseconds{120};
  config.clock.envelope = {.window_s = 120.0, .expected_jitter_s = 5e-3, .skew_sigma_ppm = 50.0, .noise_floor_s = 1e-3};
  config.clock.jump_threshold = std::chrono::milliseconds{300};
  config.clock.jump_confirm = std::chrono::seconds{5};
  config.clock.lock_sigma = std::chrono::milliseconds{5};
  config.clock.max_step = std::chrono::milliseconds{1};
  return config;
}

std::optional<GnssFix> NmeaParser::make_fix(const std::optional<GnssEpoch>& epoch, HostTime completed) {
  if (!epoch) return std::nullopt;
  if (!has_fix(*epoch)) {
    ++stats_.epochs_without_fix;
    return std::nullopt;
  }
  GnssFix fix;
  fix.arrival = completed;
  place_in_time(*epoch, fix);
  fill_position(*epoch, fix);
  fill_velocity(*epoch, fix);
  const GnssSigma sigma = estimate_sigma(*epoch, fix.quality, config_.noise);
  fix.sigma_horizontal_m = sigma.horizontal_m;
  fix.sigma_vertical_m = sigma.vertical_m;
  fix.stale = is_stale(fix);
  last_ = fix;
  ++stats_.fixes;
  stats_.stale += fix.stale ? 1 : 0;
  return fix;
}

/// Host time from the receiver's own time of day by its least delayed sentences: their jitter does not matter.
void NmeaParser::place_in_time(const GnssEpoch& epoch, GnssFix& fix) {
  fix.time = clock_.update(day_.unwrap(epoch.time_of_day, epoch.first_arrival), epoch.first_arrival);
  if (const std::optional<GnssTime> utc = calendar_.place(epoch.time_of_day, epoch.date)) {
    fix.utc = *utc;
    fix.utc_valid = true;
  }
}

bool NmeaParser::is_stale(const GnssFix& fix) {
  const bool same = stats_.fixes > 0 && fix.latitude_deg == last_.latitude_deg &&
                    fix.longitude_deg == last_.longitude_deg && fix.height_m == last_.height_m;
  unchanged_ = same ? unchanged_ + 1 : 0;
  return (same && fix.speed_mps > kMovingMps) || (unchanged_ >= kFrozenFixes && !fix.velocity_valid);
}

}  // namespace slamd
