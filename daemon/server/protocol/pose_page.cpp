#include "daemon/server/protocol/pose_page.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cstring>
#include <new>
#include <string>
#include <utility>

namespace slamd {
namespace {

using Words = Seqlock<kPoseSampleWords>::Words;

std::optional<PoseSample> read_sample(const PosePageLayout& page) {
  Words words;
  if (!page.sample.load(words)) return std::nullopt;
  return std::bit_cast<PoseSample>(words);
}

constexpr int kSizeSeals = F_SEAL_SHRINK | F_SEAL_GROW;

/// Is there a page behind the descriptor that keeps its size? One that may shrink could kill its reader with SIGBUS.
bool is_sized(int fd, int seals) {
  struct stat status {};
  if (::fstat(fd, &status) != 0 || status.st_size < static_cast<off_t>(PosePageLayout::kBytes)) return false;
  const int sealed = ::fcntl(fd, F_GET_SEALS);
  return sealed >= 0 && (sealed & seals) == seals;
}

bool is_known(const PosePageLayout& page) {
  return page.magic == PosePageLayout::kMagic && page.version == PosePageLayout::kVersion &&
         page.sample_bytes == sizeof(PoseSample);
}

}  // namespace

std::optional<PosePageWriter> PosePageWriter::open(UniqueFd memfd) {
  const std::string path = "/proc/self/fd/" + std::to_string(memfd.get());
  UniqueFd read_only{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (!read_only) return std::nullopt;
  void* memory = ::mmap(nullptr, PosePageLayout::kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, memfd.get(), 0);
  if (memory == MAP_FAILED) return std::nullopt;
  return PosePageWriter{std::move(memfd), std::move(read_only), static_cast<PosePageLayout*>(memory)};
}

std::optional<PosePageWriter> PosePageWriter::create() {
  UniqueFd memfd{::memfd_create("slamd-pose", MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  if (!memfd || ::ftruncate(memfd.get(), PosePageLayout::kBytes) != 0) return std::nullopt;
  const bool closed = ::fchmod(memfd.get(), S_IRUSR | S_IWUSR) == 0 &&
                      ::fcntl(memfd.get(), F_ADD_SEALS, kSizeSeals | F_SEAL_SEAL) == 0;
  if (!closed) return std::nullopt;
  std::optional<PosePageWriter> writer = open(std::move(memfd));
  if (!writer) return std::nullopt;
  auto* page = new (writer->page_) PosePageLayout{};
  page->magic = PosePageLayout::kMagic;
  page->version = PosePageLayout::kVersion;
  page->sample_bytes = sizeof(PoseSample);
  page->starts = 1;
  return writer;
}

std::optional<PosePageWriter> PosePageWriter::adopt(UniqueFd memfd) {
  if (!is_sized(memfd.get(), kSizeSeals)) return std::nullopt;
  std::optional<PosePageWriter> writer = open(std::move(memfd));
  if (!writer || !is_known(*writer->page_)) return std::nullopt;
  writer->page_->sample.clear();
  ++writer->page_->starts;
  return writer;
}

PosePageWriter::PosePageWriter(PosePageWriter&& other) noexcept
    : memfd_{std::move(other.memfd_)},
      read_only_{std::move(other.read_only_)},
      page_{std::exchange(other.page_, nullptr)} {}

PosePageWriter::~PosePageWriter() {
  if (page_ != nullptr) ::munmap(page_, PosePageLayout::kBytes);
}

void PosePageWriter::write(const PoseSample& sample) { page_->sample.store(std::bit_cast<Words>(sample)); }

std::optional<PoseSample> PosePageWriter::read() const { return read_sample(*page_); }

std::optional<PosePageReader> PosePageReader::map(int fd) {
  if (!is_sized(fd, F_SEAL_SHRINK)) return std::nullopt;
  void* memory = ::mmap(nullptr, PosePageLayout::kBytes, PROT_READ, MAP_SHARED, fd, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  PosePageReader reader{static_cast<const PosePageLayout*>(memory)};
  if (!is_known(*reader.page_)) return std::nullopt;
  return reader;
}

PosePageReader::PosePageReader(PosePageReader&& other) noexcept : page_{std::exchange(other.page_, nullptr)} {}

PosePageReader::~PosePageReader() {
  if (page_ != nullptr) ::munmap(const_cast<PosePageLayout*>(page_), PosePageLayout::kBytes);
}

std::optional<PoseSample> PosePageReader::read() const { return read_sample(*page_); }

}  // namespace slamd
