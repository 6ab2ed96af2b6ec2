#pragma once
// All failures of one sensor: those of its wire and those of its values. It only holds them together.

#include "daemon/inject/value_fault.hpp"
#include "daemon/inject/wire_fault.hpp"

namespace slamd {

/// Values: ImuValueFault, GnssValueFault or LidarValueFault. verbs must outlive it.
template <class Values>
struct SensorFault {
  SensorFault(const FaultSwitch& verbs, const WireFaultShape& shape) : wire{verbs, shape}, values{verbs} {}

  WireFault wire;
  Values values;
};

}  // namespace slamd
