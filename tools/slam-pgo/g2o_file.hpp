#pragma once
// Pose graphs in g2o's text format: VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT and FIX, one kind of space a file.
// Other records are refused, not skipped: a graph with parts left out has another optimum. Only PARAMS_... are left out:
// they place sensors, and no edge between poses asks for one.

#include <cstddef>
#include <cstdint>
#include <istream>
#include <ostream>
#include <string>
#include <variant>
#include <vector>

#include "estimator/graph/group_se2.hpp"
#include "estimator/graph/group_se3.hpp"
#include "estimator/graph/pose_graph.hpp"

namespace slamd::pgo {

template <class Group>
struct G2oGraph {
  std::vector<std::int64_t> ids;  // of graph.poses, rising
  bool complete = false;          // every pose had a VERTEX line; others are at the origin
  PoseGraph<Group> graph;
};
using AnyGraph = std::variant<G2oGraph<GroupSe2>, G2oGraph<GroupSe3>>;

struct G2oFault {
  std::size_t line = 0;  // from 1; 0: of the file as a whole
  std::string reason;
};

inline constexpr std::size_t kMaxPoses = 10'000'000;

/// Quaternions are normalised. Refused: words that are no finite numbers, too many or too few of them, ids beyond
/// 0..2^63-1, a pose given twice, an edge of a pose to itself, an information matrix that is not positive semidefinite or is
/// zero, records of other kinds or of both spaces, FIX of a pose that is not there, and a file without poses.
std::variant<AnyGraph, G2oFault> read_g2o(std::istream& in);

/// Reading it gives the same numbers. The caller looks at the stream's state.
void write_g2o(std::ostream& out, const AnyGraph& any);

}  // namespace slamd::pgo
