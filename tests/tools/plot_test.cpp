// Pictures: scales and colours as numbers, and that what should be visible is in the pixels.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "tools/plot/lzf.hpp"
#include "tools/plot/map_picture.hpp"
#include "tools/plot/pcd_file.hpp"

// fontconfig keeps its cache until the process ends, which the leak sanitizer takes for a leak.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }

namespace slamd::plot {
namespace {

namespace fs = std::filesystem;

fs::path temp(const std::string& name) { return fs::path(testing::TempDir()) / ("slamd_plot_" + name); }

TEST(Ticks, are_round_and_inside_the_range) {
  const Ticks ticks = round_ticks({0.3, 9.7}, 5);
  EXPECT_DOUBLE_EQ(ticks.step, 2.0);
  EXPECT_EQ(ticks.values, (std::vector<double>{2, 4, 6, 8}));
  EXPECT_EQ(tick_label(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(tick_label(-1e-17, 0.1), "0.0");
  EXPECT_EQ(tick_label(1500, 500), "1500");
}

TEST(Ranges, ignore_what_is_no_number_and_never_have_zero_span) {
  Range range = empty_range();
  range.include(NAN);
  EXPECT_GT(padded(range, 0.1).span(), 0.0);
  range.include(5.0);
  range.include(INFINITY);
  EXPECT_EQ(range.high, 5.0);
  EXPECT_GT(padded(range, 0.0).span(), 0.0);
}

TEST(Gradients, are_clamped_at_both_ends) {
  const Gradient gradient({rgb(0x000000), rgb(0xFF0000), rgb(0xFFFFFF)});
  EXPECT_DOUBLE_EQ(gradient.at(-3.0).red, 0.0);
  EXPECT_DOUBLE_EQ(gradient.at(0.25).red, 0.5);
  EXPECT_DOUBLE_EQ(gradient.at(0.75).green, 0.5);
  EXPECT_DOUBLE_EQ(gradient.at(7.0).blue, 1.0);
  EXPECT_DOUBLE_EQ(gradient.at(NAN).red, 0.0);
}

TEST(EqualFrame, has_one_scale_and_keeps_the_middle) {
  const Frame frame = equal_frame({0, 0, 200, 100}, {0, 10}, {0, 10});
  EXPECT_NEAR(frame.px_per_unit(), 10.0, 1e-9);
  EXPECT_NEAR(frame.at(5, 5).x, 100.0, 1e-9);
  EXPECT_NEAR(frame.at(5, 5).y, 50.0, 1e-9);
  EXPECT_NEAR(frame.at(6, 5).x - frame.at(5, 5).x, frame.at(5, 5).y - frame.at(5, 6).y, 1e-9);
}

// A sloping ground of 60 m with a wall of 5 m on it.
PointCloud sloping_ground_with_wall() {
  PointCloud points;
  for (float x = 0.0F; x < 60.0F; x += 0.25F) {
    for (float y = 0.0F; y < 60.0F; y += 0.25F) points.push_back({x, y, 0.1F * x, 50.0F});
  }
  for (float y = 20.0F; y < 40.0F; y += 0.25F) {
    for (float z = 0.0F; z < 5.0F; z += 0.25F) points.push_back({30.0F, y, 3.0F + z, 200.0F});
  }
  return points;
}

TEST(MapValues, are_heights_above_the_ground_around_not_above_zero) {
  const PointCloud points = sloping_ground_with_wall();
  const std::vector<float> values = map_values(points, MapColour::kHeight);
  const std::size_t ground = 240 * 240;
  EXPECT_LT(*std::max_element(values.begin(), values.begin() + ground), 1.3F);
  EXPECT_GT(*std::max_element(values.begin() + ground, values.end()), 4.5F);
  EXPECT_EQ(map_values(points, MapColour::kIntensity).back(), 200.0F);
}

TEST(Raster, has_colour_where_points_are_and_none_elsewhere) {
  const Frame frame{{0, 0, 100, 100}, {0, 100}, {0, 100}};
  const auto pixels = rasterise({{20.5F, 80.5F, 0, 0}}, {1.0F}, frame, {.range = {0, 1}});
  EXPECT_GT(pixels[19 * 100 + 20] >> 24, 100U);
  EXPECT_EQ(pixels[80 * 100 + 20], 0U);
}

TEST(PcdFile, ascii_with_extra_fields_and_points_that_are_no_numbers) {
  const fs::path path = temp("ascii.pcd");
  std::ofstream(path) << "# .PCD v0.7\nVERSION 0.7\nFIELDS intensity x y z ring\nSIZE 4 4 4 4 1\nTYPE F F F F U\n"
                         "COUNT 1 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n"
                         "9 1 2 3 4\n9 nan 2 3 4\n8 4 5 6 4\n";
  const PointCloud points = read_pcd(path);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].x, 4.0F);
  EXPECT_EQ(points[1].intensity, 8.0F);
  fs::remove(path);
}

TEST(PcdFile, that_cannot_be_used_is_refused_with_its_path) {
  const auto refused = [](const fs::path& path) {
    try {
      read_pcd(path);
    } catch (const PlotError& error) {
      return std::string(error.what()).starts_with(path.string());
    }
    return false;
  };
  EXPECT_TRUE(refused(temp("absent.pcd")));
  std::ofstream(temp("text.pcd")) << "this is no cloud\n";
  EXPECT_TRUE(refused(temp("text.pcd")));
  std::ofstream(temp("short.pcd")) << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1000\n"
                                      "HEIGHT 1\nPOINTS 1000\nDATA binary\nxyz";
  EXPECT_TRUE(refused(temp("short.pcd")));
  fs::remove(temp("text.pcd"));
  fs::remove(temp("short.pcd"));
}

TEST(PcdFile, binary_of_another_decoder) {
  const fs::path folder = fs::path(SLAMD_SHARED_DATA) / "vlp16/nebula";
  const fs::path path = folder / "1673400472138016708.pcd";
  if (!fs::exists(path)) GTEST_SKIP() << "shared data is absent: " << path;
  EXPECT_EQ(read_pcd(path).size(), 14831U);
}

// Three points of x y z (float) and intensity (uint8), field after field, packed by hand: literals and one overlapping copy.
TEST(PcdFile, binary_compressed) {
  std::string plain(3 * 13, '\0');
  const float x = 2.5F;
  for (std::size_t i = 0; i < 3; ++i) std::memcpy(plain.data() + 4 * i, &x, 4);
  plain[36] = 7;
  std::string packed = std::string("\x03", 1) + plain.substr(0, 4);        // 4 literals
  packed += std::string("\xC0\x03", 2);                                   // copy 8 from 4 back: the other two x
  packed += std::string("\x00\x00", 2) + std::string("\xE0\x0E\x00", 3);  // one zero, then 23 copies of it
  packed += std::string("\x02\x07\x00\x00", 4);                          // 3 literals
  const fs::path path = temp("packed.pcd");
  const auto write = [&](const std::string& body) {
    const std::array<std::uint32_t, 2> sizes{static_cast<std::uint32_t>(body.size()), 39};
    std::ofstream out(path, std::ios::binary);
    out << "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\n"
           "POINTS 3\nDATA binary_compressed\n";
    out.write(reinterpret_cast<const char*>(sizes.data()), 8);
    out << body;
  };
  write(packed);
  const PointCloud points = read_pcd(path);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[2].x, 2.5F);
  EXPECT_EQ(points[2].z, 0.0F);
  EXPECT_EQ(points[0].intensity, 7.0F);
  for (std::size_t cut = 1; cut < packed.size(); ++cut) {
    write(packed.substr(0, packed.size() - cut));
    EXPECT_THROW(read_pcd(path), PlotError) << cut;
  }
  fs::remove(path);
}

TEST(Lzf, refuses_copies_from_before_the_start_and_more_than_was_announced) {
  EXPECT_FALSE(lzf_decompress(std::string_view("\x00" "a" "\x20\x05", 4), 4));
  EXPECT_FALSE(lzf_decompress(std::string_view("\x02" "abc", 4), 2));
  EXPECT_EQ(lzf_decompress(std::string_view("\x02" "abc", 4), 3), "abc");
}

TEST(MapPicture, is_a_png_of_the_asked_width) {
  MapPicture picture;
  picture.points = sloping_ground_with_wall();
  picture.path = {{{5, 5}, {30, 10}, {55, 55}}, {0.01, 0.02, 0.05}, {0, 0.05}};
  picture.width_px = 600;
  const fs::path path = temp("map.png");
  write_map_picture(picture, path);
  std::ifstream in(path, std::ios::binary);
  std::string head(24, '\0');
  ASSERT_TRUE(in.read(head.data(), 24));
  EXPECT_EQ(head.substr(1, 3), "PNG");
  EXPECT_EQ(static_cast<unsigned char>(head[18]) * 256 + static_cast<unsigned char>(head[19]), 600);
  EXPECT_GT(fs::file_size(path), 20'000U);
  fs::remove(path);
  EXPECT_THROW(write_map_picture(picture, "/nonexistent/folder/map.png"), PlotError);
}

}  // namespace
}  // namespace slamd::plot
