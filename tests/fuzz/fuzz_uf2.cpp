// UF2 files: any bytes, and right files with bytes changed. Properties: an image that is taken has pages within the
// flash, aligned, each address once, and as many as the file has blocks at most; a right file gives back its content;
// cut short anywhere it is refused.

#include <cstdlib>

#include "tests/tools/uf2_bytes.hpp"
#include "tools/imu-flash/uf2.hpp"

namespace {

using namespace slamd::flash;

void require(bool property) {
  if (!property) std::abort();
}

void check_taken(std::span<const std::uint8_t> file) {
  const LoadedImage loaded = parse_uf2(file);
  if (!loaded) return;
  const auto& pages = loaded.image.pages;
  require(!pages.empty() && pages.size() <= file.size() / kUf2BlockBytes);
  for (std::size_t i = 0; i < pages.size(); ++i) {
    require(pages[i].address >= kFlashBegin && pages[i].address - kFlashBegin <= kFlashBytes - kPageBytes);
    require(pages[i].address % kPageBytes == 0);
    require(i == 0 || pages[i - 1].address < pages[i].address);
  }
  std::size_t bytes = 0;
  for (const Run& run : loaded.image.runs()) {
    require(run.address / kSectorBytes == (run.address + run.bytes.size() - 1) / kSectorBytes);
    bytes += run.bytes.size();
  }
  require(bytes == pages.size() * kPageBytes);
}

void check_round_trip(std::span<const std::uint8_t> content) {
  const std::vector<std::uint8_t> file = test::uf2_of(content);
  const LoadedImage loaded = parse_uf2(file);
  require(static_cast<bool>(loaded));
  for (std::size_t i = 0; i < content.size(); ++i) require(loaded.image.pages[i / 256].bytes[i % 256] == content[i]);
  const std::size_t cut = 1 + content[0] * file.size() / 256;
  require(cut >= file.size() || !parse_uf2(std::span{file}.first(cut)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  const std::span<const std::uint8_t> bytes{input, size};
  check_taken(bytes);
  if (size == 0) return 0;
  check_round_trip(bytes);
  std::vector<std::uint8_t> damaged = test::uf2_of(std::vector<std::uint8_t>(2048, input[0]));
  for (std::size_t i = 0; i + 2 < size; i += 3) {
    const std::size_t block = input[i] % 8;
    const std::size_t at = input[i + 1] % 36;  // the head's bytes, and the last word
    damaged[block * 512 + (at < 32 ? at : 508 + at - 32)] = input[i + 2];
  }
  check_taken(damaged);
  return 0;
}
