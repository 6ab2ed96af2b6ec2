#pragma once
// GPS for the map: fixes with lever arm and latency, gated and latched, turned into where map lies in ENU, and into positions
// for the graph when they contradict the vehicle's own track. Never moves the track itself.

#include <deque>

#include "estimator/graph/enu_fit.hpp"
#include "estimator/graph/gnss_latency.hpp"
#include "estimator/graph/gnss_track.hpp"
#include "estimator/graph/gnss_trust.hpp"

namespace slamd {

struct GnssAlignmentConfig {
  EnuProjection projection = EnuProjection::kLocalCartesian;
  EnuFitConfig fit;
  GnssTrustConfig trust;
  double max_sigma_m = 5.0;           // weaker fixes are not used
  double max_chi2_horizontal = 13.82; // 2 degrees of freedom, 99.9 %
  double max_chi2_vertical = 10.83;   // 1 degree of freedom, 99.9 %: else the height alone is left out
  double position_period_s = 5.0;     // at most one position in the graph for so long
  std::uint32_t refit_every = 10;     // fixes, at least
  double refit_growth = 0.02;         // and the fixes have grown by this share
  double velocity_sigma_mps = 0.2;    // of the receiver's velocity, an axis; taken as independent once a second
  bool estimate_latency = true;
};

class GnssAlignment final : public PositionSource {
 public:
  GnssAlignment(const GnssAlignmentConfig& config, const Eigen::Vector3d& p_base_antenna);

  void add(const Keyframe& keyframe) override { track_.add(keyframe); }
  void add(const GnssFix& fix) override;
  bool update(const GraphView& view, const std::optional<EnuAlignment>& alignment) override;
  /// Empty as long as the track and the fixes agree as well as the receiver's own errors let them: a rigid track is then
  /// better than one bent by a metre's noise.
  std::span<const GnssPosition> positions() const override { return positions_; }
  std::optional<EnuAlignment> initial_alignment() const override;
  EnuOrigin origin() const override;
  void weigh(std::span<const double> weights) override;

  std::vector<FixReport> reports() const override;
  std::size_t bytes() const override;
  GnssLatency latency() const override;
  GnssTrust trust(HostTime now) const override { return latch_.trust(now); }

 private:
  struct Pending {
    GnssFix fix;
    FixReport report;
  };

  bool is_usable(const GnssFix& fix, FixReport& report) const;
  void refuse(const FixReport& report);
  void tie_pending();
  void tie_anew();
  EnuPair pair_of(const TiedFix& fix, const GraphView& view) const;
  std::vector<EnuPair> pairs(const GraphView& view) const;
  void refit(const GraphView& view);
  void judge(const GraphView& view, const EnuAlignment& alignment, TiedFix& fix);
  void judge_from(const GraphView& view, std::size_t first);
  void time_by(const TiedFix& fix, const Eigen::Vector2d& innovation_m, const Eigen::Quaterniond& R_enu_odom);
  double share_of(const TiedFix& fix) const;
  bool contradicts_track(const GraphView& view) const;
  void choose_positions();

  GnssAlignmentConfig config_;
  GnssTrack track_;
  std::optional<LocalEnu> enu_;
  std::deque<Pending> pending_;         // younger than the newest keyframe
  std::vector<Pending> fixes_;          // as they came, one of each of tied_: for tying anew when the latency has changed
  std::vector<TiedFix> tied_;
  std::deque<FixReport> refused_;       // fixes that were never tied, the newest
  std::uint64_t arrived_ = 0;
  std::size_t judged_ = 0;              // of tied_
  std::size_t fitted_ = 0;              // tied_ at the newest fit
  std::optional<EnuFit> fit_;
  GnssTrustLatch latch_;
  GnssLatencyEstimator latency_;
  bool bends_ = false;                  // positions enter the graph
  std::vector<GnssPosition> positions_;
};

}  // namespace slamd
