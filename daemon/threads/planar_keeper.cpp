#include "daemon/threads/planar_keeper.hpp"

#include "daemon/store/checkpoint_file.hpp"
#include "daemon/threads/state_directory.hpp"

namespace slamd {
namespace {

constexpr const char* kFileName = "/planar.map";

std::vector<std::uint8_t> encoded(const PlanarMapper& mapper, std::size_t i) {
  const PlanarPose& T = mapper.keyframes()[i].T_map_base;
  const PlanarScan& scan = mapper.keyframes()[i].scan;
  return encode(StoredPlanarKeyframe{scan.time, {T.translation.x(), T.translation.y(), wrap_angle(T.yaw_rad)}, scan.origin, scan.points});
}

}  // namespace

std::string planar_checkpoint_path(const CheckpointConfig& config) {
  const std::string folder = config.folder.empty() ? state_directory() : config.folder;
  return folder.empty() ? folder : folder + kFileName;
}

PlanarKeeper::PlanarKeeper(const CheckpointConfig& config, const VehicleGeometry& vehicle)
    : path_{planar_checkpoint_path(config)}, config_{config}, vehicle_{vehicle} {
  report_.state = path_.empty() ? "off" : "waiting";
}

void PlanarKeeper::keep(const PlanarMapper& mapper, HostTime now) {
  if (path_.empty() || mapper.keyframes().size() == 0 || mapper.keyframes().back().scan.time <= kept_) return;
  if (now >= next_whole_) {
    next_whole_ = now + config_.period;
    write_whole(mapper);
  } else if (report_.state == "healthy") {
    add_newest(mapper);
  }
}

/// From the newest backwards as many as the budget holds.
void PlanarKeeper::write_whole(const PlanarMapper& mapper) {
  std::vector<std::vector<std::uint8_t>> newest;
  std::size_t size = 0;
  for (std::size_t i = mapper.keyframes().size(); i-- > 0 && size < config_.byte_budget;) {
    newest.push_back(encoded(mapper, i));
    size += newest.back().size();
  }
  std::vector<std::uint8_t> bytes = encode_planar_head(vehicle_);
  for (auto keyframe = newest.rbegin(); keyframe != newest.rend(); ++keyframe) bytes.insert(bytes.end(), keyframe->begin(), keyframe->end());
  const Result<void> done = write_checkpoint(bytes, path_);
  if (done) {
    ++report_.written;
    report_.bytes = 0;
    kept_ = mapper.keyframes().back().scan.time;
  }
  tell(done, bytes.size());
}

void PlanarKeeper::add_newest(const PlanarMapper& mapper) {
  std::size_t first = mapper.keyframes().size();
  while (first > 0 && mapper.keyframes()[first - 1].scan.time > kept_) --first;
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = first; i < mapper.keyframes().size(); ++i) {
    const std::vector<std::uint8_t> keyframe = encoded(mapper, i);
    bytes.insert(bytes.end(), keyframe.begin(), keyframe.end());
  }
  const Result<void> done = append_to_checkpoint(bytes, path_);
  if (done) {
    report_.steps += mapper.keyframes().size() - first;
    kept_ = mapper.keyframes().back().scan.time;
  }
  tell(done, bytes.size());
}

void PlanarKeeper::tell(const Result<void>& done, std::size_t bytes) {
  report_.state = done ? "healthy" : "failed";
  report_.reason = done ? "" : done.reason();
  if (done) report_.bytes += bytes;
}

}  // namespace slamd
