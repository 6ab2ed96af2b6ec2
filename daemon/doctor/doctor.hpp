#pragma once
// All checks of the machine slamd is to run on, in the order they are told, and their text. Needs no daemon and no rights.

#include <string>

#include "daemon/doctor/finding.hpp"
#include "daemon/doctor/host_files.hpp"

namespace slamd::doctor {

/// What slamd will ask of the machine. The defaults are those of slamd.yaml.
struct Wanted {
  std::string lidar_address = "192.168.1.201";  // as the VLP-16 is delivered
  std::int64_t receive_buffer_bytes = 4 << 20;
  int priority = 60;       // the highest of the daemon's threads
  int estimator_cpu = -1;  // -1: not pinned
};

/// Kernel, processor, clock, network, and what the calling process may do.
Findings check_machine(const HostFiles& host, const Wanted& wanted);

/// The same beside a running slamd: its limits instead of the caller's, and what it has obtained. Of every slamd that
/// runs; of the caller's limits when none does.
Findings check_machine_and_daemons(const HostFiles& host, Wanted wanted);

/// A line for each finding, below it what mends it.
std::string text(const Findings& findings);

/// Whether none is wrong; what could not be found out is not held against the machine.
bool all_right(const Findings& findings);

}  // namespace slamd::doctor
