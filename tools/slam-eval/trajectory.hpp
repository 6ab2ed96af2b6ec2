#pragma once
// Trajectories as the evaluation reads them: poses with stamps, from TUM or KITTI text. No metric lives here.

#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimator/types/pose.hpp"

namespace slamd::eval {

/// Input that cannot be evaluated. what() is one sentence for the user, with file and line where there is one.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Trajectory {
  std::vector<double> stamps_s;  // one a pose, in file order; empty when the format has no time (KITTI)
  std::vector<Pose> poses;       // T_world_body

  bool has_stamps() const { return !stamps_s.empty(); }
};

enum class TrajectoryFormat { kTum, kKitti };

/// Reads `stamp x y z qx qy qz qw` a line (seconds, metres); `#` starts a comment, commas count as blanks.
/// Throws InputError with `name`, line and reason: wrong number of columns, no number, not finite, zero quaternion.
Trajectory read_tum(std::istream& in, const std::string& name);

/// Reads the 12 numbers of a row-major 3x4 T_world_body a line. The rotation is re-normalised; one that is further than
/// 1e-2 from a rotation is refused. Throws InputError as read_tum does.
Trajectory read_kitti(std::istream& in, const std::string& name);

/// Opens and reads a file. Throws InputError when it cannot be opened or holds no pose.
Trajectory load_trajectory(const std::filesystem::path& path, TrajectoryFormat format);

/// kKitti when the first line that is not a comment has 12 columns, else kTum.
TrajectoryFormat guess_format(const std::filesystem::path& path);

}  // namespace slamd::eval
