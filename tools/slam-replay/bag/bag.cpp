#include "tools/slam-replay/bag/bag.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "tools/slam-replay/bag/db3_bag.hpp"
#include "tools/slam-replay/bag/mcap_bag.hpp"
#include "tools/slam-replay/bag/ros1_bag.hpp"

namespace slamd::replay {
namespace {

enum class Form { kNone, kRos1, kDb3, kMcap, kFolder };

Form form_of(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    return std::filesystem::exists(path + "/metadata.yaml", error) ? Form::kFolder : Form::kNone;
  }
  std::array<char, 16> begin{};
  std::ifstream{path, std::ios::binary}.read(begin.data(), begin.size());
  const std::string_view text{begin.data(), begin.size()};
  if (text.starts_with("#ROSBAG V")) return Form::kRos1;
  if (text.starts_with("SQLite format 3")) return Form::kDb3;
  return text.starts_with("\x89MCAP") ? Form::kMcap : Form::kNone;
}

/// The files that metadata.yaml names, in its folder, or why there are none.
std::variant<std::vector<std::string>, std::string> files_of(const std::string& folder) {
  const std::string path = folder + "/metadata.yaml";
  try {
    const YAML::Node about = YAML::LoadFile(path)["rosbag2_bagfile_information"];
    if (!about || !about["relative_file_paths"]) return path + ": has no rosbag2_bagfile_information with relative_file_paths";
    const YAML::Node mode = about["compression_mode"];
    if (mode && (mode.as<std::string>("") == "FILE" || mode.as<std::string>("") == "file")) {
      return path + ": its files are compressed as a whole: `zstd -d` them and set compression_mode to \"\"";
    }
    std::vector<std::string> files;
    for (const YAML::Node& file : about["relative_file_paths"]) files.push_back(folder + "/" + file.as<std::string>());
    if (files.empty()) return path + ": names no file";
    return files;
  } catch (const YAML::Exception& fault) {
    return path + ":" + std::to_string(fault.mark.line + 1) + ": " + fault.msg;
  }
}

OpenedBag open_folder(const std::string& folder) {
  const auto found = files_of(folder);
  if (const auto* fault = std::get_if<std::string>(&found)) return *fault;
  const auto& files = std::get<std::vector<std::string>>(found);
  const Form form = form_of(files.front());
  if (form == Form::kDb3) return open_db3(files);
  if (form != Form::kMcap) return files.front() + ": is missing, or neither SQLite nor MCAP";
  if (files.size() > 1) return folder + ": has several MCAP files: give one of them";
  return open_mcap(files.front());
}

}  // namespace

std::string plain_type(std::string type) {
  constexpr std::string_view kMiddle = "/msg/";
  if (const std::size_t at = type.find(kMiddle); at != std::string::npos) type.replace(at, kMiddle.size(), "/");
  return type;
}

std::string fault_at(const std::string& path, std::uint64_t byte, const std::string& reason) {
  return path + ": byte " + std::to_string(byte) + ": " + reason;
}

bool is_bag(const std::string& path) { return form_of(path) != Form::kNone; }

OpenedBag open_bag(const std::string& path) {
  switch (form_of(path)) {
    case Form::kRos1: return open_ros1_bag(path);
    case Form::kDb3: return open_db3({path});
    case Form::kMcap: return open_mcap(path);
    case Form::kFolder: return open_folder(path);
    case Form::kNone: break;
  }
  return path + ": is no bag: neither ROS 1, ROS 2 (SQLite, folder with metadata.yaml) nor MCAP";
}

}  // namespace slamd::replay
