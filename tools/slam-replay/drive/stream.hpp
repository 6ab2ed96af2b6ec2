#pragma once
// One sensor of a recording as the items that its driver makes, in order of arrival. Whether they come from a file of a drive
// folder or from a topic of a bag is the stream's own affair; it merges nothing (drive.hpp).

#include <cstdint>
#include <string>
#include <vector>

namespace slamd::replay {

/// What a stream lost and refused so far.
struct StreamReport {
  struct Rejection {
    std::string group, cause;  // as in report.json: rejections.<group>.<cause>
    std::uint64_t count;
  };

  std::uint64_t items = 0;        // handed out
  std::uint64_t missing = 0;      // never came, by stamps or sequence
  std::uint64_t clock_jumps = 0;  // of the device's clock
  std::uint64_t resets = 0;       // of the device
  std::vector<Rejection> rejections;
  std::string complaint;          // file, place and reason of the first part of the recording that could not be used; empty: none

  std::uint64_t refused() const {
    std::uint64_t sum = 0;
    for (const Rejection& rejection : rejections) sum += rejection.count;
    return sum;
  }
};

/// Item: ImuSample, LidarPacket, GnssFix, ... One thread.
template <class Item>
class Stream {
 public:
  virtual ~Stream() = default;
  /// The next item, valid until the next call; null at the end, and from then on.
  virtual const Item* next() = 0;
  virtual StreamReport report() const = 0;
  /// Share of the recording read so far, 0..1.
  virtual double progress() const = 0;
};

}  // namespace slamd::replay
