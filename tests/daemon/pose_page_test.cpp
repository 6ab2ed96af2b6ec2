#include "daemon/server/protocol/pose_page.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <thread>
#include <vector>

namespace slamd {
namespace {

PoseSample make_sample(std::uint64_t number) {
  PoseSample sample;
  sample.sequence = number;
  sample.host_time_ns = static_cast<std::int64_t>(number);
  sample.covariance.fill(static_cast<double>(number));
  sample.map_corrections = static_cast<std::uint32_t>(number);
  return sample;
}

bool is_whole(const PoseSample& sample) {
  for (const double element : sample.covariance) {
    if (element != static_cast<double>(sample.sequence)) return false;
  }
  return sample.map_corrections == static_cast<std::uint32_t>(sample.sequence);
}

TEST(PosePage, AReaderSeesWhatTheWriterWroteLast) {
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  ASSERT_TRUE(writer);
  const std::optional<PosePageReader> reader = PosePageReader::map(writer->fd());
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->read());
  writer->write(make_sample(1));
  writer->write(make_sample(2));
  ASSERT_TRUE(reader->read());
  EXPECT_EQ(reader->read()->sequence, 2U);
  EXPECT_EQ(writer->read()->sequence, 2U);
}

TEST(PosePage, WhoeverReceivesItCanNeitherWriteNorResizeIt) {
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  ASSERT_TRUE(writer);
  const char byte = 1;
  EXPECT_LT(::pwrite(writer->fd(), &byte, 1, 0), 0);
  EXPECT_NE(::ftruncate(writer->fd(), 0), 0);
  EXPECT_NE(::ftruncate(writer->keep_fd(), 0), 0) << "nor can its owner";
  struct stat status {};
  ASSERT_EQ(::fstat(writer->fd(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U) << "other users must not open it again for writing";
  EXPECT_EQ(::mmap(nullptr, PosePageLayout::kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, writer->fd(), 0), MAP_FAILED);
  writer->write(make_sample(3));
  EXPECT_EQ(writer->read()->sequence, 3U);
}

TEST(PosePage, TheNextDaemonTakesThePageOverAndMappingsStayGood) {
  std::optional<PosePageWriter> first = PosePageWriter::create();
  ASSERT_TRUE(first);
  const std::optional<PosePageReader> reader = PosePageReader::map(first->fd());
  ASSERT_TRUE(reader);
  first->write(make_sample(7));
  UniqueFd kept{::fcntl(first->keep_fd(), F_DUPFD_CLOEXEC, 0)};
  first.reset();
  EXPECT_EQ(reader->read()->sequence, 7U) << "until then the last pose stays";
  std::optional<PosePageWriter> second = PosePageWriter::adopt(std::move(kept));
  ASSERT_TRUE(second);
  EXPECT_FALSE(reader->read()) << "an old pose is none of the new daemon's";
  EXPECT_FALSE(second->read());
  EXPECT_EQ(reader->starts(), 2U);
  second->write(make_sample(1));
  EXPECT_EQ(reader->read()->sequence, 1U);
}

TEST(PosePage, APageWhoseWriterDiedInTheMiddleOfAWriteIsTakenOverToo) {
  std::optional<PosePageWriter> first = PosePageWriter::create();
  ASSERT_TRUE(first);
  const std::uint64_t odd = 41;  // the sequence while a write is under way
  ASSERT_EQ(::pwrite(first->keep_fd(), &odd, sizeof odd, offsetof(PosePageLayout, sample)), 8);
  EXPECT_FALSE(first->read());
  std::optional<PosePageWriter> second =
      PosePageWriter::adopt(UniqueFd{::fcntl(first->keep_fd(), F_DUPFD_CLOEXEC, 0)});
  ASSERT_TRUE(second);
  second->write(make_sample(1));
  EXPECT_EQ(second->read()->sequence, 1U);
}

TEST(PosePage, WhatIsNoPosePageIsNotTakenOver) {
  EXPECT_FALSE(PosePageWriter::adopt({}));
  UniqueFd blank{::memfd_create("blank", MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  ASSERT_EQ(::ftruncate(blank.get(), PosePageLayout::kBytes), 0);
  ASSERT_EQ(::fcntl(blank.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW), 0);
  EXPECT_FALSE(PosePageWriter::adopt(std::move(blank))) << "no magic";
  std::optional<PosePageWriter> newer = PosePageWriter::create();
  const std::uint32_t version = PosePageLayout::kVersion + 1;
  ASSERT_EQ(::pwrite(newer->keep_fd(), &version, sizeof version, offsetof(PosePageLayout, version)), 4);
  EXPECT_FALSE(PosePageWriter::adopt(UniqueFd{::fcntl(newer->keep_fd(), F_DUPFD_CLOEXEC, 0)})) << "another version";
}

TEST(PosePage, ReadersRefuseWhatIsNoPosePage) {
  EXPECT_FALSE(PosePageReader::map(-1));
  const UniqueFd empty{::memfd_create("empty", MFD_CLOEXEC | MFD_ALLOW_SEALING)};
  EXPECT_FALSE(PosePageReader::map(empty.get()));
  ASSERT_EQ(::ftruncate(empty.get(), PosePageLayout::kBytes), 0);
  EXPECT_FALSE(PosePageReader::map(empty.get())) << "may still shrink";
  ASSERT_EQ(::fcntl(empty.get(), F_ADD_SEALS, F_SEAL_SHRINK), 0);
  EXPECT_FALSE(PosePageReader::map(empty.get())) << "no magic";
}

TEST(PosePage, ConcurrentReadersNeverSeeATornSample) {
  constexpr std::uint64_t kWrites = 50'000;
  std::optional<PosePageWriter> writer = PosePageWriter::create();
  ASSERT_TRUE(writer);
  std::array<bool, 3> good{};
  std::vector<std::thread> readers;
  for (bool& verdict : good) {
    readers.emplace_back([&writer, &verdict] {
      const std::optional<PosePageReader> reader = PosePageReader::map(writer->fd());
      std::uint64_t previous = 0;
      bool ok = reader.has_value();
      while (ok && previous < kWrites) {
        const std::optional<PoseSample> sample = reader->read();
        if (!sample) continue;
        ok = is_whole(*sample) && sample->sequence >= previous;
        previous = sample->sequence;
      }
      verdict = ok;
    });
  }
  for (std::uint64_t i = 1; i <= kWrites; ++i) writer->write(make_sample(i));
  for (std::thread& reader : readers) reader.join();
  for (const bool verdict : good) EXPECT_TRUE(verdict);
}

}  // namespace
}  // namespace slamd
