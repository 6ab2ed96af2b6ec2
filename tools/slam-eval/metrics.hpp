#pragma once
// APE and RPE of matched poses with their statistics, by the definitions of evo. Reads no file and aligns nothing.

#include <cstddef>
#include <utility>
#include <vector>

#include "estimator/types/pose.hpp"

namespace slamd::eval {

/// Which number is taken of the error pose E.
enum class PoseRelation {
  kTranslationPart,     // |t(E)|, m
  kRotationAngleDeg,    // angle of R(E)
  kRotationAngleRad,
  kRotationPart,        // Frobenius norm of R(E) - I
  kFullTransformation,  // Frobenius norm of E - I
  kPointDistance,       // APE: |t(E)|; RPE: difference of the two distances travelled as the crow flies, m
};

/// evo's words: "translation_part", "rotation_angle_deg", ...
const char* name(PoseRelation relation);
/// "m", "deg", "rad" or "".
const char* unit(PoseRelation relation);

struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;  // of the population (divided by count)
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;  // sum of squared errors
};

/// All zero for an empty list.
Statistics statistics(std::vector<double> errors);

/// One error a pose: E_i = estimate_i^-1 * truth_i. Equal lengths; align before.
std::vector<double> ape(const std::vector<Pose>& truth, const std::vector<Pose>& estimate, PoseRelation relation);

enum class DeltaUnit { kFrames, kMetres, kDegrees };

struct RpeOptions {
  double delta = 1.0;
  DeltaUnit unit = DeltaUnit::kFrames;
  bool all_pairs = false;          // every pose starts a pair; else the pairs follow each other without overlap
  double relative_tolerance = 0.1; // with all_pairs and metres or degrees: how far a pair may be from delta
  bool pairs_from_truth = false;   // measure delta along the truth instead of the estimate
};

using PosePair = std::pair<std::size_t, std::size_t>;

/// Indices (i, j) that are delta apart. Consecutive metres: a pair ends at the first pose with at least delta since the
/// last end, and the way up to the first end opens no pair (as in evo). Throws InputError when delta is not positive,
/// or is not whole for frames.
std::vector<PosePair> pose_pairs(const std::vector<Pose>& poses, const RpeOptions& options);

/// One error a pair: E = (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j).
std::vector<double> rpe(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                        const std::vector<PosePair>& pairs, PoseRelation relation);

}  // namespace slamd::eval
