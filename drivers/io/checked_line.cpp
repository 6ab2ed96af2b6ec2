#include "drivers/io/checked_line.hpp"

namespace slamd {
namespace {

std::optional<std::uint8_t> hex_digit(std::uint8_t c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  if (c >= 'A' && c <= 'F') return static_cast<std::uint8_t>(c - 'A' + 10);
  if (c >= 'a' && c <= 'f') return static_cast<std::uint8_t>(c - 'a' + 10);
  return std::nullopt;
}

}  // namespace

std::optional<std::string_view> CheckedLineReader::take(std::uint8_t byte) {
  if (byte == '$' || byte == '!') {
    if (state_ != State::kOutside) abandon(&CheckedLineStats::broken);
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

void CheckedLineReader::take_body(std::uint8_t byte) {
  if (byte == '*') {
    state_ = State::kChecksumHigh;
  } else if (byte == '\r' || byte == '\n') {
    abandon(&CheckedLineStats::no_checksum);
  } else if (byte < 0x20 || byte > 0x7E) {
    abandon(&CheckedLineStats::broken);
  } else if (length_ == kMaxLength) {
    abandon(&CheckedLineStats::too_long);
  } else {
    body_[length_++] = static_cast<char>(byte);
    sum_ ^= byte;
  }
}

std::optional<std::string_view> CheckedLineReader::finish(std::uint8_t byte) {
  const std::optional<std::uint8_t> digit = hex_digit(byte);
  if (!digit) {
    abandon(&CheckedLineStats::no_checksum);
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
  return std::string_view{body_.data(), length_};
}

void CheckedLineReader::abandon(std::uint64_t CheckedLineStats::*cause) {
  ++(stats_.*cause);
  state_ = State::kOutside;
}

}  // namespace slamd
