#pragma once
// The pose page: one page of shared memory with the newest pose, written by the daemon and mapped read-only by its
// clients. This layout is a contract between processes; it has no history and no wake-up (subscribe on the socket).

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "daemon/ring/seqlock.hpp"
#include "daemon/ring/unique_fd.hpp"

namespace slamd {

inline constexpr std::int64_t kUtcOffsetUnknown = std::numeric_limits<std::int64_t>::min();

/// All that the daemon says of one instant. SI units; quaternions are x, y, z, w; frames as in docs/protocol.md.
struct PoseSample {
  std::int64_t host_time_ns = 0;                      // CLOCK_MONOTONIC of the instant described
  std::int64_t utc_offset_ns = kUtcOffsetUnknown;     // UTC since 1970 = host_time_ns + utc_offset_ns
  std::uint64_t sequence = 0;                         // counts published samples from 1, without gaps
  std::array<double, 3> map_position_m{};             // of base in map; may jump when the map is corrected
  std::array<double, 4> map_rotation_xyzw{0, 0, 0, 1};
  std::array<double, 3> odom_position_m{};            // of base in odom; never jumps
  std::array<double, 4> odom_rotation_xyzw{0, 0, 0, 1};
  std::array<double, 3> velocity_mps{};               // of base, in odom
  std::array<double, 3> angular_velocity_rads{};      // of base, in base
  /// Of the odom pose, row-major 6x6: rows 0-2 position in odom (m), rows 3-5 attitude, right perturbation (rad).
  std::array<double, 36> covariance{};
  std::array<double, 3> degenerate_direction{};       // unit, odom; zero when all directions are constrained
  std::uint32_t status = 0;                           // 0 initialising, 1 tracking, 2 degraded, 3 lost
  std::uint32_t reasons = 0;                          // bits of StatusReason
  float lidar_test_ratio = 0.0F;                      // > 1: the newest scan was rejected
  std::uint32_t map_corrections = 0;                  // counts changes of map relative to odom
};
inline constexpr std::size_t kPoseSampleWords = sizeof(PoseSample) / sizeof(std::uint64_t);
static_assert(std::is_trivially_copyable_v<PoseSample> && sizeof(PoseSample) == 64 * sizeof(std::uint64_t));

/// The bytes of the page. A change of layout is a new version; readers refuse versions that they do not know.
struct PosePageLayout {
  static constexpr std::uint64_t kMagic = 0x45474150'45534F50;  // "POSEPAGE", little-endian
  static constexpr std::uint32_t kVersion = 1;
  static constexpr std::size_t kBytes = 4096;

  std::uint64_t magic;
  std::uint32_t version;
  std::uint32_t sample_bytes;
  std::atomic<std::uint32_t> starts;  // of daemons on this page: after a change odom, map and sample.sequence begin anew
  std::array<std::uint8_t, 44> reserved;
  Seqlock<kPoseSampleWords> sample;  // at byte 64: u64 sequence (odd while being written), then the words of PoseSample
};
static_assert(std::endian::native == std::endian::little && offsetof(PosePageLayout, sample) == 64);
static_assert(std::is_standard_layout_v<PosePageLayout> && sizeof(PosePageLayout) <= PosePageLayout::kBytes);

/// The daemon's side: owns the memfd and the only writable mapping. write() from one thread; the rest from any.
class PosePageWriter {
 public:
  /// Makes the page; nullopt with errno set when the kernel gives no memfd. The memfd's size is sealed, and its mode lets
  /// only the daemon's own user open it again for writing: whoever receives fd() can only map it read-only.
  static std::optional<PosePageWriter> create();

  /// Takes over the page of a daemon that has ended, so that its clients' mappings stay good. They read nothing until the
  /// first write(). memfd is what keep_fd() gave; nullopt when it is no page of this version.
  static std::optional<PosePageWriter> adopt(UniqueFd memfd);

  PosePageWriter(PosePageWriter&& other) noexcept;
  PosePageWriter& operator=(PosePageWriter&&) = delete;
  ~PosePageWriter();

  /// Writes the sample. Wait-free, no allocation, no system call.
  void write(const PoseSample& sample);

  /// The newest sample; nullopt before the first write().
  std::optional<PoseSample> read() const;

  int fd() const { return read_only_.get(); }    // for clients
  int keep_fd() const { return memfd_.get(); }   // for adopt() of the next daemon; not for clients

 private:
  static std::optional<PosePageWriter> open(UniqueFd memfd);
  PosePageWriter(UniqueFd memfd, UniqueFd read_only, PosePageLayout* page)
      : memfd_{std::move(memfd)}, read_only_{std::move(read_only)}, page_{page} {}

  UniqueFd memfd_;
  UniqueFd read_only_;
  PosePageLayout* page_;
};

/// A client's side: a read-only mapping of the page behind a descriptor that the daemon handed over.
class PosePageReader {
 public:
  /// Maps the page; nullopt when fd is no pose page of this version. The descriptor may be closed afterwards.
  static std::optional<PosePageReader> map(int fd);

  PosePageReader(PosePageReader&& other) noexcept;
  PosePageReader& operator=(PosePageReader&&) = delete;
  ~PosePageReader();

  /// The newest sample; nullopt before the daemon's first one, or when it died in the middle of a write. Any thread,
  /// no system call, below 100 ns (tests/bench/bench_pose_page.cpp). A page that no longer changes is a daemon that
  /// has gone: compare host_time_ns with CLOCK_MONOTONIC.
  std::optional<PoseSample> read() const;

  /// How many daemons have written this page. After a change odom and map begin anew, and sequence counts from 1.
  std::uint32_t starts() const { return page_->starts.load(std::memory_order_acquire); }

 private:
  explicit PosePageReader(const PosePageLayout* page) : page_{page} {}

  const PosePageLayout* page_;
};

}  // namespace slamd
