#include "daemon/store/cloud_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <liblzf/lzf.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

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
  const Result<UniqueFd> fd = cloud_memfd(source_of(cloud));
  ASSERT_TRUE(fd) << fd.reason();
  const std::string text = content_of(fd->get());
  EXPECT_NE(text.find("FIELDS x y z intensity"), std::string::npos);
  EXPECT_NE(text.find("POINTS 3"), std::string::npos);
  EXPECT_NE(text.find("DATA binary_compressed"), std::string::npos);
}

TEST_F(CloudFile, PlyHoldsTheFloatsAsTheyAre) {
  const PointCloud cloud{{1, 2, 3, 4}, {5, 6, 7, 8}};
  const Result<UniqueFd> fd = cloud_memfd(source_of(cloud), {.format = CloudFormat::kPly, .reference = {}, .progress = {}});
  ASSERT_TRUE(fd) << fd.reason();
  const std::string text = content_of(fd->get());
  EXPECT_NE(text.find("element vertex 2"), std::string::npos);
  const std::string point(reinterpret_cast<const char*>(&cloud[1]), sizeof(CloudPoint));
  EXPECT_NE(text.find(point), std::string::npos);
}

TEST_F(CloudFile, AnEmptyMapIsAFileWithoutPoints) {
  const PointCloud empty;
  const Result<UniqueFd> pcd = cloud_memfd(source_of(empty));
  ASSERT_TRUE(pcd);
  EXPECT_NE(content_of(pcd->get()).find("POINTS 0"), std::string::npos);
  const Result<UniqueFd> ply = cloud_memfd(source_of(empty), {.format = CloudFormat::kPly, .reference = {}, .progress = {}});
  ASSERT_TRUE(ply);
  EXPECT_NE(content_of(ply->get()).find("element vertex 0"), std::string::npos);
}

/// The plain bytes of a binary_compressed PCD, by the library that PCL's own decoder was copied from.
std::vector<float> floats_of(const std::string& pcd) {
  const std::string mark = "DATA binary_compressed\n";
  const std::size_t begin = pcd.find(mark) + mark.size();
  std::array<std::uint32_t, 2> sizes{};
  std::memcpy(sizes.data(), pcd.data() + begin, sizeof sizes);
  EXPECT_EQ(begin + sizeof sizes + sizes[0], pcd.size());
  std::vector<float> floats(sizes[1] / sizeof(float));
  EXPECT_EQ(lzf_decompress(pcd.data() + begin + sizeof sizes, sizes[0], floats.data(), sizes[1]), sizes[1]);
  return floats;
}

TEST_F(CloudFile, PcdOfManyPiecesIsOneStreamFieldAfterField) {
  PointCloud cloud(200'001);
  std::mt19937 random{3};
  std::uniform_real_distribution<float> coordinate{-100.0F, 100.0F};
  for (CloudPoint& point : cloud) point = {coordinate(random), coordinate(random), 1.5F, coordinate(random)};
  const Result<UniqueFd> fd = cloud_memfd(source_of(cloud));
  ASSERT_TRUE(fd) << fd.reason();
  const std::vector<float> floats = floats_of(content_of(fd->get()));
  ASSERT_EQ(floats.size(), 4 * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); i += 77) {
    ASSERT_EQ(floats[i], cloud[i].x) << i;
    ASSERT_EQ(floats[cloud.size() + i], cloud[i].y) << i;
    ASSERT_EQ(floats[3 * cloud.size() + i], cloud[i].intensity) << i;
  }
}

TEST_F(CloudFile, TheHeaderTellsWhereTheMapLiesOnTheEarth) {
  GeoReference reference{.latitude_deg = 48.1234567, .longitude_deg = -11.5, .ellipsoid_height_m = 560.25, .T_enu_map = {}};
  const PointCloud cloud{{1, 2, 3, 4}};
  reference.T_enu_map.translation = {1.5, 2.5, -3.5};
  for (const CloudFormat format : {CloudFormat::kPcd, CloudFormat::kPly}) {
    const Result<UniqueFd> fd =
        cloud_memfd(source_of(cloud), {.format = format, .reference = reference, .progress = {}});
    ASSERT_TRUE(fd);
    const std::string text = content_of(fd->get());
    EXPECT_NE(text.find(" enu_origin_lat_lon_height 48.123456700 -11.500000000 560.2500\n"), std::string::npos);
    EXPECT_NE(text.find(" T_enu_map_xyz_quat_xyzw 1.500000 2.500000 -3.500000 0.0"), std::string::npos);
  }
  EXPECT_NE(to_yaml(reference).find("origin_lat_deg: 48.123456700\n"), std::string::npos);
}

TEST_F(CloudFile, AWriteThatIsToldToStopLeavesNothing) {
  const PointCloud cloud(1'000'000);
  int asked = 0;
  const WriteProgress stop_soon = [&asked](double) { return ++asked < 3; };
  EXPECT_FALSE(cloud_memfd(source_of(cloud), {.format = CloudFormat::kPcd, .reference = {}, .progress = stop_soon}));
  EXPECT_EQ(asked, 3);
  const Result<UniqueFd> large = text_memfd(std::string(5'000'000, 'x'));
  asked = 0;
  EXPECT_FALSE(save_atomically(large->get(), folder_ / "map.pcd", stop_soon));
  EXPECT_EQ(files(), 0U);
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
