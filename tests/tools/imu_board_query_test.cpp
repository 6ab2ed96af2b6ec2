// Questions of imu-monitor to the board, against a board in memory, and the words of the answers.

#include <gtest/gtest.h>

#include <vector>

#include "tools/imu-monitor/board_query.hpp"

namespace slamd::monitor {
namespace {

/// Answers each command, or refuses it, after packets that are not the answer.
class MemoryBoard final : public ByteSource {
 public:
  std::vector<std::uint8_t> stream;
  std::vector<std::uint8_t> sent;

  SourceRead read(Duration) override {
    given_.swap(stream);
    stream.clear();
    return {given_, HostTime{}};
  }
  bool write(std::span<const std::uint8_t> bytes) override {
    sent.assign(bytes.begin(), bytes.end());
    const auto command = read_packet<Command>(*open_packet(bytes.first(bytes.size() - 1)));
    Identity other;  // an answer to somebody else
    other.tag = static_cast<std::uint16_t>(command->tag + 1);
    append(encode(other));
    append(encode(Statistics{}));  // unasked, tag 0
    if (refuses) {
      append(encode(Acknowledgement{command->code, command->tag, CommandResult::kBusy}));
    } else {
      Identity identity;
      identity.tag = command->tag;
      identity.version = {1, 2, 3};
      append(encode(identity));
    }
    return true;
  }
  bool is_open() const override { return true; }
  const SourceStats& stats() const override { return stats_; }

  bool refuses = false;

 private:
  template <std::size_t N>
  void append(const std::array<std::uint8_t, N>& bytes) {
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }

  std::vector<std::uint8_t> given_;
  SourceStats stats_;
};

TEST(BoardQuery, TheAnswerWithTheCommandsTagIsTaken) {
  MemoryBoard board;
  const auto answer = ask(board, CommandCode::kIdentity, std::chrono::seconds{10});
  ASSERT_TRUE(answer && read_packet<Identity>(*answer));
  EXPECT_EQ(read_packet<Identity>(*answer)->version, (std::array<std::uint8_t, 3>{1, 2, 3}));
}

TEST(BoardQuery, ARefusalIsNoAnswer) {
  MemoryBoard board;
  board.refuses = true;
  EXPECT_FALSE(ask(board, CommandCode::kSelfTest, std::chrono::seconds{10}));
}

TEST(BoardQuery, WordsNameWhatIsWrong) {
  Identity identity;
  identity.unique_id = {0xE6, 0x61, 0x64, 0x07, 0xE3, 0x55, 0x4C, 0x29};
  identity.sensor_id = 0x6C;
  EXPECT_NE(identity_text(identity).find("serial E6616407E3554C29"), std::string::npos);
  EXPECT_NE(identity_text(identity).find("(LSM6DSOX)"), std::string::npos);
  identity.sensor_id = 0x6A;
  EXPECT_NE(identity_text(identity).find("not an LSM6DSOX"), std::string::npos);

  Statistics statistics;
  statistics.sensor_state = SensorState::kFault;
  statistics.fault = SensorFault::kBusHung;
  statistics.reset_cause = ResetCause::kWatchdog;
  const std::string text = statistics_text(statistics);
  EXPECT_NE(text.find("started by watchdog"), std::string::npos);
  EXPECT_NE(text.find("fault, last fault: the bus hangs"), std::string::npos);
  statistics.fault = static_cast<SensorFault>(99);  // of a newer firmware
  EXPECT_NE(statistics_text(statistics).find("unknown"), std::string::npos);

  SelfTestReport report;
  report.outcome = SelfTestOutcome::kFailed;
  report.failed_axes = 0b010100;
  EXPECT_NE(self_test_text(report).find("FAILED, accel z, gyro y"), std::string::npos);
}

}  // namespace
}  // namespace slamd::monitor
