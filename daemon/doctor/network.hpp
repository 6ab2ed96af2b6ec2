#pragma once
// Whether the kernel keeps the LiDAR's packets and takes them without standing in the way. Sends and receives nothing.

#include "daemon/doctor/finding.hpp"
#include "daemon/doctor/host_files.hpp"

namespace slamd::doctor {

/// net.core.rmem_max against the buffer that the LiDAR's socket asks for.
Finding check_socket_buffer(const HostFiles& host, std::int64_t wanted_bytes);

/// The network port in whose own network `address` (dotted IPv4) is, by the kernel's routes; nothing when there is none.
std::optional<std::string> port_towards(const HostFiles& host, const std::string& address);

/// Whether the interrupts of the LiDAR's port may run on the CPU that the estimator is pinned to (-1: to none).
Finding check_port_interrupts(const HostFiles& host, const std::string& lidar_address, int estimator_cpu);

}  // namespace slamd::doctor
