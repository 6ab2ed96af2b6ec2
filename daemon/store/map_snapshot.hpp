#pragma once
// What a query found in the map: which points of which keyframes, where they were at that moment. It shares the points
// with the store and places them when read, so that it takes a bit a point and not sixteen bytes.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "daemon/store/cloud_file.hpp"
#include "daemon/store/geo_reference.hpp"
#include "daemon/store/packed_point.hpp"
#include "estimator/types/pose.hpp"

namespace slamd {

class MapSnapshot {
 public:
  struct Part {
    Pose T_map_base;
    std::shared_ptr<const PackedPoints> points;
    std::vector<bool> chosen;   // of points
    std::size_t begin = 0;      // number of its first chosen point in the snapshot
  };

  std::size_t keyframes = 0;  // that were read
  bool truncated = false;     // max_points was reached
  std::optional<GeoReference> reference;

  std::size_t size() const { return size_; }

  /// Fills out with the points from number `begin` on, map frame, ordered by keyframe; begin + out.size() <= size().
  void read(std::size_t begin, std::span<CloudPoint> out) const;

  /// All of them at once.
  PointCloud points() const;

  /// Takes a keyframe's choice.
  void append(Part part);

 private:
  std::vector<Part> parts_;
  std::size_t size_ = 0;
};

/// For files of it; the snapshot outlives the source.
CloudSource source_of(const MapSnapshot& snapshot);

}  // namespace slamd
