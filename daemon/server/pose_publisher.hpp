#pragma once
// Publishes the newest pose: on the pose page, and as a wake-up for the server's thread. The real-time side of the
// server; it sends nothing itself and takes no lock.

#include <optional>

#include "daemon/ring/unique_fd.hpp"
#include "daemon/server/protocol/pose_page.hpp"
#include "estimator/types/nav_state.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

class PosePublisher {
 public:
  /// Takes over the page that an earlier daemon kept, or makes one when kept_page is none; makes the wake-up. Fails when
  /// the kernel gives no memfd or eventfd.
  static Result<PosePublisher> create(UniqueFd kept_page = {});

  /// One (real-time) thread. Writes the page and wakes the server: one non-blocking system call, no allocation.
  /// state       newest state, host time, odom
  /// T_map_odom  where odom lies in map; identity as long as nothing corrects the map
  /// utc_offset_ns  UTC minus host time, or kUtcOffsetUnknown
  void publish(const NavState& state, const Pose& T_map_odom = {}, std::int64_t utc_offset_ns = kUtcOffsetUnknown);

  /// Any thread. The newest sample; nullopt before the first publish().
  std::optional<PoseSample> newest() const { return page_.read(); }

  int page_fd() const { return page_.fd(); }      // read-only: may be handed to clients
  int keep_fd() const { return page_.keep_fd(); }  // for create() of the next daemon; not for clients
  int wake_fd() const { return wake_.get(); }     // eventfd, readable after publish(); for the server alone

 private:
  PosePublisher(PosePageWriter page, UniqueFd wake) : page_{std::move(page)}, wake_{std::move(wake)} {}

  PosePageWriter page_;
  UniqueFd wake_;
  std::uint64_t sequence_ = 0;
  std::uint32_t map_corrections_ = 0;
  Pose T_map_odom_;
};

}  // namespace slamd
