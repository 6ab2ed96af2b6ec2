#pragma once
// The path driven so far as stamped poses of base in odom, in bounded memory: when full, every second pose is let go and
// only every second new one is kept. Not a log: the newest pose is always there, older ones grow sparser.

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "estimator/types/pose.hpp"
#include "estimator/types/time.hpp"

namespace slamd {

struct StampedPose {
  HostTime time;
  Pose T_odom_base;
};

class TrajectoryStore {
 public:
  /// capacity  poses kept, at least 2 (at 10 a second 100,000 are 2.8 hours before the first thinning; 7 MB).
  explicit TrajectoryStore(std::size_t capacity = 100'000);

  /// Any one thread that is not real-time. Times must not go back; one that does is ignored and counted.
  void add(HostTime time, const Pose& T_odom_base);

  /// At most max_poses poses in order of time, evenly chosen, the first and the newest always among them. Any thread.
  std::vector<StampedPose> snapshot(std::size_t max_poses = static_cast<std::size_t>(-1)) const;

  std::size_t size() const;
  /// Each kept pose stands for this many added ones: 1 until the store was full, then 2, 4, ...
  std::uint64_t stride() const;
  std::uint64_t rejected() const;

 private:
  void thin_out();

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::vector<StampedPose> poses_;  // all at the stride, and at the end the newest pose whether or not it is
  bool newest_is_extra_ = false;    // the last of poses_ is off the stride and will be written over
  std::uint64_t added_ = 0;
  std::uint64_t stride_ = 1;
  std::uint64_t rejected_ = 0;
};

/// TUM text: "time_s x y z qx qy qz qw" a line, time with nine decimals.
std::string to_tum(const std::vector<StampedPose>& poses);

}  // namespace slamd
