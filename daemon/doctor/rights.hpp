#pragma once
// What the system permits a process, and what a running slamd has obtained of it: as /proc tells. Changes nothing.

#include "daemon/doctor/finding.hpp"
#include "daemon/doctor/host_files.hpp"

namespace slamd::doctor {

/// Process ids of every running slamd, as text.
std::vector<std::string> running_daemons(const HostFiles& host);

/// Whether the process ("self" or an id) may use SCHED_FIFO up to `priority`.
Finding check_priority_limit(const HostFiles& host, const std::string& process, int priority);

/// Whether it may lock all of its memory, what comes later too: an unlimited RLIMIT_MEMLOCK, or the right to lift it.
/// CAP_IPC_LOCK alone is not enough: under a finite limit slamd locks only the memory of its start.
Finding check_memory_limit(const HostFiles& host, const std::string& process);

/// Whether the real-time threads of a running slamd are under SCHED_FIFO.
Finding check_threads(const HostFiles& host, const std::string& process);

/// Whether the memory of a running slamd is locked.
Finding check_locked_memory(const HostFiles& host, const std::string& process);

/// The CPU that the estimator's thread is pinned to; -1 when to none, or not known.
int estimator_cpu_of(const HostFiles& host, const std::string& process);

}  // namespace slamd::doctor
