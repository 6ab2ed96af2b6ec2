#pragma once
// `slamd --rt-check`: what the configuration asks of the machine, held against the machine. The checks are daemon/doctor's.

#include <iosfwd>

#include "daemon/config/config.hpp"
#include "daemon/doctor/doctor.hpp"

namespace slamd {

doctor::Wanted wanted_of(const Config& config);

/// Prints every finding; kExitDone when nothing is wrong, else kExitFailure.
int check_real_time(const Config& config, std::ostream& out);

}  // namespace slamd
