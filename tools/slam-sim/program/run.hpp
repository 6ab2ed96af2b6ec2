#pragma once
// The two things slam-sim does with a drive: write it to a folder, or send it in real time.

#include "tools/slam-sim/program/options.hpp"

namespace slamd::sim {

/// Exit codes: 0 done, 130 ended by SIGINT or SIGTERM. Throw std::runtime_error when an output cannot be opened.
int run_folder(const Options& options);
int run_live(const Options& options);

}  // namespace slamd::sim
