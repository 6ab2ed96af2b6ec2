// How slam-sim's bytes leave: drive folders, pseudo terminals, and the queue that generates ahead of time.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <fstream>
#include <sstream>
#include <thread>

#include "tools/slam-sim/output/drive_folder.hpp"
#include "tools/slam-sim/output/motion_file.hpp"
#include "tools/slam-sim/output/pty_port.hpp"
#include "tools/slam-sim/output/slice_queue.hpp"

namespace slamd::sim {
namespace {

DriveSpec small_drive() {
  DriveSpec spec;
  spec.world = WorldKind::kCorridor;
  spec.course.kind = CourseKind::kStandstill;
  spec.max_duration_s = 2.5;
  spec.with_lidar = false;
  return spec;
}

std::filesystem::path scratch(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / (name + "_" + std::to_string(::getpid()));
}

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream{path}.rdbuf();
  return text.str();
}

TEST(SimOutput, TheQueueHandsOutWhatTheSimulationMakesInOrder) {
  Simulation direct{small_drive()}, ahead{small_drive()};
  SliceQueue queue{ahead, 2};
  queue.wait_for(2);
  std::size_t slices = 0;
  for (auto slice = queue.pop(); slice; slice = queue.pop(), ++slices) {
    const auto expected = direct.next_slice();
    ASSERT_EQ(slice->size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ((*slice)[i].bytes, expected[i].bytes);
  }
  EXPECT_EQ(slices, 5U);
}

TEST(SimOutput, AQueueThatNobodyEmptiesStopsCleanly) {
  Simulation simulation{small_drive()};
  SliceQueue queue{simulation, 1};
  queue.wait_for(1);
}

TEST(SimOutput, AFolderHasOnlyTheFilesOfSensorsThatSpoke) {
  const auto folder = scratch("drive");
  {
    Simulation simulation{small_drive()};
    DriveFolder out{folder, {.host_start_ns = 1'000'000'000}};
    while (!simulation.done()) {
      for (const WireEvent& event : simulation.next_slice()) out.write(event);
    }
    out.write_truth(simulation.trajectory(), simulation.duration());
    out.write_vehicle(simulation.vehicle());
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "lidar.pcap"));
  const std::string imu = text_of(folder / "imu.csv"), gps = text_of(folder / "gps.csv"),
                    truth = text_of(folder / "truth.tum");
  EXPECT_EQ(imu.substr(0, imu.find('\n')), "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2,temp_c");
  EXPECT_NEAR(static_cast<double>(std::count(imu.begin(), imu.end(), '\n')), 501.0, 1.0);
  EXPECT_NE(gps.find(",$GPGGA,080002.00,"), std::string::npos);
  EXPECT_EQ(gps.find('\r'), std::string::npos);
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 251);
  EXPECT_EQ(truth.substr(0, 12), "1.000000000 ");
  EXPECT_NE(text_of(folder / "vehicle.yaml").find("lidar_vertical_offsets: true"), std::string::npos);
  EXPECT_NE(text_of(folder / "vehicle.yaml").find("p_base_antenna: [-0.600000, 0.350000, 1.740000]"),
            std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(SimOutput, AFolderThatCannotBeMadeSaysWhy) {
  try {
    DriveFolder out{"/proc/no/such/place", {}};
    FAIL() << "made a folder in /proc";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/proc/no/such/place"), std::string::npos);
  }
}

std::vector<std::uint8_t> read_available(int fd) {
  std::vector<std::uint8_t> bytes;
  pollfd ready{fd, POLLIN, 0};
  while (::poll(&ready, 1, 200) == 1) {
    std::uint8_t chunk[4096];
    const auto count = ::read(fd, chunk, sizeof chunk);
    if (count <= 0) break;
    bytes.insert(bytes.end(), chunk, chunk + count);
  }
  return bytes;
}

TEST(SimOutput, APtyCarriesEveryByteUnchangedAndVanishesWithItsOwner) {
  const auto link = scratch("pty");
  {
    PtyPort port{link};
    const FileDescriptor reader{::open(link.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
    ASSERT_TRUE(reader);
    std::vector<std::uint8_t> all(256);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
    EXPECT_TRUE(port.write(all));
    EXPECT_EQ(read_available(reader.get()), all);
  }
  EXPECT_FALSE(std::filesystem::is_symlink(link));
}

int unread(int fd) {
  int count = 0;
  return ::ioctl(fd, FIONREAD, &count) == 0 ? count : -1;
}

TEST(SimOutput, APtyWithoutAReaderDropsOldBytesInsteadOfBlocking) {
  const auto link = scratch("pty_unread");
  PtyPort port{link};
  const FileDescriptor idle{::open(link.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
  const std::vector<std::uint8_t> frame(32, 7);
  int dropped = 0, expected = 0;
  for (int i = 0; i < 300; ++i) {
    const bool kept = port.write(frame);
    dropped += kept ? 0 : 1;
    expected = kept ? expected + 32 : 32;
    // The kernel hands bytes over in its own time.
    for (int tries = 0; unread(idle.get()) != expected && tries < 10'000'000; ++tries) std::this_thread::yield();
    ASSERT_EQ(unread(idle.get()), expected);
  }
  EXPECT_GE(dropped, 4);
  EXPECT_LT(expected, 2200);
}

TEST(SimOutput, APtyDoesNotReplaceARealFile) {
  const auto link = scratch("file");
  std::ofstream{link} << "precious";
  EXPECT_THROW(PtyPort{link}, std::runtime_error);
  EXPECT_EQ(text_of(link), "precious");
  std::filesystem::remove(link);
}

TEST(SimOutput, TheMotionFileOfAStandstillIsGravityAtAThousandLinesASecond) {
  DriveSpec spec = small_drive();
  spec.course.wobble = {};
  const Simulation simulation{spec};
  const auto path = scratch("motion");
  write_imu_motion(path, simulation, 9.81, 7'000'000'000);
  std::istringstream lines{text_of(path)};
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "t_ns,gx_rads,gy_rads,gz_rads,ax_mps2,ay_mps2,az_mps2");
  std::int64_t expected_ns = 7'000'000'000;
  for (; std::getline(lines, line); expected_ns += 1'000'000) {
    long long stamp_ns = 0;
    double w[3], f[3];
    ASSERT_EQ(std::sscanf(line.c_str(), "%lld,%lf,%lf,%lf,%lf,%lf,%lf", &stamp_ns, w, w + 1, w + 2, f, f + 1, f + 2), 7);
    ASSERT_EQ(stamp_ns, expected_ns);
    EXPECT_NEAR(std::hypot(f[0], f[1], f[2]), 9.81, 0.3);
    EXPECT_LT(std::hypot(w[0], w[1], w[2]), 0.1);
  }
  EXPECT_EQ(expected_ns, 7'000'000'000 + 2'501 * 1'000'000LL);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace slamd::sim
