#include "daemon/store/cloud_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

namespace slamd {
namespace {

namespace fs = std::filesystem;

class CloudFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "slamd_cloud_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator{folder_}, fs::directory_iterator{}));
  }
  fs::path folder_;
};

std::string content_of(int fd) {
  struct stat status {};
  ::fstat(fd, &status);
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  EXPECT_EQ(::pread(fd, text.data(), text.size(), 0), status.st_size);
  return text;
}

std::string content_of(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

TEST_F(CloudFile, PcdHoldsTheFieldsAndTheNumberOfPoints) {
  const PointCloud cloud{{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}};
  const Result<UniqueFd> fd = cloud_memfd(cloud, CloudFormat::kPcd);
  ASSERT_TRUE(fd) << fd.reason();
  const std::string text = content_of(fd->get());
  EXPECT_NE(text.find("FIELDS x y z intensity"), std::string::npos);
  EXPECT_NE(text.find("POINTS 3"), std::string::npos);
  EXPECT_NE(text.find("DATA binary_compressed"), std::string::npos);
}

TEST_F(CloudFile, PlyHoldsTheFloatsAsTheyAre) {
  const PointCloud cloud{{1, 2, 3, 4}, {5, 6, 7, 8}};
  const Result<UniqueFd> fd = cloud_memfd(cloud, CloudFormat::kPly);
  ASSERT_TRUE(fd) << fd.reason();
  const std::string text = content_of(fd->get());
  EXPECT_NE(text.find("element vertex 2"), std::string::npos);
  const std::string point(reinterpret_cast<const char*>(&cloud[1]), sizeof(CloudPoint));
  EXPECT_NE(text.find(point), std::string::npos);
}

TEST_F(CloudFile, AnEmptyMapIsAnEmptyPcdAndNoPly) {
  const Result<UniqueFd> pcd = cloud_memfd({}, CloudFormat::kPcd);
  ASSERT_TRUE(pcd);
  EXPECT_NE(content_of(pcd->get()).find("POINTS 0"), std::string::npos);
  EXPECT_FALSE(cloud_memfd({}, CloudFormat::kPly));
}

TEST_F(CloudFile, NobodyCanChangeTheMemfdAnyMore) {
  const Result<UniqueFd> fd = text_memfd("abc");
  ASSERT_TRUE(fd);
  EXPECT_LT(::pwrite(fd->get(), "x", 1, 0), 0);
  EXPECT_NE(::ftruncate(fd->get(), 0), 0);
}

TEST_F(CloudFile, SavesTheWholeContentAndNothingBesideIt) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i);
  const Result<UniqueFd> fd = text_memfd(text);
  ASSERT_TRUE(fd);
  ASSERT_TRUE(save_atomically(fd->get(), folder_ / "map.pcd"));
  ASSERT_TRUE(save_atomically(fd->get(), folder_ / "map.pcd")) << "over the old one";
  EXPECT_EQ(content_of(folder_ / "map.pcd"), text);
  EXPECT_EQ(files(), 1U);
}

TEST_F(CloudFile, AFileThatDoesNotFitLeavesTheOldOneAndSaysWhy) {
  const Result<UniqueFd> small = text_memfd("old");
  const Result<UniqueFd> large = text_memfd(std::string(1'000'000, 'x'));
  ASSERT_TRUE(small && large);
  ASSERT_TRUE(save_atomically(small->get(), folder_ / "map.pcd"));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{.rlim_cur = 100'000, .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const Result<void> saved = save_atomically(large->get(), folder_ / "map.pcd");
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(saved);
  EXPECT_STREQ(saved.reason(), "the file is larger than the system allows");
  EXPECT_EQ(content_of(folder_ / "map.pcd"), "old");
  EXPECT_EQ(files(), 1U);
}

TEST_F(CloudFile, AMissingFolderIsAClearError) {
  const Result<UniqueFd> fd = text_memfd("abc");
  const Result<void> saved = save_atomically(fd->get(), folder_ / "none" / "map.pcd");
  ASSERT_FALSE(saved);
  EXPECT_STREQ(saved.reason(), "the folder does not exist");
}

}  // namespace
}  // namespace slamd
