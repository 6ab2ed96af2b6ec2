#include "drivers/ros/schemas.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

namespace slamd {
namespace {

struct Definition {
  std::string_view type;  // "sensor_msgs/Imu"
  std::string_view text;
};

constexpr std::array<Definition, 20> kDefinitions{{
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped", "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    {"nav_msgs/Odometry",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"},
    {"sensor_msgs/Imu",
     "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
     "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
     "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
    {"sensor_msgs/NavSatStatus",
     "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\nint8 status\nuint16 service\n"},
    {"sensor_msgs/NavSatFix",
     "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
     "float64[9] position_covariance\nuint8 position_covariance_type\n"},
    {"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    {"sensor_msgs/PointCloud2",
     "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\nuint32 point_step\n"
     "uint32 row_step\nuint8[] data\nbool is_dense\n"},
    {"slamd_msgs/RawRead", "uint8[16] source\nuint16 source_port\nuint16 destination_port\nuint8[] data\n"},
    {"slamd_msgs/ScanShare", "int64 scan_end_host_ns\nfloat64 share\n"},
}};

const Definition* find(std::string_view type) {
  const auto found = std::find_if(kDefinitions.begin(), kDefinitions.end(), [&](const Definition& d) { return d.type == type; });
  return found == kDefinitions.end() ? nullptr : &*found;
}

/// The types of the fields of a definition that are messages themselves.
std::vector<std::string_view> parts(std::string_view text) {
  std::vector<std::string_view> types;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    const std::string_view type = line.substr(0, line.find_first_of(" ["));
    if (type.find('/') != std::string_view::npos) types.push_back(type);
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return types;
}

void add_parts(std::string_view text, std::set<std::string_view>& known, std::string& schema) {
  for (const std::string_view type : parts(text)) {
    const Definition* part = find(type);
    if (part == nullptr || !known.insert(type).second) continue;
    schema += std::string(80, '=') + "\nMSG: " + std::string{type} + "\n" + std::string{part->text};
    add_parts(part->text, known, schema);
  }
}

}  // namespace

std::string ros2_schema(std::string_view type) {
  std::string plain{type};
  if (const std::size_t at = plain.find("/msg/"); at != std::string::npos) plain.replace(at, 5, "/");
  const Definition* definition = find(plain);
  if (definition == nullptr) return {};
  std::string schema{definition->text};
  std::set<std::string_view> known;
  add_parts(definition->text, known, schema);
  return schema;
}

}  // namespace slamd
