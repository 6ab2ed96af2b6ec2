#include "drivers/io/udp_source.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "drivers/io/receive_clock.hpp"

namespace slamd {
namespace {

using std::chrono::milliseconds;

HostTime monotonic_now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return from_ns<HostTime>(std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec);
}

/// Sends datagrams to a port of the loopback interface, from an address of its choice in 127.0.0.0/8.
class Sender {
 public:
  explicit Sender(std::uint16_t port, const char* from = "127.0.0.1") : socket_{::socket(AF_INET, SOCK_DGRAM, 0)} {
    sockaddr_in own = address(from, 0);
    socklen_t size = sizeof own;
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&own), size), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    own_port_ = ntohs(own.sin_port);
    to_ = address("127.0.0.1", port);
  }
  ~Sender() { close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  std::uint16_t own_port() const { return own_port_; }

  void send(const std::string& text) {
    const auto* to = reinterpret_cast<const sockaddr*>(&to_);
    EXPECT_EQ(sendto(socket_, text.data(), text.size(), 0, to, sizeof to_), static_cast<ssize_t>(text.size()));
  }

 private:
  static sockaddr_in address(const char* text, std::uint16_t port) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_port = htons(port);
    inet_pton(AF_INET, text, &a.sin_addr);
    return a;
  }
  int socket_;
  std::uint16_t own_port_ = 0;
  sockaddr_in to_{};
};

UdpSource open(UdpSourceConfig config) {
  config.bind_address = "127.0.0.1";
  config.port = 0;
  auto opened = UdpSource::open(config);
  EXPECT_TRUE(opened) << opened.reason();
  return std::move(opened).value();
}

std::string text(const UdpPacket& packet) {
  return {packet.payload.begin(), packet.payload.end()};
}

TEST(UdpSource, DeliversDatagramsInOrderWithKernelStampsInHostTime) {
  UdpSource source = open({});
  Sender sender{source.port()};
  const HostTime before = monotonic_now();
  for (int i = 0; i < 5; ++i) sender.send("packet " + std::to_string(i));
  const HostTime after = monotonic_now();

  const auto packets = source.receive(milliseconds{2000});
  ASSERT_EQ(packets.size(), 5U);
  HostTime previous = before - std::chrono::microseconds{20};  // two clocks are read one after the other
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(text(packets[i]), "packet " + std::to_string(i));
    EXPECT_GE(packets[i].arrival, previous);
    EXPECT_EQ(packets[i].destination_port, source.port());
    previous = packets[i].arrival;
  }
  EXPECT_LE(previous, after + std::chrono::microseconds{20});
  constexpr std::uint8_t kLoopback[4] = {127, 0, 0, 1};
  EXPECT_EQ(packets[0].source, ipv4_address(kLoopback));
  EXPECT_EQ(source.stats().unstamped, 0U);
}

TEST(UdpSource, ComesBackEmptyAfterItsTimeout) {
  UdpSource source = open({});
  const HostTime before = monotonic_now();
  EXPECT_TRUE(source.receive(milliseconds{20}).empty());
  EXPECT_GE(monotonic_now() - before, milliseconds{19});
  EXPECT_TRUE(source.receive(milliseconds{-5}).empty());
  EXPECT_EQ(source.stats().errors, 0U);
}

TEST(UdpSource, WhatWaitedIsThrownAwayWhenAskedAndTheNextComes) {
  UdpSource source = open({});
  Sender sensor{source.port()};
  for (int i = 0; i < 100; ++i) sensor.send("old");
  source.drop_waiting();
  source.drop_waiting();
  EXPECT_TRUE(source.receive(milliseconds{0}).empty());
  sensor.send("new");
  const auto packets = source.receive(milliseconds{2000});
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(text(packets[0]), "new");
  EXPECT_EQ(source.stats().packets, 1U);
}

TEST(UdpSource, DropsAndCountsOtherSenders) {
  UdpSourceConfig config;
  config.source_address = "127.0.0.2";
  UdpSource source = open(config);
  Sender stranger{source.port(), "127.0.0.3"};
  Sender sensor{source.port(), "127.0.0.2"};
  stranger.send("no");
  sensor.send("yes");
  stranger.send("no");
  const auto packets = source.receive(milliseconds{2000});
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(text(packets[0]), "yes");
  EXPECT_EQ(source.stats().foreign, 2U);
}

TEST(UdpSource, DropsAndCountsOtherPortsOfTheSensorsAddress) {
  std::uint16_t free_port = 0;
  {
    free_port = open({}).port();
  }
  Sender sensor{free_port}, stranger{free_port};
  UdpSourceConfig config;
  config.bind_address = "127.0.0.1";
  config.port = free_port;
  config.source_address = "127.0.0.1";
  config.source_port = sensor.own_port();
  auto opened = UdpSource::open(config);
  ASSERT_TRUE(opened) << opened.reason();
  UdpSource source = std::move(opened).value();
  stranger.send("no");
  sensor.send("yes");
  const auto packets = source.receive(milliseconds{2000});
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(text(packets[0]), "yes");
  EXPECT_EQ(source.stats().foreign, 1U);
}

TEST(UdpSource, DropsAndCountsWhatIsLongerThanAnySensorPacket) {
  UdpSource source = open({});
  Sender sender{source.port()};
  sender.send(std::string(UdpSource::kMaxPayload + 1, 'x'));
  sender.send(std::string(UdpSource::kMaxPayload, 'y'));
  sender.send("");
  const auto packets = source.receive(milliseconds{2000});
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(packets[0].payload.size(), UdpSource::kMaxPayload);
  EXPECT_TRUE(packets[1].payload.empty());
  EXPECT_EQ(source.stats().oversized, 1U);
}

TEST(UdpSource, CountsWhatTheKernelDroppedForWantOfRoom) {
  UdpSourceConfig config;
  config.receive_buffer_bytes = 4096;
  UdpSource source = open(config);
  Sender sender{source.port()};
  constexpr std::uint64_t kSent = 200;
  for (std::uint64_t i = 0; i < kSent; ++i) sender.send(std::string(1206, 'x'));
  while (!source.receive(milliseconds{20}).empty()) continue;
  sender.send("the counter travels with the next datagram");
  ASSERT_EQ(source.receive(milliseconds{2000}).size(), 1U);
  EXPECT_GT(source.stats().overflowed, 0U);
  EXPECT_EQ(source.stats().packets + source.stats().overflowed, kSent + 1);
}

TEST(UdpSource, TakesAStreamLargerThanABatchWithoutLoss) {
  UdpSource source = open({});
  ASSERT_GT(source.receive_buffer_bytes(), 200'000);
  Sender sender{source.port()};
  for (int i = 0; i < 80; ++i) sender.send(std::to_string(i));
  int next = 0;
  for (auto packets = source.receive(milliseconds{2000}); !packets.empty();
       packets = source.receive(milliseconds{20})) {
    EXPECT_LE(packets.size(), UdpSource::kBatch);
    for (const UdpPacket& packet : packets) EXPECT_EQ(text(packet), std::to_string(next++));
  }
  EXPECT_EQ(next, 80);
}

TEST(UdpSource, SaysWhyItCannotOpen) {
  UdpSource first = open({});
  UdpSourceConfig config;
  config.bind_address = "127.0.0.1";
  config.port = first.port();
  const auto second = UdpSource::open(config);
  ASSERT_FALSE(second);
  EXPECT_STREQ(second.reason(), "the UDP port is in use");
  config.bind_address = "not an address";
  EXPECT_STREQ(UdpSource::open(config).reason(), "bad bind address");
  config.bind_address = "127.0.0.1";
  config.source_address = "300.1.1.1";
  EXPECT_STREQ(UdpSource::open(config).reason(), "bad source address");
}

constexpr std::int64_t kRealtime = 1'780'000'000'000'000'000;
constexpr std::int64_t kMonotonic = 7'000'000'000;

TEST(ReceiveClock, CarriesAStampOverByItsAge) {
  ReceiveClock clock;
  clock.sample(kRealtime, from_ns<HostTime>(kMonotonic));
  EXPECT_EQ(clock.arrival(kRealtime), from_ns<HostTime>(kMonotonic));
  EXPECT_EQ(clock.arrival(kRealtime - 250'000), from_ns<HostTime>(kMonotonic - 250'000));
}

TEST(ReceiveClock, GivesNoArrivalForStampsOfTheFutureOrOfLongAgo) {
  ReceiveClock clock;
  clock.sample(kRealtime, from_ns<HostTime>(kMonotonic));
  EXPECT_FALSE(clock.arrival(kRealtime + 1'000'000));
  EXPECT_FALSE(clock.arrival(kRealtime - 11'000'000'000));
}

TEST(ReceiveClock, DistrustsTheBatchAcrossASetWallClockAndTrustsTheNext) {
  ReceiveClock clock;
  constexpr std::int64_t kMs = 1'000'000;
  clock.sample(kRealtime, from_ns<HostTime>(kMonotonic));
  clock.sample(kRealtime + 10 * kMs + 300 * kMs, from_ns<HostTime>(kMonotonic + 10 * kMs));
  EXPECT_FALSE(clock.arrival(kRealtime + 9 * kMs));
  clock.sample(kRealtime + 20 * kMs + 300 * kMs, from_ns<HostTime>(kMonotonic + 20 * kMs));
  EXPECT_EQ(clock.arrival(kRealtime + 320 * kMs), from_ns<HostTime>(kMonotonic + 20 * kMs));
}

TEST(ReceiveClock, ReadsTheSystemsClocks) {
  ReceiveClock clock;
  const HostTime before = monotonic_now();
  clock.sample();
  EXPECT_GE(clock.now(), before);
  EXPECT_LE(clock.now(), monotonic_now());
}

}  // namespace
}  // namespace slamd
