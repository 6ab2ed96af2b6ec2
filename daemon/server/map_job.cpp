#include "daemon/server/map_job.hpp"

#include <sys/stat.h>

#include "daemon/server/protocol/protocol.hpp"
#include "daemon/store/file_name.hpp"

namespace slamd {
namespace {

using nlohmann::json;
namespace error = protocol::error;

std::size_t size_of(int fd) {
  struct stat status {};
  return ::fstat(fd, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
}

}  // namespace

MapRequest read_map_request(Params& params) {
  MapRequest request;
  request.query.voxel_size_m = params.number("voxel_size_m", 0.2, 0.01, 100.0);
  const json box_json = params.object("box");
  Params box{box_json};
  if (const auto min_m = box.vector3("min_m")) request.query.box.min_m = Eigen::Vector3d{min_m->data()};
  if (const auto max_m = box.vector3("max_m")) request.query.box.max_m = Eigen::Vector3d{max_m->data()};
  params.adopt(box);
  return request;
}

bool is_good_map_name(const std::string& name) {
  return is_plain_file_name(name) && (name.ends_with(".pcd") || name.ends_with(".ply"));
}

Outcome make_map(const MapStore& store, const MapRequest& request, const JobProgress& progress) {
  const MapSnapshot snapshot =
      store.snapshot(request.query, [&progress](double share) { return progress("placing", share); });
  if (!progress("writing", 0.0)) return RpcError{error::kBusy, "nobody waits for the map any more"};
  Result<UniqueFd> fd = cloud_memfd(source_of(snapshot), {.format = request.format,
                                                      .reference = snapshot.reference,
                                                      .progress = [&](double share) { return progress("writing", share); }});
  if (!fd) return RpcError{error::kWriteFailed, fd.reason()};
  return Reply{{{"format", request.format == CloudFormat::kPcd ? "pcd" : "ply"},
                {"points", snapshot.size()},
                {"keyframes", snapshot.keyframes},
                {"truncated", snapshot.truncated},
                {"bytes", size_of(fd->get())},
                {protocol::kFdField, true}},
               std::move(fd).value()};
}

Outcome save_map(const MapStore& store, const MapRequest& request, const std::string& path,
                 const JobProgress& progress) {
  Outcome made = make_map(store, request, progress);
  if (std::holds_alternative<RpcError>(made)) return made;
  Reply& reply = std::get<Reply>(made);
  const Result<void> saved =
      save_atomically(reply.fd.get(), path, [&](double share) { return progress("saving", share); });
  if (!saved) return RpcError{error::kWriteFailed, saved.reason()};
  if (const std::optional<GeoReference> reference = store.geo_reference()) {
    const Result<UniqueFd> side = text_memfd(to_yaml(*reference));
    const Result<void> side_saved = side ? save_atomically(side->get(), path + ".yaml") : Result<void>{Error{side.reason()}};
    if (!side_saved) return RpcError{error::kWriteFailed, side_saved.reason()};
    reply.result["reference_path"] = path + ".yaml";
  }
  reply.fd.reset();
  reply.result.erase(protocol::kFdField);
  reply.result["path"] = path;
  return made;
}

Outcome make_tum(const TrajectoryStore& store) {
  const std::vector<StampedPose> poses = store.snapshot();
  Result<UniqueFd> fd = text_memfd(to_tum(poses));
  if (!fd) return RpcError{error::kWriteFailed, fd.reason()};
  return Reply{{{"format", "tum"},
                {"frame", "odom"},
                {"poses", poses.size()},
                {"stride", store.stride()},
                {"bytes", size_of(fd->get())},
                {protocol::kFdField, true}},
               std::move(fd).value()};
}

}  // namespace slamd
