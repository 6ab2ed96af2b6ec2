#include "drivers/io/serial_source.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace slamd {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// A pty whose other end is reached by a symlink, like a device under /dev/serial/by-id.
class FakeDevice {
 public:
  explicit FakeDevice(fs::path link) : link_{std::move(link)} {
    int slave = -1;
    std::array<char, 128> name{};
    EXPECT_EQ(openpty(&master_, &slave, name.data(), nullptr, nullptr), 0);
    ::close(slave);
    fs::remove(link_);
    fs::create_symlink(name.data(), link_);
  }
  FakeDevice(const FakeDevice&) = delete;
  FakeDevice& operator=(const FakeDevice&) = delete;
  ~FakeDevice() {
    ::close(master_);
    fs::remove(link_);
  }
  void send(const std::vector<std::uint8_t>& bytes) const {
    EXPECT_EQ(::write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

 private:
  fs::path link_;
  int master_ = -1;
};

class SerialSourceTest : public testing::Test {
 protected:
  SerialSourceTest() : link_{fs::temp_directory_path() / ("slamd_serial_test_" + std::to_string(getpid()))} {}
  ~SerialSourceTest() override { fs::remove(link_); }

  SerialSourceConfig config() const { return {.path = link_, .baud = 115200, .reopen = {.shortest = 1ms, .longest = 4ms}}; }
  /// Opens the source: the kernel drops what was sent before.
  static void settle(SerialSource& source) {
    for (int i = 0; i < 1000 && !source.is_open(); ++i) source.read(5ms);
    ASSERT_TRUE(source.is_open());
  }
  static std::vector<std::uint8_t> collect(SerialSource& source, std::size_t size) {
    std::vector<std::uint8_t> all;
    for (int i = 0; i < 1000 && all.size() < size; ++i) {
      const SourceRead read = source.read(20ms);
      all.insert(all.end(), read.bytes.begin(), read.bytes.end());
    }
    return all;
  }

  fs::path link_;
};

TEST_F(SerialSourceTest, PassesEveryByteValueUnchanged) {
  FakeDevice device{link_};
  SerialSource source{config()};
  settle(source);
  std::vector<std::uint8_t> sent(256);
  std::iota(sent.begin(), sent.end(), std::uint8_t{0});
  device.send(sent);
  EXPECT_EQ(collect(source, sent.size()), sent);
  EXPECT_EQ(source.stats().bytes, 256U);
}

TEST_F(SerialSourceTest, StampsBytesBetweenSendingAndReturning) {
  FakeDevice device{link_};
  SerialSource source{config()};
  settle(source);
  const auto before = std::chrono::steady_clock::now().time_since_epoch();
  device.send({1, 2, 3});
  SourceRead read = source.read(1s);
  const auto after = std::chrono::steady_clock::now().time_since_epoch();
  ASSERT_FALSE(read.bytes.empty());
  EXPECT_GE(read.arrival.time_since_epoch(), before);
  EXPECT_LE(read.arrival.time_since_epoch(), after);
}

TEST_F(SerialSourceTest, ReturnsEmptyAfterTheTimeoutWhenNothingComes) {
  FakeDevice device{link_};
  SerialSource source{config()};
  settle(source);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(source.read(30ms).bytes.empty());
  EXPECT_GE(std::chrono::steady_clock::now() - before, 30ms);
  EXPECT_TRUE(source.is_open());
}

TEST_F(SerialSourceTest, AMissingPortIsTriedAgainWithinTheTimeout) {
  SerialSource source{config()};
  EXPECT_TRUE(source.read(20ms).bytes.empty());
  EXPECT_FALSE(source.is_open());
  for (int i = 0; i < 20; ++i) source.read(5ms);
  EXPECT_GE(source.stats().failed_openings, 2U);
  EXPECT_EQ(source.stats().openings, 0U);
}

TEST_F(SerialSourceTest, ARefusedPathIsNoSerialPort) {
  {
    const int file = ::open(link_.c_str(), O_CREAT | O_WRONLY, 0600);
    ::close(file);
  }
  SerialSource source{config()};
  source.read(1ms);
  EXPECT_FALSE(source.is_open());
  EXPECT_EQ(source.stats().failed_openings, 1U);
}

TEST_F(SerialSourceTest, FollowsUnplugAndReplugThroughTheSamePath) {
  SerialSource source{config()};
  for (std::uint8_t round = 1; round <= 3; ++round) {
    auto device = std::make_unique<FakeDevice>(link_);
    settle(source);
    device->send({round, round});
    EXPECT_EQ(collect(source, 2), (std::vector<std::uint8_t>{round, round}));
    EXPECT_EQ(source.stats().openings, round);

    device.reset();
    for (int i = 0; i < 1000 && source.is_open(); ++i) source.read(5ms);
    EXPECT_FALSE(source.is_open());
    EXPECT_EQ(source.stats().losses, round);
  }
}

}  // namespace
}  // namespace slamd
