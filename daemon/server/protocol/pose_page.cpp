#include "daemon/server/protocol/pose_page.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cstring>
#include <new>
#include <utility>

#ifndef F_SEAL_FUTURE_WRITE
#define F_SEAL_FUTURE_WRITE 0x0010  // Linux 5.1; not yet in Debian 12's libc headers
#endif

namespace slamd {
namespace {

using Words = Seqlock<kPoseSampleWords>::Words;

std::optional<PoseSample> read_sample(const PosePageLayout& page) {
  Words words;
  if (!page.sample.load(words)) return std::nullopt;
  return std::bit_cast<PoseSample>(words);
}

}  // namespace

std::optional<PosePageWriter> PosePageWriter::create() {
  UniqueFd fd{::memfd_create("slamd-pose", MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  if (!fd || ::ftruncate(fd.get(), PosePageLayout::kBytes) != 0) return std::nullopt;
  void* memory = ::mmap(nullptr, PosePageLayout::kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd.get(), 0);
  if (memory == MAP_FAILED) return std::nullopt;
  auto* page = new (memory) PosePageLayout{};
  page->magic = PosePageLayout::kMagic;
  page->version = PosePageLayout::kVersion;
  page->sample_bytes = sizeof(PoseSample);
  PosePageWriter writer{std::move(fd), page};
  const int seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;
  if (::fcntl(writer.fd(), F_ADD_SEALS, seals) != 0) return std::nullopt;
  return writer;
}

PosePageWriter::PosePageWriter(PosePageWriter&& other) noexcept
    : fd_{std::move(other.fd_)}, page_{std::exchange(other.page_, nullptr)} {}

PosePageWriter::~PosePageWriter() {
  if (page_ != nullptr) ::munmap(page_, PosePageLayout::kBytes);
}

void PosePageWriter::write(const PoseSample& sample) { page_->sample.store(std::bit_cast<Words>(sample)); }

std::optional<PoseSample> PosePageWriter::read() const { return read_sample(*page_); }

std::optional<PosePageReader> PosePageReader::map(int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0 || status.st_size < static_cast<off_t>(PosePageLayout::kBytes)) return std::nullopt;
  const int seals = ::fcntl(fd, F_GET_SEALS);  // a page that may shrink could kill its reader with SIGBUS
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0) return std::nullopt;
  void* memory = ::mmap(nullptr, PosePageLayout::kBytes, PROT_READ, MAP_SHARED, fd, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  PosePageReader reader{static_cast<const PosePageLayout*>(memory)};
  const PosePageLayout& page = *reader.page_;
  const bool known = page.magic == PosePageLayout::kMagic && page.version == PosePageLayout::kVersion &&
                     page.sample_bytes == sizeof(PoseSample);
  if (!known) return std::nullopt;
  return reader;
}

PosePageReader::PosePageReader(PosePageReader&& other) noexcept : page_{std::exchange(other.page_, nullptr)} {}

PosePageReader::~PosePageReader() {
  if (page_ != nullptr) ::munmap(const_cast<PosePageLayout*>(page_), PosePageLayout::kBytes);
}

std::optional<PoseSample> PosePageReader::read() const { return read_sample(*page_); }

}  // namespace slamd
