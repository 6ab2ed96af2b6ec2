#include "drivers/rplidar/rplidar_parser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "drivers/rplidar/rplidar_session.hpp"

namespace slamd {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Step = RplidarSession::Step;
using std::chrono::milliseconds;

constexpr HostTime kStart{std::chrono::seconds{100}};
constexpr float kRadPerDeg = std::numbers::pi_v<float> / 180.0F;

Bytes bytes_of(const RplidarRequest& request) { return {request.view().begin(), request.view().end()}; }

TEST(RplidarProtocol, RequestsAreTheManualsBytes) {
  EXPECT_EQ(bytes_of(rplidar_request(RplidarCommand::kStop)), (Bytes{0xA5, 0x25}));
  EXPECT_EQ(bytes_of(rplidar_request(RplidarCommand::kScan)), (Bytes{0xA5, 0x20}));
  EXPECT_EQ(bytes_of(rplidar_express_request(0)), (Bytes{0xA5, 0x82, 0x05, 0, 0, 0, 0, 0, 0x22}));
  EXPECT_EQ(bytes_of(rplidar_motor_request(660)), (Bytes{0xA5, 0xF0, 0x02, 0x94, 0x02, 0xC1}));
  EXPECT_EQ(bytes_of(rplidar_config_request(RplidarConfigKey::kTypicalMode)), (Bytes{0xA5, 0x84, 0x04, 0x7C, 0, 0, 0, 0x59}));
}

TEST(RplidarProtocol, KnowsDescriptorsByTheirExactForm) {
  const std::array<std::uint8_t, 7> scan{0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81};
  const auto found = parse_rplidar_descriptor(scan);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->answer, RplidarAnswer::kScan);
  EXPECT_EQ(found->size, 5U);
  EXPECT_TRUE(found->is_stream);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    auto wrong = scan;
    wrong[i] ^= 0x20;
    EXPECT_FALSE(parse_rplidar_descriptor(wrong)) << i;
  }
}

/// Everything that a reader finds in bytes.
std::vector<Bytes> packets(RplidarReader& reader, const Bytes& bytes) {
  std::vector<Bytes> found;
  for (const std::uint8_t byte : bytes) {
    if (const auto packet = reader.take(byte)) found.emplace_back(packet->bytes.begin(), packet->bytes.end());
  }
  return found;
}

TEST(RplidarReader, FindsAnswersAmongGarbage) {
  RplidarReader reader;
  const Bytes health{0xA5, 0x5A, 0x03, 0, 0, 0, 0x06, 0x01, 0x34, 0x12};
  Bytes bytes{0x00, 0xA5, 0xA5, 0x5A, 0x99};
  bytes.insert(bytes.end(), health.begin(), health.end());
  EXPECT_EQ(packets(reader, bytes), (std::vector<Bytes>{{0x01, 0x34, 0x12}}));
  EXPECT_EQ(parse_rplidar_health(Bytes{1, 0x34, 0x12}), RplidarHealth::kWarning);
  EXPECT_FALSE(parse_rplidar_health(Bytes{3, 0, 0}));
  EXPECT_EQ(reader.stats().answers, 1U);
  EXPECT_EQ(reader.stats().garbage_bytes, 5U);
}

TEST(RplidarReader, GoesOnAtTheNextSampleAfterALostByte) {
  RplidarReader reader;
  packets(reader, {0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81});
  const Bytes node{0xBE, 0x01, 0x10, 0xA0, 0x0F};
  Bytes bytes = node;
  bytes.insert(bytes.end(), node.begin(), node.begin() + 3);
  for (int i = 0; i < 4; ++i) bytes.insert(bytes.end(), node.begin(), node.end());
  EXPECT_GE(packets(reader, bytes).size(), 4U);
}

/// A capsule with its checksum.
Bytes capsule(std::size_t size, float begin_deg, const Bytes& cabin) {
  Bytes bytes(size);
  const auto angle = static_cast<unsigned>(std::lround(begin_deg * 64.0F));
  bytes[2] = static_cast<std::uint8_t>(angle);
  bytes[3] = static_cast<std::uint8_t>(angle >> 8U);
  for (std::size_t at = 4; at < size; ++at) bytes[at] = cabin[(at - 4) % cabin.size()];
  std::uint8_t sum = 0;
  for (std::size_t i = 2; i < size; ++i) sum ^= bytes[i];
  bytes[0] = static_cast<std::uint8_t>(0xA0U | (sum & 0xFU));
  bytes[1] = static_cast<std::uint8_t>(0x50U | (sum >> 4U));
  return bytes;
}

RplidarPacket packet_of(RplidarAnswer answer, const Bytes& bytes) { return {answer, bytes}; }

TEST(RplidarUnpacker, ExpressSamplesLieEvenlyLessTheirOffset) {
  RplidarUnpacker unpacker;
  // 1000 mm with an offset of 6.5 degrees (52 eighths), 2000 mm with 7 degrees (56)
  const Bytes cabin{0xA3, 0x0F, 0x43, 0x1F, 0x84};
  const Bytes first = capsule(84, 350.0F, cabin), second = capsule(84, 14.0F, cabin);
  EXPECT_FALSE(unpacker.take(packet_of(RplidarAnswer::kExpress, first)));
  const auto found = unpacker.take(packet_of(RplidarAnswer::kExpress, second));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->samples.size(), 32U);
  EXPECT_TRUE(found->is_delayed);
  EXPECT_NEAR(found->samples[0].range_m, 1.0F, 1e-6F);
  EXPECT_NEAR(found->samples[1].range_m, 2.0F, 1e-6F);
  EXPECT_NEAR(found->samples[0].angle_rad, (350.0F - 6.5F) * kRadPerDeg, 1e-5F);
  EXPECT_NEAR(found->samples[1].angle_rad, (350.75F - 7.0F) * kRadPerDeg, 1e-5F);
  int begins = 0;
  for (const RplidarSample& sample : found->samples) begins += sample.begins_turn ? 1 : 0;
  EXPECT_EQ(begins, 1);
  EXPECT_TRUE(found->samples[14].begins_turn);  // 350 + 14 * 0.75 = 360.5
}

TEST(RplidarUnpacker, BoostRangesAreScaledAndTakenFromTheirNeighbours) {
  EXPECT_EQ(rplidar_unscale(511).range_mm, 511U);
  EXPECT_EQ(rplidar_unscale(512).range_mm, 512U);
  EXPECT_EQ(rplidar_unscale(1280).range_mm, 2048U);
  EXPECT_EQ(rplidar_unscale(1281).range_mm, 2052U);
  EXPECT_EQ(rplidar_unscale(1792).range_mm, 4096U);
  EXPECT_EQ(rplidar_unscale(3328).range_mm, 16384U);
  RplidarUnpacker unpacker;
  // major 2052 mm (steps of 4), the second 3 steps more, the third none (511)
  const std::uint32_t word = 1281U | (3U << 12U) | (511U << 22U);
  Bytes cabin;
  for (unsigned i = 0; i < 4; ++i) cabin.push_back(static_cast<std::uint8_t>(word >> (8U * i)));
  unpacker.take(packet_of(RplidarAnswer::kBoost, capsule(132, 100.0F, cabin)));
  const auto found = unpacker.take(packet_of(RplidarAnswer::kBoost, capsule(132, 143.2F, cabin)));
  ASSERT_TRUE(found);
  ASSERT_EQ(found->samples.size(), 96U);
  EXPECT_NEAR(found->samples[0].range_m, 2.052F, 1e-5F);
  EXPECT_NEAR(found->samples[1].range_m, 2.064F, 1e-5F);
  EXPECT_EQ(found->samples[2].range_m, 0.0F);
  const float offset_deg = 8.0F - std::asin(24.01F / 2052.0F) / kRadPerDeg;
  EXPECT_NEAR(found->samples[0].angle_rad, (100.0F - offset_deg) * kRadPerDeg, 1e-4F);
}

TEST(RplidarUnpacker, GivesACapsuleUpWhoseSuccessorIsMissing) {
  RplidarUnpacker unpacker;
  const Bytes cabin{0, 0, 0, 0, 0};
  unpacker.take(packet_of(RplidarAnswer::kExpress, capsule(84, 0.0F, cabin)));
  EXPECT_FALSE(unpacker.take(packet_of(RplidarAnswer::kExpress, capsule(84, 180.0F, cabin))));
  EXPECT_EQ(unpacker.gaps(), 1U);
  EXPECT_TRUE(unpacker.take(packet_of(RplidarAnswer::kExpress, capsule(84, 208.8F, cabin))));
}

/// What the session asks next, as its command byte; 0 = nothing.
int asked(RplidarSession& session, HostTime now) {
  const auto request = session.poll(now);
  return request ? request->bytes[1] : 0;
}

TEST(RplidarSession, AsksInOrderAndScans) {
  RplidarSession session;
  HostTime now = kStart;
  EXPECT_EQ(asked(session, now), 0x25);
  EXPECT_EQ(asked(session, now), 0);
  now += milliseconds{60};
  EXPECT_EQ(asked(session, now), 0x50);
  session.take({RplidarAnswer::kInfo, Bytes(20)}, now);
  EXPECT_EQ(asked(session, now), 0x52);
  session.take({RplidarAnswer::kHealth, Bytes{0, 0, 0}}, now);
  EXPECT_EQ(asked(session, now), 0x59);
  session.take({RplidarAnswer::kSampleRate, Bytes{0xF4, 1, 0xFA, 0}}, now);
  EXPECT_EQ(asked(session, now), 0x84);
  session.take({RplidarAnswer::kConfig, Bytes{0x7C, 0, 0, 0, 2, 0}}, now);
  EXPECT_EQ(asked(session, now), 0x84);
  session.take({RplidarAnswer::kConfig, Bytes{0x75, 0, 0, 0, 0x84}}, now);
  EXPECT_EQ(asked(session, now), 0x84);
  session.take({RplidarAnswer::kConfig, Bytes{0x71, 0, 0, 0, 0, 0x7D, 0, 0}}, now);
  EXPECT_EQ(asked(session, now), 0xF0);
  now += milliseconds{700};
  const auto scan = session.poll(now);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->bytes[1], 0x82);
  EXPECT_EQ(scan->bytes[3], 2);
  session.take({RplidarAnswer::kBoost, {}}, now);
  EXPECT_EQ(session.step(), Step::kRunning);
  EXPECT_EQ(asked(session, now + milliseconds{900}), 0);
  session.heard(now + milliseconds{900});
  EXPECT_EQ(asked(session, now + milliseconds{1'800}), 0);
  EXPECT_EQ(asked(session, now + milliseconds{2'000}), 0x25);  // silent for a second
  EXPECT_EQ(session.stats().stalls, 1U);
}

TEST(RplidarSession, ResetsASensorThatIsIllAndTriesAgain) {
  RplidarSession session;
  HostTime now = kStart;
  asked(session, now);
  now += milliseconds{60};
  asked(session, now);
  session.take({RplidarAnswer::kInfo, Bytes(20)}, now);
  asked(session, now);
  session.take({RplidarAnswer::kHealth, Bytes{2, 0, 0}}, now);
  EXPECT_EQ(asked(session, now), 0x40);
  EXPECT_EQ(session.stats().resets, 1U);
  EXPECT_EQ(asked(session, now + milliseconds{1'100}), 0x25);
}

TEST(RplidarSession, AsksAMutePortSomeTimesAndThenRests) {
  RplidarSession session;
  int requests = 0;
  for (int ms = 0; ms < 10'000; ms += 10) requests += asked(session, kStart + milliseconds{ms}) != 0 ? 1 : 0;
  EXPECT_GE(session.stats().failures, 3U);
  EXPECT_LE(requests, 20);
}

}  // namespace
}  // namespace slamd
