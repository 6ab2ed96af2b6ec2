// Reading ports, IMU frames and NMEA must not allocate or lock once they run.
#include <gtest/gtest.h>
#include <pthread.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>

#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/io/serial_source.hpp"
#include "tests/drivers/nmea_text.hpp"
#include "tests/support/thread_accounting.hpp"

namespace slamd {
namespace {

using namespace std::chrono_literals;

class StreamAllocation : public testing::Test {
 protected:
  void SetUp() override {
    if (!thread_accounting_works()) GTEST_SKIP() << "the sanitizer has its own allocator";
    pthread_setname_np(pthread_self(), "stream");
    delete new int{};  // so that this thread has an account
    const std::uint64_t before = spent();
    asking_ = spent() - before;
  }
  static std::uint64_t spent() {
    const ThreadAccount account = thread_account("stream");
    return account.allocations + account.locks;
  }
  std::uint64_t asking_ = 0;
};

TEST_F(StreamAllocation, ParsingFramesAllocatesNothingGoodOrBad) {
  ImuFrameParser parser;
  int samples = 0;
  const std::uint64_t before = spent();
  for (int i = 0; i < 4000; ++i) {
    ImuFrame frame;
    frame.sequence = static_cast<std::uint16_t>(i);
    frame.device_us = static_cast<std::uint64_t>(i) * 5000 + (i < 2000 ? 1'000'000'000U : 0U);
    auto wire = encode(frame);
    if (i % 50 == 7) wire[5] ^= 0x40U;
    parser.feed(wire, HostTime{i * 5ms}, [&](const ImuSample&) { ++samples; });
  }
  EXPECT_EQ(spent(), before + asking_);
  EXPECT_GT(samples, 3800);
  EXPECT_EQ(parser.stats().resets, 1U);
}

TEST_F(StreamAllocation, ParsingNmeaAllocatesNothing) {
  const std::array<std::string, 3> lines{test::sentence("GPGSA,A,3,,,,,,,,,,,,,1.5,0.9,1.2"),
                                         test::sentence("GPVTG,90.0,T,,M,3.6,N,,K,A"), "$GPGGA,broken\r\n"};
  std::array<std::string, 60> cycles;
  for (std::size_t s = 0; s < cycles.size(); ++s) {
    const std::string time = "1200" + std::string(s < 10 ? "0" : "") + std::to_string(s) + ".00";
    cycles[s] = test::sentence("GPGGA," + time + ",4815.91801,N,01140.28435,E,1,11,0.87,481.6,M,46.2,M,,") + lines[0] +
                test::sentence("GPRMC," + time + ",A,4815.91801,N,01140.28435,E,0.1,90.0,010626,,,A") + lines[1] +
                lines[2];
  }
  NmeaParser parser;
  int fixes = 0;
  const std::uint64_t before = spent();
  for (std::size_t s = 0; s < cycles.size(); ++s) {
    parser.feed(test::bytes_of(cycles[s]), HostTime{s * 1000ms}, [&](const GnssFix&) { ++fixes; });
  }
  EXPECT_EQ(spent(), before + asking_);
  EXPECT_EQ(fixes, 60);
}

TEST_F(StreamAllocation, ReadingAnOpenPortAllocatesNothing) {
  int master = -1, slave = -1;
  std::array<char, 128> name{};
  ASSERT_EQ(openpty(&master, &slave, name.data(), nullptr, nullptr), 0);
  SerialSource source{{.path = name.data()}};
  source.read(1ms);
  ASSERT_TRUE(source.is_open());
  const std::array<std::uint8_t, 32> bytes{1, 2, 3};
  const std::uint64_t before = spent();
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(::write(master, bytes.data(), bytes.size()), 32);
    source.read(1s);
  }
  source.read(1ms);
  EXPECT_EQ(spent(), before + asking_);
  EXPECT_EQ(source.stats().bytes, 3200U);
  ::close(slave);
  ::close(master);
}

}  // namespace
}  // namespace slamd
