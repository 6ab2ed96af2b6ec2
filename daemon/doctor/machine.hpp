#pragma once
// Whether kernel and processor let a thread run in time. What this user or process may do is in rights.hpp.

#include "daemon/doctor/finding.hpp"
#include "daemon/doctor/host_files.hpp"

namespace slamd::doctor {

/// PREEMPT_RT or not.
Finding check_kernel(const HostFiles& host);

/// The processor's frequency governor: "performance" on every CPU.
Finding check_governor(const HostFiles& host);

/// How long a sleeping CPU may take to wake: idle states that are allowed, and the limit that somebody holds through
/// /dev/cpu_dma_latency (readable for root alone).
Finding check_idle_states(const HostFiles& host);

/// A clock source that is read without leaving the processor.
Finding check_clock_source(const HostFiles& host);

}  // namespace slamd::doctor
