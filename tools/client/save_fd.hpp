#pragma once
// A descriptor's content as a file that appears whole or not at all. Not for streams: it reads from offset 0.

#include <cstddef>
#include <functional>
#include <string>

namespace slamd::client {

/// Copies all content to `path` by way of a temporary file beside it, synced and renamed. on_bytes is told how much is
/// written. Throws Failure of SLAMD_SYSTEM; then `path` is as it was.
void save_fd(int fd, const std::string& path, const std::function<void(std::size_t bytes)>& on_bytes);

}  // namespace slamd::client
