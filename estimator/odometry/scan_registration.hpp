#pragma once
// One scan against the local map: de-skew, choice of points, iterated update, insertion. Owns the map and all scratch
// memory; decides nothing about status.

#include "estimator/filter/ieskf.hpp"
#include "estimator/lidar/deskew.hpp"
#include "estimator/types/scan.hpp"

namespace slamd {

struct ScanRegistrationConfig {
  PlaneMapConfig map;
  PointToPlaneConfig point_to_plane;
  IeskfConfig update;
  double skewed_sigma_m = 0.05;       // of the first scan after a gap that made the prior unsure
  double guessed_sigma_m = 0.01;      // of a scan in whose time a present IMU was silent, or its biases not known
  std::uint32_t max_points = 3'500;   // segments that take part in one update, evenly chosen
};

/// What is known of a scan's motion before it is registered.
struct PriorMotion {
  bool coasted = false;     // no IMU measured it
  bool alone = false;       // nor ever any: the scan's motion is a guess, and a scan that contradicts the map is not fused
  bool after_gap = false;   // no scan before it for long: where the prior became unsure its velocity has skewed the scan
};

class ScanRegistration {
 public:
  static constexpr std::size_t kMaxSegments = 16'384;

  explicit ScanRegistration(const ScanRegistrationConfig& config);

  /// The motion during the scan, to be filled knot by knot before deskew().
  ScanMotion& motion() { return motion_; }
  /// Which share of the segments of the scans from now on is worked on, evenly chosen; 0..1 and not 0.
  void limit(double share) { share_ = share; }
  /// Moves the scan's segments to the scan's end. Once a scan, before update() and insert().
  void deskew(const Scan& scan, const Pose& T_imu_lidar);
  /// Fuses the de-skewed segments; see slamd::update. When it did, the segments are de-skewed anew by the motion that the
  /// posterior implies; several times over where the motion was a guess.
  UpdateSummary update(const Scan& scan, const PriorMotion& prior, FilterSnapshot& filter, StageListener* listener);
  /// Adds the de-skewed segments to the map at the filter's pose, when that is a new viewpoint.
  void insert(const InertialState& state);

  /// Of the de-skewed scan.
  std::size_t segments() const { return deskewed_.size(); }

  void clear_map() { map_.clear(); }
  const PlaneMap& map() const { return map_; }

 private:
  std::size_t share_of(std::size_t count) const;

  ScanRegistrationConfig config_;
  double share_ = 1.0;
  ScanMotion motion_;
  std::vector<MeasuredPoint> deskewed_;  // all segments
  std::vector<MeasuredPoint> chosen_;    // those that take part in the update
  PointToPlane residuals_;
  PlaneMap map_;
};

}  // namespace slamd
