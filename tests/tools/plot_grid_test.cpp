// Occupancy grids read as map_server writes them, refused with a reason where they are none, and drawn.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tools/plot/grid_picture.hpp"

// fontconfig keeps its cache until the process ends, which the leak sanitizer takes for a leak.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }

namespace slamd::plot {
namespace {

namespace fs = std::filesystem;

class GridFile : public ::testing::Test {
 protected:
  GridFile() { fs::create_directories(folder_); }
  ~GridFile() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream{folder_ / name, std::ios::binary} << bytes;
    return (folder_ / name).string();
  }
  std::string write_grid(const std::string& pgm, const std::string& resolution = "0.5") const {
    write("map.pgm", pgm);
    return write("map.yaml", "image: map.pgm\nmode: trinary\nresolution: " + resolution +
                                 "\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  }
  /// Empty when it is not refused.
  static std::string refusal(const std::string& yaml) {
    try {
      load_grid(yaml);
    } catch (const GridError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_ = fs::path{testing::TempDir()} / ("slamd_grid_" + std::to_string(::getpid()));
};

const std::string kSix = std::string{"\x00\xFE\xCD\xFE\xFE\x00", 6};

TEST_F(GridFile, HasItsCellsPlaceAndScale) {
  const GridImage grid = load_grid(write_grid("P5\n# by somebody\n3 2\n255\n" + kSix));
  EXPECT_EQ(grid.columns, 3U);
  EXPECT_EQ(grid.rows, 2U);
  EXPECT_EQ(grid.grey, (std::vector<std::uint8_t>{0, 254, 205, 254, 254, 0}));
  EXPECT_DOUBLE_EQ(grid.resolution_m, 0.5);
  EXPECT_DOUBLE_EQ(grid.x_m, -1.0);
  EXPECT_DOUBLE_EQ(grid.y_m, 2.0);
}

TEST_F(GridFile, ThatIsNoneIsRefusedWithFileAndReason) {
  EXPECT_NE(refusal((folder_ / "absent.yaml").string()).find("absent.yaml"), std::string::npos);
  EXPECT_NE(refusal(write_grid("P6\n3 2\n255\n" + kSix)).find("map.pgm: no binary PGM"), std::string::npos);
  EXPECT_NE(refusal(write_grid("P5\n3 2\n65535\n" + kSix)).find("one byte a pixel"), std::string::npos);
  EXPECT_NE(refusal(write_grid("P5\n3 2\n255\n" + kSix.substr(1))).find("ends before its last pixel"), std::string::npos);
  EXPECT_NE(refusal(write_grid("P5\n9999999999 9999999999\n255\n")).find("map.pgm"), std::string::npos);
  EXPECT_NE(refusal(write_grid("P5\n3 2\n255\n" + kSix, "0")).find("resolution"), std::string::npos);
  EXPECT_NE(refusal(write("map.yaml", "image: map.pgm\n")).find("map.yaml"), std::string::npos);
  EXPECT_NE(refusal(write("map.yaml", "image: [}")).find("map.yaml"), std::string::npos);
}

TEST_F(GridFile, IsDrawnWithThePathOnIt) {
  GridPicture picture{load_grid(write_grid("P5\n3 2\n255\n" + kSix)), {{{-0.5, 2.2}, {0.2, 2.8}}, {0.0, 0.1}, {0.0, 0.1}}, "a grid", "", "error [m]"};
  picture.width_px = 600;
  const std::string path = (folder_ / "grid.png").string();
  write_grid_picture(picture, path);
  EXPECT_GT(fs::file_size(path), 2'000U);
  EXPECT_THROW(write_grid_picture(picture, "/nonexistent/folder/grid.png"), PlotError);
}

}  // namespace
}  // namespace slamd::plot
