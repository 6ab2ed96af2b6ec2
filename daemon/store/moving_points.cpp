#include "daemon/store/moving_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamd {
namespace {

constexpr std::size_t kDrawn = 8;           // earlier scans that are asked about a new keyframe's points
constexpr std::uint64_t kDrawnStride = 2;   // keyframes from one of them to the next
constexpr double kFarthest_m = 45.0;        // between sensor and keyframe: beyond it nothing is asked
constexpr std::uint8_t kSettled = 4;        // seen so often and never passed: not asked about any more
constexpr float kNormalUnit = 127.0F;

}  // namespace

MovingPoints::MovingPoints(const MovingPointsConfig& config, const Pose& T_base_lidar)
    : config_{config}, T_base_lidar_{T_base_lidar} {}

std::vector<MovingPoints::Verdict> MovingPoints::add(const Keyframe& keyframe, const PackedPoints& points) {
  std::vector<Verdict> verdicts;
  if (config_.keyframes == 0) return verdicts;
  const Drawn now{keyframe.state.T_odom_base * T_base_lidar_, fresh_image()};
  now.image->draw(keyframe, T_base_lidar_);
  for (Suspects& suspects : recent_) question(now, suspects);
  recent_.push_back(make_suspects(keyframe, points, *now.image));
  for (const Drawn& witness : drawn_) question(witness, recent_.back());
  for (Suspects& suspects : recent_) judge(suspects, verdicts);
  if (recent_.size() > config_.keyframes) recent_.pop_front();
  if (added_++ % kDrawnStride == 0) drawn_.push_back(now);
  return verdicts;
}

/// The oldest image's memory when there are enough, else new memory.
std::shared_ptr<RayImage> MovingPoints::fresh_image() {
  if (drawn_.size() < kDrawn) return std::make_shared<RayImage>();
  std::shared_ptr<RayImage> oldest = std::move(drawn_.front().image);
  drawn_.pop_front();
  return oldest;
}

MovingPoints::Suspects MovingPoints::make_suspects(const Keyframe& keyframe, const PackedPoints& points,
                                                   const RayImage& own) const {
  Suspects suspects{keyframe.id, keyframe.state.T_odom_base, points, std::vector<Tally>(points.size())};
  const Eigen::Matrix3f R_base_lidar = T_base_lidar_.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_base_lidar_.translation.cast<float>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f normal = R_base_lidar * own.normal_at(R_base_lidar.transpose() * (points[i].position() - t));
    for (int axis = 0; axis < 3; ++axis) {
      suspects.tallies[i].normal[static_cast<std::size_t>(axis)] =
          static_cast<std::int8_t>(std::lround(normal[axis] * kNormalUnit));
    }
  }
  return suspects;
}

void MovingPoints::question(const Drawn& witness, Suspects& suspects) const {
  const Pose T_lidar_base = witness.T_odom_lidar.inverse() * suspects.T_odom_base;
  if (T_lidar_base.translation.norm() > kFarthest_m) return;
  const Eigen::Matrix3f R = T_lidar_base.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = T_lidar_base.translation.cast<float>();
  for (std::size_t i = 0; i < suspects.points.size(); ++i) {
    Tally& tally = suspects.tallies[i];
    if (tally.seen >= kSettled && tally.passed == 0) continue;
    const auto& [nx, ny, nz] = tally.normal;
    const Eigen::Vector3f normal = Eigen::Vector3f{Eigen::Vector3i{nx, ny, nz}.cast<float>()} / kNormalUnit;
    const RayImage::Witness witnessed = witness.image->ask(R * suspects.points[i].position() + t, R * normal);
    if (witnessed == RayImage::Witness::kSeen && tally.seen < 255) ++tally.seen;
    if (witnessed == RayImage::Witness::kPassed && tally.passed < 255) ++tally.passed;
  }
}

bool MovingPoints::is_moving(const Tally& tally) const {
  return tally.passed >= config_.fewest_witnesses && tally.passed > 2 * tally.seen;
}

void MovingPoints::judge(Suspects& suspects, std::vector<Verdict>& verdicts) const {
  const auto moving = [this](const Tally& tally) { return is_moving(tally); };
  if (std::none_of(suspects.tallies.begin(), suspects.tallies.end(), moving)) return;
  Verdict verdict{suspects.id, suspects.T_odom_base, {}, {}};
  std::vector<Tally> tallies;
  for (std::size_t i = 0; i < suspects.points.size(); ++i) {
    const bool remove = is_moving(suspects.tallies[i]);
    (remove ? verdict.removed : verdict.kept).push_back(suspects.points[i]);
    if (!remove) tallies.push_back(suspects.tallies[i]);
  }
  suspects.points = verdict.kept;
  suspects.tallies = std::move(tallies);
  verdicts.push_back(std::move(verdict));
}

}  // namespace slamd
