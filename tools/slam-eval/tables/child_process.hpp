#pragma once
// Runs another program to its end. No pipes: what it says goes into a file.

#include <string>
#include <vector>

namespace slamd::eval {

/// Runs arguments[0] (a path) with its output in log_path, which is overwritten. Returns when it has ended. Throws InputError with
/// the end of what it said when it cannot be started or does not end with 0. Any thread.
void run_program(const std::vector<std::string>& arguments, const std::string& log_path);

/// Path of one of the project's programs: in the folder of the running one, or where the build puts it. Throws InputError
/// when it is at neither place.
std::string find_sibling(const std::string& name);

}  // namespace slamd::eval
