#include "daemon/store/cloud_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "daemon/store/cloud_writer.hpp"

namespace slamd {
namespace {

UniqueFd fresh_memfd(const char* name) { return UniqueFd{::memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING)}; }

Result<UniqueFd> sealed(UniqueFd fd) {
  constexpr int kSeals = F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL;
  if (::fcntl(fd.get(), F_ADD_SEALS, kSeals) != 0) return Error{"the memory file cannot be sealed"};
  return fd;
}

Error write_error() {
  switch (errno) {
    case ENOSPC: return {"the disk is full"};
    case EDQUOT: return {"the disk quota is used up"};
    case EFBIG: return {"the file is larger than the system allows"};
    case EACCES: case EPERM: return {"no permission to write there"};
    case ENOENT: return {"the folder does not exist"};
    case EROFS: return {"the file system is read-only"};
    default: return {"the file cannot be written"};
  }
}

constexpr Error kStopped{"the writing was stopped"};

/// Copies and syncs a mebibyte at a time, so that being told to stop takes effect soon on a slow disk too.
Result<void> copy_all(int from, int to, const WriteProgress& progress) {
  std::vector<char> buffer(std::size_t{1} << 20U);
  struct stat status {};
  const double size = ::fstat(from, &status) == 0 ? static_cast<double>(std::max<off_t>(status.st_size, 1)) : 1.0;
  off_t offset = 0;
  while (true) {
    if (progress && !progress(std::min(1.0, static_cast<double>(offset) / size))) return kStopped;
    const ssize_t count = ::pread(from, buffer.data(), buffer.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) return {};
    if (count < 0 || !write_all(to, buffer.data(), static_cast<std::size_t>(count)) || ::fdatasync(to) != 0) return write_error();
    offset += count;
  }
}

void sync_folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const UniqueFd fd{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (fd) ::fsync(fd.get());
}

}  // namespace

CloudSource source_of(const PointCloud& points) {
  return {points.size(), [&points](std::size_t begin, std::span<CloudPoint> out) {
            std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(begin), out.size(), out.begin());
          }};
}

Result<UniqueFd> cloud_memfd(const CloudSource& source, const CloudFileOptions& options) {
  UniqueFd fd = fresh_memfd("slamd-map");
  if (!fd) return Error{"no memory file for the map"};
  if (const Result<void> written = write_cloud(fd.get(), source, options); !written) return Error{written.reason()};
  return sealed(std::move(fd));
}

Result<UniqueFd> text_memfd(std::string_view text) {
  UniqueFd fd = fresh_memfd("slamd-text");
  if (!fd || !write_all(fd.get(), text.data(), text.size())) return Error{"no memory file for the text"};
  return sealed(std::move(fd));
}

Result<void> save_atomically(int content, const std::string& path, const WriteProgress& progress) {
  constexpr mode_t kMode = S_IRUSR | S_IWUSR | S_IRGRP;
  std::string temporary = path + ".XXXXXX";
  UniqueFd fd{::mkostemp(temporary.data(), O_CLOEXEC)};
  if (!fd) return write_error();
  Result<void> saved = copy_all(content, fd.get(), progress);
  if (saved && (::fchmod(fd.get(), kMode) != 0 || ::fsync(fd.get()) != 0 || ::rename(temporary.c_str(), path.c_str()) != 0)) {
    saved = write_error();
  }
  if (saved) {
    sync_folder_of(path);
  } else {
    ::unlink(temporary.c_str());
  }
  return saved;
}

}  // namespace slamd
