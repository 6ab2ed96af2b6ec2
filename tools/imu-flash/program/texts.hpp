#pragma once
// The longer texts of imu-flash: what --help ends with and what --rescue says.

namespace slamd::flash {

extern const char* const kHelpFooter;
extern const char* const kRescueText;

}  // namespace slamd::flash
