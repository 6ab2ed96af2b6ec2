#pragma once
// Tells a broken IMU from a working one by its values alone: stuck, or saying what no vehicle does. Stores no samples and
// knows nothing of stamps that are wrong (odometry/imu_intake does).

#include <cstdint>
#include <optional>

#include "estimator/types/imu_sample.hpp"

namespace slamd {

struct ImuSanityConfig {
  double frozen_s = 0.05;             // all six values the same to the bit for so long: stuck
  double frozen_part_s = 0.5;         // likewise the three of gyro or accelerometer alone
  double least_force_mps2 = 2.0;      // a sample that says less than a vehicle feels is not used,
  double most_force_mps2 = 60.0;      // nor one that says more,
  double most_turn_rads = 8.0;        // or that it turns faster;
  double implausible_s = 0.25;        // and an IMU that says so for so long is broken
  double sane_again_s = 0.2;          // of good samples until a broken IMU is believed again
};

enum class ImuFault : std::uint8_t { kNone, kFrozen, kImplausible };

class ImuSanity {
 public:
  explicit ImuSanity(const ImuSanityConfig& config) : config_{config} {}

  /// Looks at the next sample in order of time. kNone: it may be used. Otherwise it may not; while not is_sane() nor may the
  /// samples since faulty_since(): they were the fault's beginning.
  ImuFault look(const ImuSample& sample);
  /// False from the moment a fault has lasted long enough to be one, until good samples have lasted as well.
  bool is_sane() const { return fault_ == ImuFault::kNone; }
  /// Whether the newest samples may turn out to be the beginning of a fault.
  bool is_suspect() const;
  /// The instant after which nothing was true; only while not is_sane().
  HostTime faulty_since() const { return faulty_since_; }
  void clear() { *this = ImuSanity{config_}; }

 private:
  /// Something that has held for the newest samples without a break.
  struct Run {
    HostTime since;
    std::uint32_t length = 0;
    void go_on(bool holds, HostTime begin) {
      if (length == 0) since = begin;
      length = holds ? length + 1 : 0;
    }
    bool lasts(HostTime now, double seconds) const;
  };

  bool is_plausible(const ImuSample& sample) const;
  /// The run that makes a fault at `now`; null when none does.
  const Run* fault_at(HostTime now) const;

  ImuSanityConfig config_;
  std::optional<ImuSample> last_;
  Run same_gyro_, same_accel_, same_all_, implausible_;
  ImuFault fault_ = ImuFault::kNone;
  HostTime faulty_since_;
  HostTime last_fault_;
};

}  // namespace slamd
