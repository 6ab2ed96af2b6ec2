#pragma once
// The bytes of a PCD or PLY file, written to an open descriptor piece by piece. Private to this folder; callers use
// cloud_file.hpp.

#include "daemon/store/cloud_file.hpp"

namespace slamd {

/// Writes all bytes, EINTR or not. False with errno set on failure.
bool write_all(int fd, const char* bytes, std::size_t count);

/// Writes the cloud at the descriptor's position 0. The memory it takes does not depend on the number of points.
Result<void> write_cloud(int fd, const CloudSource& source, const CloudFileOptions& options);

}  // namespace slamd
