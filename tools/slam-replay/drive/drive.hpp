#pragma once
// A recorded drive as one stream of events in order of arrival: the same drivers and the same merge as the daemon's. It opens
// nothing: drive_folder.hpp and the bags do.

#include <optional>
#include <variant>

#include "daemon/threads/event_merge.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// Nothing came for a while, up to this instant.
struct Silence {
  HostTime until;
};

/// One event; what it points to stays valid until the next one is asked for. std::monostate: the drive is over.
using Event = std::variant<std::monostate, Silence, const ImuSample*, const LidarPacket*, const GnssFix*, const WheelOdometry*,
                           const LaserScan*>;

class Drive {
 public:
  Drive(Sensors sensors, const EventMergeConfig& merge);

  Event next();
  /// Of the points of the scan that ended then: less than 1 where the live estimator had no time for more.
  double scan_share(HostTime scan_end) const;
  /// Share of the recording that has been read, 0..1.
  double progress() const;

  const Sensors& sensors() const { return sensors_; }

 private:
  /// A stream with its oldest item that has not become an event.
  template <class Item>
  struct Head {
    const Item* item = nullptr;
    bool taken = true;   // the item has become an event
    bool ended = false;
    void refill(Stream<Item>* stream);
    std::optional<HostTime> arrival() const;
    const Item* take();
  };

  Sensors sensors_;
  EventMergeConfig config_;
  EventMerge merge_;
  Head<LidarPacket> packet_;
  Head<ImuSample> sample_;
  Head<GnssFix> fix_;
  Head<WheelOdometry> wheel_;
  Head<LaserScan> laser_;
};

}  // namespace slamd::replay
