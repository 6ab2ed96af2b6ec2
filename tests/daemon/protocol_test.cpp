#include <sys/stat.h>

#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "daemon/server/protocol/pose_page.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "tests/daemon/server_fixture.hpp"

namespace slamd::test {
namespace {

using nlohmann::json;

std::string text_of(const std::string& path) {
  std::ifstream file{SLAMD_SOURCE_DIR "/" + path};
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// The first group of every match.
std::set<std::string> all_of(const std::string& text, const char* pattern) {
  const std::regex regex{pattern};
  std::set<std::string> found;
  for (auto match = std::sregex_iterator{text.begin(), text.end(), regex}; match != std::sregex_iterator{}; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

/// Does the answer hold what is wanted of it? Further fields are no fault; "<type>" stands for any value of the type.
bool holds(const json& answer, const json& wanted) {
  if (wanted == "<number>") return answer.is_number();
  if (wanted == "<string>") return answer.is_string();
  if (wanted == "<list>") return answer.is_array();
  if (wanted == "<object>") return answer.is_object();
  if (wanted == "<null>") return answer.is_null();
  if (!wanted.is_object()) return answer == wanted;
  if (!answer.is_object()) return false;
  for (const auto& [key, value] : wanted.items()) {
    if (!answer.contains(key) || !holds(answer.at(key), value)) return false;
  }
  return true;
}

std::filesystem::path transcript_folder() { return SLAMD_SOURCE_DIR "/tests/daemon/transcripts"; }

std::vector<std::string> transcripts() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator{transcript_folder()}) names.push_back(file.path().stem());
  return names;
}

class ProtocolTest : public ServerTest {
 protected:
  /// Plays one line of a transcript; lines that are none of its four kinds are comments.
  void play(RawClient& client, const std::string& line) {
    if (line.starts_with("> ")) {
      ASSERT_TRUE(client.send(line.substr(2) + '\n'));
    } else if (line.starts_with("< ")) {
      expect_answer(client, json::parse(line.substr(2)));
    } else if (line == "! pose") {
      publish(++published_ * 1'000'000'000);
    } else if (line == "! fd") {
      const UniqueFd fd = client.take_fd();
      struct stat status {};
      ASSERT_TRUE(fd && ::fstat(fd.get(), &status) == 0);
      EXPECT_GT(status.st_size, 0);
    } else {
      ASSERT_TRUE(line.empty() || line.front() == '#') << "no line of a transcript";
    }
  }

  static void expect_answer(RawClient& client, const json& wanted) {
    const char* kind = wanted.contains("method") ? "method" : "id";
    std::optional<json> answer = client.receive();
    while (answer && answer->value(kind, json{}) != wanted.at(kind)) answer = client.receive();
    ASSERT_TRUE(answer) << "the daemon hung up or said nothing";
    EXPECT_TRUE(holds(*answer, wanted)) << *answer;
  }

  std::int64_t published_ = 0;
};

class OldClient : public ProtocolTest, public testing::WithParamInterface<std::string> {};

TEST_P(OldClient, IsServedAsOnTheDayOfItsTranscript) {
  add_keyframe(0, 1000);
  trajectory_.add(from_ns<HostTime>(1'000'000'000), Pose{Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0}});
  start();
  RawClient client = connect();
  std::ifstream transcript{transcript_folder() / (GetParam() + ".txt")};
  int lines = 0;
  for (std::string line; std::getline(transcript, line); ++lines) {
    SCOPED_TRACE(line);
    ASSERT_NO_FATAL_FAILURE(play(client, line));
  }
  EXPECT_GT(lines, 10);
}

INSTANTIATE_TEST_SUITE_P(Transcripts, OldClient, testing::ValuesIn(transcripts()),
                         [](const auto& transcript) { return transcript.param; });

TEST_F(ProtocolTest, WhatATranscriptWantsIsCompared) {
  const json answer = json::parse(R"({"a": {"b": 1, "more": 2}, "c": "text", "d": [1, 2]})");
  EXPECT_TRUE(holds(answer, json::parse(R"({"a": {"b": "<number>"}, "c": "<string>", "d": [1, 2]})")));
  for (const char* wrong : {R"({"a": {"b": 2}})", R"({"a": {"gone": "<number>"}})", R"({"c": "<number>"})",
                            R"({"d": [1]})", R"({"c": {"b": 1}})", R"({"c": "other"})", R"({"d": "<null>"})"}) {
    EXPECT_FALSE(holds(answer, json::parse(wrong))) << wrong;
  }
}

TEST_F(ProtocolTest, TheDocumentedMethodsAreExactlyTheServersAndEachIsServed) {
  start();
  RawClient client = connect();
  const auto served = client.call(1, "version").at("result").at("methods").get<std::set<std::string>>();
  EXPECT_EQ(all_of(text_of("docs/protocol.md"), "\n### `(\\w+)`"), served);
  for (const std::string& method : served) {
    const json answer = client.call(2, method, {{"surely_unknown", 1}});
    EXPECT_EQ(answer.at("error").at("code"), protocol::error::kInvalidParams) << method;
  }
}

TEST_F(ProtocolTest, TheDocumentedErrorsAndNotificationsAreExactlyTheCodes) {
  const std::string page = text_of("docs/protocol.md");
  const std::string code = text_of("daemon/server/protocol/protocol.hpp");
  EXPECT_EQ(all_of(page, "\n\\| (-32\\d+) \\|"), all_of(code, "= (-32\\d+);"));
  const std::string told = page.substr(page.find("## Notifications"), page.find("## Errors") - page.find("## Notifications"));
  EXPECT_EQ(all_of(told, "\n\\| `(\\w+)`"),
            all_of(code.substr(code.find("namespace notification")), "constexpr const char\\* k\\w+ = \"(\\w+)\";\\s+//"));
}

TEST_F(ProtocolTest, TheDocumentedVersionsAndOffsetsOfThePageAreTheCodes) {
  constexpr std::size_t kSample = offsetof(PosePageLayout, sample) + sizeof(std::uint64_t);
#define SLAMD_FIELD(name) {#name, kSample + offsetof(PoseSample, name)}
  const std::map<std::string, std::size_t> in_code{
      {"magic", offsetof(PosePageLayout, magic)},   {"version", offsetof(PosePageLayout, version)},
      {"sample_bytes", offsetof(PosePageLayout, sample_bytes)}, {"starts", offsetof(PosePageLayout, starts)},
      {"reserved", offsetof(PosePageLayout, reserved)}, {"lock", offsetof(PosePageLayout, sample)},
      SLAMD_FIELD(host_time_ns),      SLAMD_FIELD(utc_offset_ns),      SLAMD_FIELD(sequence),
      SLAMD_FIELD(map_position_m),    SLAMD_FIELD(map_rotation_xyzw),  SLAMD_FIELD(odom_position_m),
      SLAMD_FIELD(odom_rotation_xyzw), SLAMD_FIELD(velocity_mps),      SLAMD_FIELD(angular_velocity_rads),
      SLAMD_FIELD(covariance),        SLAMD_FIELD(degenerate_direction), SLAMD_FIELD(status),
      SLAMD_FIELD(reasons),           SLAMD_FIELD(lidar_test_ratio),   SLAMD_FIELD(map_corrections)};
#undef SLAMD_FIELD
  const std::string page = text_of("docs/protocol.md");
  std::map<std::string, std::size_t> documented;
  const std::regex row{"\n\\| (\\d+) \\| [uif]\\d+\\S* \\| `(\\w+)`"};
  for (auto match = std::sregex_iterator{page.begin(), page.end(), row}; match != std::sregex_iterator{}; ++match) {
    documented[(*match)[2]] = std::stoul((*match)[1]);
  }
  EXPECT_EQ(documented, in_code);
  EXPECT_NE(page.find("protocol, version " + std::to_string(protocol::kVersion) + "\n"), std::string::npos);
  EXPECT_NE(page.find("`version`: " + std::to_string(PosePageLayout::kVersion) + " |"), std::string::npos);
  EXPECT_NE(page.find("`sample_bytes`: " + std::to_string(sizeof(PoseSample)) + " |"), std::string::npos);
}

}  // namespace
}  // namespace slamd::test
