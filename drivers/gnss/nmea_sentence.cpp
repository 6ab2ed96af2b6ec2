#include "drivers/gnss/nmea_sentence.hpp"

namespace slamd {
namespace {

constexpr std::size_t kTalkerLength = 2;
constexpr std::size_t kAddressLength = 5;

NmeaType type_of(std::string_view address) {
  if (address.size() != kAddressLength || address.front() == 'P') return NmeaType::kOther;
  const std::string_view name = address.substr(kTalkerLength);
  constexpr std::array<std::string_view, kNmeaTypes> kNames{"GGA", "RMC", "GSA", "GST", "VTG", "ZDA"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<NmeaType>(i);
  }
  return NmeaType::kOther;
}

NmeaSentence split(std::string_view rest) {
  NmeaSentence sentence;
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

}  // namespace

std::optional<NmeaSentence> NmeaTokenizer::take(std::uint8_t byte) {
  const std::optional<std::string_view> line = lines_.take(byte);
  return line ? std::optional{split(*line)} : std::nullopt;
}

}  // namespace slamd
