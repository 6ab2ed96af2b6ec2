#include "drivers/gnss/nmea_sentence.hpp"

namespace slamd {
namespace {

constexpr std::size_t kTalkerLength = 2;
constexpr std::size_t kAddressLength = 5;

std::optional<std::uint8_t> hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<std::uint8_t>(c - 'A' + 10);
  if (c >= 'a' && c <= 'f') return static_cast<std::uint8_t>(c - 'a' + 10);
  return std::nullopt;
}

NmeaType type_of(std::string_view address) {
  if (address.size() != kAddressLength || address.front() == 'P') return NmeaType::kOther;
  const std::string_view name = address.substr(kTalkerLength);
  constexpr std::array<std::string_view, kNmeaTypes> kNames{"GGA", "RMC", "GSA", "GST", "VTG", "ZDA"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<NmeaType>(i);
  }
  return NmeaType::kOther;
}

}  // namespace

std::optional<NmeaSentence> NmeaTokenizer::take(std::uint8_t byte) {
  if (byte == '$' || byte == '!') {
    if (state_ != State::kOutside) abandon(&NmeaSentenceStats::broken);
    state_ = State::kBody;
    length_ = 0;
    sum_ = 0;
    return std::nullopt;
  }
  switch (state_) {
    case State::kOutside:
      if (byte != '\r' && byte != '\n') ++stats_.ignored_bytes;
      return std::nullopt;
    case State::kBody:
      take_body(byte);
      return std::nullopt;
    case State::kChecksumHigh:
    case State::kChecksumLow:
      return finish(byte);
  }
  return std::nullopt;
}

void NmeaTokenizer::take_body(std::uint8_t byte) {
  if (byte == '*') {
    state_ = State::kChecksumHigh;
  } else if (byte == '\r' || byte == '\n') {
    abandon(&NmeaSentenceStats::no_checksum);
  } else if (byte < 0x20 || byte > 0x7E) {
    abandon(&NmeaSentenceStats::broken);
  } else if (length_ == kMaxLength) {
    abandon(&NmeaSentenceStats::too_long);
  } else {
    body_[length_++] = static_cast<char>(byte);
    sum_ ^= byte;
  }
}

std::optional<NmeaSentence> NmeaTokenizer::finish(std::uint8_t byte) {
  const std::optional<std::uint8_t> digit = hex_digit(byte);
  if (!digit) {
    abandon(&NmeaSentenceStats::no_checksum);
    return std::nullopt;
  }
  if (state_ == State::kChecksumHigh) {
    expected_ = static_cast<std::uint8_t>(*digit << 4U);
    state_ = State::kChecksumLow;
    return std::nullopt;
  }
  state_ = State::kOutside;
  if ((expected_ | *digit) != sum_) {
    ++stats_.bad_checksum;
    return std::nullopt;
  }
  ++stats_.sentences;
  return split();
}

NmeaSentence NmeaTokenizer::split() const {
  NmeaSentence sentence;
  std::string_view rest{body_.data(), length_};
  const std::string_view address = rest.substr(0, rest.find(','));
  sentence.type = type_of(address);
  sentence.talker = address.substr(0, kTalkerLength);
  rest.remove_prefix(address.size());
  while (!rest.empty() && sentence.count < NmeaSentence::kMaxFields) {
    rest.remove_prefix(1);  // the comma
    const std::string_view field = rest.substr(0, rest.find(','));
    sentence.fields[sentence.count++] = field;
    rest.remove_prefix(field.size());
  }
  return sentence;
}

void NmeaTokenizer::abandon(std::uint64_t NmeaSentenceStats::*cause) {
  ++(stats_.*cause);
  state_ = State::kOutside;
}

}  // namespace slamd
