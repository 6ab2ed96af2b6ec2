// Receiving and decoding must not allocate or lock once they run.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "drivers/io/udp_source.hpp"
#include "drivers/velodyne/vlp16_decoder.hpp"
#include "tests/drivers/vlp16_bytes.hpp"
#include "tests/support/thread_accounting.hpp"

namespace slamd {
namespace {

class DriverAllocation : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!thread_accounting_works()) GTEST_SKIP() << "the sanitizer has its own allocator";
    pthread_setname_np(pthread_self(), "driver");
    delete new int{};  // so that this thread has an account
  }
  static std::uint64_t spent() {
    const ThreadAccount account = thread_account("driver");
    return account.allocations + account.locks;
  }
  /// What asking itself costs.
  static std::uint64_t cost_of_asking() {
    const std::uint64_t before = spent();
    return spent() - before;
  }
};

TEST_F(DriverAllocation, DecodingAllocatesNothingGoodPacketOrBad) {
  Vlp16Decoder decoder{{}};
  const std::uint64_t asking = cost_of_asking();
  const std::uint64_t before = spent();
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Vlp16Bytes packet{static_cast<int>(i * 480 % 36000), 40,
                      static_cast<std::uint32_t>(std::uint64_t{i} * 1327104 / 1000)};
    packet.fill_returns(5000);
    if (i % 7 == 3) packet.set_azimuth(4, 36000);
    decoder.decode(packet.span(), from_ns<HostTime>(1'000'000'000 + std::int64_t{i} * 1'327'104));
  }
  EXPECT_EQ(spent(), before + asking);
  EXPECT_GT(decoder.stats().accepted, 1500U);
}

TEST_F(DriverAllocation, ReceivingAllocatesNothing) {
  UdpSourceConfig config;
  config.bind_address = "127.0.0.1";
  config.port = 0;
  UdpSource source = UdpSource::open(config).value();
  const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(source.port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const std::uint64_t asking = cost_of_asking();
  const std::uint64_t before = spent();
  std::size_t received = 0;
  for (int i = 0; i < 100; ++i) {
    const char text[] = "datagram";
    EXPECT_GT(sendto(sender, text, sizeof text, 0, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    received += source.receive(std::chrono::milliseconds{2000}).size();
  }
  EXPECT_EQ(spent(), before + asking);
  EXPECT_EQ(received, 100U);
  close(sender);
}

}  // namespace
}  // namespace slamd
