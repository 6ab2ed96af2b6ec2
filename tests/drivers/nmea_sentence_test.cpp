#include "drivers/gnss/nmea_sentence.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/drivers/nmea_text.hpp"

namespace slamd {
namespace {

/// "type talker field|field" of each sentence found.
std::vector<std::string> sentences(NmeaTokenizer& tokenizer, std::string_view text) {
  std::vector<std::string> found;
  for (const char c : text) {
    const auto sentence = tokenizer.take(static_cast<std::uint8_t>(c));
    if (!sentence) continue;
    std::string line = std::to_string(static_cast<int>(sentence->type)) + std::string{sentence->talker};
    for (std::size_t i = 0; i < sentence->count; ++i) line += "|" + std::string{sentence->field(i)};
    found.push_back(line);
  }
  return found;
}

TEST(NmeaTokenizer, SplitsFieldsAndKnowsTypesOfAnyTalker) {
  NmeaTokenizer tokenizer;
  const std::string text = test::sentence("GPGGA,1,,3") + test::sentence("GNRMC,a") + test::sentence("GLGSA,") +
                           test::sentence("GAGST") + test::sentence("GBVTG,x,y") + test::sentence("BDZDA,0") +
                           test::sentence("GPGSV,1") + test::sentence("PGRMC,1");
  EXPECT_EQ(sentences(tokenizer, text),
            (std::vector<std::string>{"0GP|1||3", "1GN|a", "2GL|", "3GA", "4GB|x|y", "5BD|0", "6GP|1", "6PG|1"}));
  EXPECT_EQ(tokenizer.stats().sentences, 8U);
}

TEST(NmeaTokenizer, CountsWhatItDropsByCause) {
  NmeaTokenizer tokenizer;
  const std::string long_line = "$GPGGA," + std::string(CheckedLineReader::kMaxLength, '1');
  const std::string text =
      "noise$GPGGA,1*00\r\n"                       // checksum
      "$GPGGA,1\r\n$GPGGA,1*G0\r\n$GPGGA,1*4\r\n"  // none
      "$GPG\x01GA\r\n$GPGG" +
      test::sentence("GPGGA,ok") + long_line + "\r\n";
  EXPECT_EQ(sentences(tokenizer, text), (std::vector<std::string>{"0GP|ok"}));
  EXPECT_EQ(tokenizer.stats().bad_checksum, 1U);
  EXPECT_EQ(tokenizer.stats().no_checksum, 3U);
  EXPECT_EQ(tokenizer.stats().broken, 2U);
  EXPECT_EQ(tokenizer.stats().too_long, 1U);
  EXPECT_GE(tokenizer.stats().ignored_bytes, 5U);
}

TEST(NmeaTokenizer, FindsMergedSentencesWithoutLineEnds) {
  NmeaTokenizer tokenizer;
  std::string text = test::sentence("GPGGA,1") + test::sentence("GPRMC,2");
  std::erase(text, '\r');
  std::erase(text, '\n');
  EXPECT_EQ(sentences(tokenizer, text).size(), 2U);
}

TEST(NmeaTokenizer, KeepsMoreFieldsThanAnySentenceHasWithinItsLimit) {
  NmeaTokenizer tokenizer;
  const std::string text = test::sentence("GPGGA" + std::string(100, ','));
  ASSERT_EQ(sentences(tokenizer, text).size(), 1U);
}

}  // namespace
}  // namespace slamd
