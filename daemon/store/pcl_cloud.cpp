#include "daemon/store/pcl_cloud.hpp"

#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <exception>
#include <string>

namespace slamd {
namespace {

pcl::PointCloud<pcl::PointXYZI> to_pcl(const PointCloud& points) {
  pcl::PointCloud<pcl::PointXYZI> cloud;
  cloud.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    cloud[i].x = points[i].x;
    cloud[i].y = points[i].y;
    cloud[i].z = points[i].z;
    cloud[i].intensity = points[i].intensity;
  }
  return cloud;
}

}  // namespace

Result<void> write_with_pcl(int fd, const PointCloud& points, CloudFormat format) {
  if (points.empty() && format == CloudFormat::kPly) return Error{"there are no points, and PLY cannot hold none"};
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // its remarks on stderr are not our log
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  try {
    const pcl::PointCloud<pcl::PointXYZI> cloud = to_pcl(points);
    const int written = format == CloudFormat::kPcd ? pcl::PCDWriter{}.writeBinaryCompressed(path, cloud)
                                                    : pcl::PLYWriter{}.write(path, cloud, true, false);
    if (written != 0) return Error{"the point cloud could not be written"};
  } catch (const std::exception&) {
    return Error{"the point cloud could not be written"};
  }
  return {};
}

}  // namespace slamd
