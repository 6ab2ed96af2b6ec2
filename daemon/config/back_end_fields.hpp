#pragma once
// The back end's table of keys. Split from config_fields.cpp by length only.

#include <vector>

#include "daemon/config/field.hpp"
#include "estimator/graph/back_end.hpp"

namespace slamd {

std::vector<Field> back_end_fields(BackEndConfig& config);

}  // namespace slamd
