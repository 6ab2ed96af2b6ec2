#include "tools/slam-eval/trajectory.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <optional>
#include <string_view>

namespace slamd::eval {
namespace {

constexpr double kMaxRotationError = 1e-2;  // Frobenius distance of a KITTI matrix from the nearest rotation

[[noreturn]] void fail(const std::string& name, std::size_t line, const std::string& reason) {
  throw InputError(name + ":" + std::to_string(line) + ": " + reason);
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; }

std::vector<std::string_view> columns(std::string_view text) {
  std::vector<std::string_view> words;
  while (true) {
    const auto begin = std::find_if_not(text.begin(), text.end(), is_blank);
    if (begin == text.end() || *begin == '#') return words;
    const auto end = std::find_if(begin, text.end(), is_blank);
    words.emplace_back(&*begin, static_cast<std::size_t>(end - begin));
    text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
  }
}

std::optional<double> to_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Calls row(numbers, line) for every line that has columns; each must have exactly `count` finite numbers.
template <class Row>
void for_each_row(std::istream& in, const std::string& name, std::size_t count, Row row) {
  std::vector<double> numbers(count);
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    const auto words = columns(text);
    if (words.empty()) continue;
    if (words.size() != count) {
      fail(name, line, "expected " + std::to_string(count) + " columns, found " + std::to_string(words.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = to_number(words[i]);
      if (!number) fail(name, line, "'" + std::string(words[i]) + "' is not a finite number");
      numbers[i] = *number;
    }
    row(numbers, line);
  }
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

}  // namespace

Trajectory read_tum(std::istream& in, const std::string& name) {
  Trajectory trajectory;
  for_each_row(in, name, 8, [&](const std::vector<double>& v, std::size_t line) {
    const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
    if (rotation.norm() < 1e-6) fail(name, line, "the quaternion is zero");
    trajectory.stamps_s.push_back(v[0]);
    trajectory.poses.push_back({rotation.normalized(), {v[1], v[2], v[3]}});
  });
  return trajectory;
}

Trajectory read_kitti(std::istream& in, const std::string& name) {
  Trajectory trajectory;
  for_each_row(in, name, 12, [&](const std::vector<double>& v, std::size_t line) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(v.data());
    const Eigen::Matrix3d rotation = nearest_rotation(T.leftCols<3>());
    if ((rotation - T.leftCols<3>()).norm() > kMaxRotationError || rotation.determinant() < 0.0) {
      fail(name, line, "the left 3x3 block is not a rotation");
    }
    trajectory.poses.push_back({Eigen::Quaterniond(rotation).normalized(), T.col(3)});
  });
  return trajectory;
}

Trajectory load_trajectory(const std::filesystem::path& path, TrajectoryFormat format) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path)) throw InputError(path.string() + ": cannot be opened for reading");
  Trajectory trajectory =
      format == TrajectoryFormat::kTum ? read_tum(in, path.string()) : read_kitti(in, path.string());
  if (trajectory.poses.empty()) throw InputError(path.string() + ": holds no pose");
  return trajectory;
}

TrajectoryFormat guess_format(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string text;
  while (std::getline(in, text)) {
    const auto words = columns(text);
    if (!words.empty()) return words.size() == 12 ? TrajectoryFormat::kKitti : TrajectoryFormat::kTum;
  }
  return TrajectoryFormat::kTum;
}

}  // namespace slamd::eval
