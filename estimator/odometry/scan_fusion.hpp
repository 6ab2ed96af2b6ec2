#pragma once
// One scan into the filter and the local map, and the life of that map: begun, contradicted, begun anew. Carries nothing
// through time and decides no status.

#include "estimator/filter/initialisation.hpp"
#include "estimator/odometry/keyframe_relation.hpp"
#include "estimator/odometry/scan_registration.hpp"
#include "estimator/odometry/velocity_search.hpp"

namespace slamd {

struct ScanFusionConfig {
  ScanRegistrationConfig registration;
  MapDriftConfig map_drift;
  VelocitySearchConfig velocity_search;
  std::uint32_t max_unfused_scans = 20;    // in a row, then a new local map is begun where we believe to be
};

struct ScanFusionStats {
  std::uint64_t fused = 0;
  std::uint64_t unfused = 0;        // too few inliers or contradiction
  std::uint64_t map_restarts = 0;
};

class ScanFusion {
 public:
  ScanFusion(const Pose& T_base_imu, const ScanFusionConfig& config);

  /// A first state: no map, and a search for the velocity when it is not known.
  void begin(const InitialState& first);
  /// The motion during the next scan, to be filled knot by knot before match().
  ScanMotion& motion() { return registration_.motion(); }
  /// Which share of the points of the scans from now on is worked on, 0..1 and not 0.
  void limit(double share) { registration_.limit(share); }
  /// De-skews the scan and updates `filter` (at the scan's end) with it, where there is a map to compare with. The filter is
  /// unchanged when the summary says that nothing fused. No allocation.
  /// coasted: no IMU measured any of the scan's motion. listener hears of every stage; may be null.
  UpdateSummary match(const Scan& scan, bool coasted, FilterSnapshot& filter, StageListener* listener);
  /// Whether no scan was fused for so long before this one that its motion is a guess.
  bool is_after_gap(const Scan& scan) const;
  /// Inserts the scan just matched into the map, or begins one with it. Once a scan.
  void absorb(const Scan& scan, const UpdateSummary& update, FilterSnapshot& filter);

  /// The map's walk while the vehicle moved from the posterior before to `filter`. Once a scan, after absorb().
  void carry_drift(const FilterSnapshot& before, FilterSnapshot& filter);
  KeyframeRelation& keyframe_relation() { return relation_; }

  const VelocitySearch& velocity_search() const { return velocity_search_; }
  /// Scans in a row that told the filter nothing.
  std::uint32_t unfused() const { return unfused_; }
  /// Whether the newest scan began a new map after older poses had been told.
  bool restarted() const { return restarted_; }
  bool map_is_mature() const;
  const PlaneMap& map() const { return registration_.map(); }
  const ScanFusionStats& stats() const { return stats_; }

 private:
  struct NewMap {
    bool defines_odom;   // no pose was told yet that it could contradict
    bool moving;         // its first scans are skewed
  };
  void begin_map(const NewMap& map, FilterSnapshot& filter);

  Pose T_base_imu_;
  ScanFusionConfig config_;
  ScanRegistration registration_;
  VelocitySearch velocity_search_;
  KeyframeRelation relation_;
  std::uint32_t unfused_ = 0;
  HostTime fused_at_{};         // end of the newest scan that the filter or a new map took
  bool had_imu_ = true;         // at any time since the start; without, the LiDAR is alone and believed whole
  bool odom_is_told_ = false;   // poses of this odom are out: a new map must carry their uncertainty on
  bool restarted_ = false;
  ScanFusionStats stats_;
};

}  // namespace slamd
