#pragma once
// The PNG of ape and rpe: the trajectory coloured by error beside the error over the drive.

#include <string>
#include <vector>

#include "tools/slam-eval/program/report.hpp"

namespace slamd::eval {

struct ErrorPlot {
  ReportRow row;                 // relation and statistics that are drawn
  std::string metric;            // "APE" or "RPE"
  std::vector<double> errors;    // one an entry of `poses`
  std::vector<Pose> poses;       // of the estimate, in the truth's frame as far as aligned
  std::vector<double> stamps_s;  // of the poses; empty = counted
  std::vector<Pose> truth;       // all matched poses
};

/// Writes a PNG of 1700x760. Throws plot::PlotError when that fails.
void write_error_plot(const ErrorPlot& plot, const std::string& path);

}  // namespace slamd::eval
