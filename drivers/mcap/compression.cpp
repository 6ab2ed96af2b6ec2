#include "drivers/mcap/compression.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

namespace slamd {
namespace {

constexpr std::size_t kStep = 256U * 1024;

/// Calls step(to) until it says that it has ended: it puts bytes there and returns how many, or nothing on damage or want of input.
template <class Step>
Decompressed collect(std::size_t most_bytes, Step&& step) {
  Decompressed out;
  for (bool ended = false; !ended && out.bytes.size() <= most_bytes;) {
    const std::size_t had = out.bytes.size();
    out.bytes.resize(had + std::min(kStep, most_bytes + 1 - had));
    const std::optional<std::size_t> made = step(std::span{out.bytes}.subspan(had), ended);
    out.bytes.resize(had + made.value_or(0));
    out.whole = ended;
    if (!made || (*made == 0 && !ended)) return out;
  }
  if (out.bytes.size() > most_bytes) out = {{out.bytes.begin(), out.bytes.begin() + static_cast<std::ptrdiff_t>(most_bytes)}, false};
  return out;
}

Decompressed from_zstd(std::span<const std::uint8_t> bytes, std::size_t most_bytes) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  return collect(most_bytes, [&](std::span<std::uint8_t> to, bool& ended) -> std::optional<std::size_t> {
    ZSTD_outBuffer out{to.data(), to.size(), 0};
    const std::size_t left = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(left) != 0U) return out.pos == 0 ? std::nullopt : std::optional{out.pos};
    ended = left == 0 && in.pos == in.size;
    return out.pos;
  });
}

Decompressed from_lz4(std::span<const std::uint8_t> bytes, std::size_t most_bytes) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0U) return {};
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context{raw, &LZ4F_freeDecompressionContext};
  std::size_t at = 0;
  return collect(most_bytes, [&](std::span<std::uint8_t> to, bool& ended) -> std::optional<std::size_t> {
    std::size_t made = 0;
    while (made < to.size() && at < bytes.size() && !ended) {
      std::size_t room = to.size() - made;
      std::size_t used = bytes.size() - at;
      const std::size_t left = LZ4F_decompress(context.get(), to.data() + made, &room, bytes.data() + at, &used, nullptr);
      if (LZ4F_isError(left) != 0U) return made == 0 ? std::nullopt : std::optional{made};
      made += room;
      at += used;
      ended = left == 0 && at == bytes.size();
      if (room == 0 && used == 0) break;
    }
    return made;
  });
}

Decompressed from_bzip2(std::span<const std::uint8_t> bytes, std::size_t most_bytes) {
  bz_stream stream{};
  if (bytes.size() > std::numeric_limits<unsigned>::max() || BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {};
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> closer{&stream, &BZ2_bzDecompressEnd};
  Bytes input{bytes.begin(), bytes.end()};  // the library wants it writable
  stream.next_in = reinterpret_cast<char*>(input.data());
  stream.avail_in = static_cast<unsigned>(input.size());
  return collect(most_bytes, [&](std::span<std::uint8_t> to, bool& ended) -> std::optional<std::size_t> {
    stream.next_out = reinterpret_cast<char*>(to.data());
    stream.avail_out = static_cast<unsigned>(to.size());
    const int answer = BZ2_bzDecompress(&stream);
    const std::size_t made = to.size() - stream.avail_out;
    ended = answer == BZ_STREAM_END;
    if (answer != BZ_OK && !ended) return made == 0 ? std::nullopt : std::optional{made};
    return made;
  });
}

}  // namespace

std::optional<Compression> compression_of(std::string_view name) {
  if (name.empty() || name == "none") return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  if (name == "bz2") return Compression::kBzip2;
  return std::nullopt;
}

Decompressed decompress(Compression compression, std::span<const std::uint8_t> bytes, std::size_t most_bytes) {
  switch (compression) {
    case Compression::kZstd: return from_zstd(bytes, most_bytes);
    case Compression::kLz4: return from_lz4(bytes, most_bytes);
    case Compression::kBzip2: return from_bzip2(bytes, most_bytes);
    case Compression::kNone: break;
  }
  const auto taken = bytes.first(std::min(bytes.size(), most_bytes));
  return {{taken.begin(), taken.end()}, taken.size() == bytes.size()};
}

Bytes compress_zstd(std::span<const std::uint8_t> bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  const std::size_t made = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1);
  out.resize(ZSTD_isError(made) != 0U ? 0 : made);
  return out;
}

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

}  // namespace slamd
