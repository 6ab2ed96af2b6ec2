#include "daemon/store/cloud_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <cstdlib>

#include "daemon/store/pcl_cloud.hpp"

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

bool write_all(int fd, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(fd, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

bool copy_all(int from, int to) {
  std::array<char, 65536> buffer;
  off_t offset = 0;
  while (true) {
    const ssize_t count = ::pread(from, buffer.data(), buffer.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count == 0;
    if (!write_all(to, buffer.data(), static_cast<std::size_t>(count))) return false;
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

Result<UniqueFd> cloud_memfd(const PointCloud& points, CloudFormat format) {
  UniqueFd fd = fresh_memfd("slamd-map");
  if (!fd) return Error{"no memory file for the map"};
  if (const Result<void> written = write_with_pcl(fd.get(), points, format); !written) return Error{written.reason()};
  return sealed(std::move(fd));
}

Result<UniqueFd> text_memfd(std::string_view text) {
  UniqueFd fd = fresh_memfd("slamd-text");
  if (!fd || !write_all(fd.get(), text.data(), text.size())) return Error{"no memory file for the text"};
  return sealed(std::move(fd));
}

Result<void> save_atomically(int content, const std::string& path) {
  constexpr mode_t kMode = S_IRUSR | S_IWUSR | S_IRGRP;
  std::string temporary = path + ".XXXXXX";
  UniqueFd fd{::mkostemp(temporary.data(), O_CLOEXEC)};
  if (!fd) return write_error();
  const bool whole = copy_all(content, fd.get()) && ::fchmod(fd.get(), kMode) == 0 && ::fsync(fd.get()) == 0 &&
                     ::rename(temporary.c_str(), path.c_str()) == 0;
  if (!whole) {
    const Error error = write_error();
    ::unlink(temporary.c_str());
    return error;
  }
  sync_folder_of(path);
  return {};
}

}  // namespace slamd
