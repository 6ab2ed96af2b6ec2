#include "tools/plot/pcd_file.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstring>
#include <exception>

#include "tools/plot/canvas.hpp"

namespace slamd::plot {
namespace {

template <class T>
float as_float(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<float>(value);
}

float number(const std::uint8_t* bytes, const pcl::PCLPointField& field) {
  switch (field.datatype) {
    case pcl::PCLPointField::FLOAT32: return as_float<float>(bytes + field.offset);
    case pcl::PCLPointField::FLOAT64: return as_float<double>(bytes + field.offset);
    case pcl::PCLPointField::UINT8: return as_float<std::uint8_t>(bytes + field.offset);
    case pcl::PCLPointField::INT8: return as_float<std::int8_t>(bytes + field.offset);
    case pcl::PCLPointField::UINT16: return as_float<std::uint16_t>(bytes + field.offset);
    case pcl::PCLPointField::INT16: return as_float<std::int16_t>(bytes + field.offset);
    case pcl::PCLPointField::UINT32: return as_float<std::uint32_t>(bytes + field.offset);
    case pcl::PCLPointField::INT32: return as_float<std::int32_t>(bytes + field.offset);
    default: return 0.0F;
  }
}

const pcl::PCLPointField* find(const pcl::PCLPointCloud2& cloud, const char* name) {
  for (const auto& field : cloud.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

pcl::PCLPointCloud2 load(const std::string& path) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 cloud;
  try {
    if (pcl::PCDReader().read(path, cloud) < 0) throw PlotError(path + ": is not a readable PCD file");
  } catch (const PlotError&) {
    throw;
  } catch (const std::exception& error) {
    throw PlotError(path + ": is not a readable PCD file: " + error.what());
  }
  return cloud;
}

}  // namespace

PointCloud read_pcd(const std::string& path) {
  const pcl::PCLPointCloud2 cloud = load(path);
  const auto* x = find(cloud, "x");
  const auto* y = find(cloud, "y");
  const auto* z = find(cloud, "z");
  const auto* intensity = find(cloud, "intensity");
  if (x == nullptr || y == nullptr || z == nullptr) throw PlotError(path + ": has no fields x, y, z");
  PointCloud points;
  const std::size_t count = cloud.point_step == 0 ? 0 : cloud.data.size() / cloud.point_step;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* bytes = cloud.data.data() + i * cloud.point_step;
    const CloudPoint p{number(bytes, *x), number(bytes, *y), number(bytes, *z),
                       intensity == nullptr ? 0.0F : number(bytes, *intensity)};
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) points.push_back(p);
  }
  if (points.empty()) throw PlotError(path + ": holds no point");
  return points;
}

}  // namespace slamd::plot
