#include "drivers/imu/imu_csv_reader.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "drivers/imu/imu_scale.hpp"
#include "drivers/io/host_ns.hpp"

namespace slamd {
namespace {

constexpr std::size_t kColumns = 8;
constexpr std::size_t kColumnsWithoutTemperature = 7;
constexpr Duration kHostJump{1'000'000'000};  // a backward step beyond is a jump of the host's clock, not disorder

/// Splits at commas; returns the number of columns, kColumns + 1 when there are more.
std::size_t split(std::string_view line, std::array<std::string_view, kColumns>& columns) {
  std::size_t count = 0;
  while (true) {
    const std::size_t comma = line.find(',');
    if (count == kColumns) return kColumns + 1;
    columns[count++] = line.substr(0, comma);
    if (comma == std::string_view::npos) return count;
    line.remove_prefix(comma + 1);
  }
}

template <class Number>
bool parse_number(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::optional<ImuSample> ImuCsvReader::next() {
  if (!started_) prime();
  std::optional<ImuSample> sample;
  if (primed_given_ < primed_.size()) {
    sample = primed_[primed_given_++];
  } else if (ahead_) {
    sample = advance();
  } else {
    return std::nullopt;
  }
  ++stats_.samples;
  stats_.clipped += sample->clipped ? 1 : 0;
  return sample;
}

/// Lets the clock see the first samples and then stamps them all with what it has learnt.
void ImuCsvReader::prime() {
  started_ = true;
  ahead_ = read_line();
  std::vector<std::int64_t> indices;
  while (ahead_ && primed_.size() < kPrimeSamples && clock_.jumps() == 0) {
    primed_.push_back(advance());
    indices.push_back(clock_.index());
  }
  if (clock_.jumps() > 0) return;
  for (std::size_t i = 0; i < primed_.size(); ++i) primed_[i].time = clock_.time_of(indices[i]);
}

/// Gives the line ahead to the clock, with the arrival of the one that follows.
ImuSample ImuCsvReader::advance() {
  ImuSample sample = *ahead_;
  ahead_ = read_line();
  sample.time = clock_.update(sample.arrival, ahead_ ? std::optional{ahead_->arrival} : std::nullopt);
  return sample;
}

std::optional<ImuSample> ImuCsvReader::read_line() {
  while (std::getline(lines_, line_)) {
    std::string_view line{line_};
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with("t_ns")) continue;
    if (std::optional<ImuSample> sample = parse(line)) return sample;
  }
  return std::nullopt;
}

std::optional<ImuSample> ImuCsvReader::parse(std::string_view line) {
  std::array<std::string_view, kColumns> columns;
  const std::size_t count = split(line, columns);
  std::int64_t t_ns = 0;
  std::array<double, kColumns - 1> values{};
  bool good = (count == kColumns || count == kColumnsWithoutTemperature) && parse_number(columns[0], t_ns) &&
              is_host_ns(t_ns);
  for (std::size_t i = 1; good && i < count; ++i) {
    good = parse_number(columns[i], values[i - 1]) && std::isfinite(values[i - 1]);
  }
  if (!good) {
    ++stats_.bad_lines;
    return std::nullopt;
  }

  ImuSample sample;
  sample.arrival = from_ns<HostTime>(t_ns);
  sample.gyro_rads = {values[0], values[1], values[2]};
  sample.accel_mps2 = {values[3], values[4], values[5]};
  sample.temperature_c = static_cast<float>(values[6]);
  const double gyro_max = sample.gyro_rads.cwiseAbs().maxCoeff();
  const double accel_max = sample.accel_mps2.cwiseAbs().maxCoeff();
  if (gyro_max > kGyroImpossibleRads || accel_max > kAccelImpossibleMps2) {
    ++stats_.out_of_range;
    return std::nullopt;
  }
  if (newest_arrival_ && sample.arrival < *newest_arrival_ && *newest_arrival_ - sample.arrival < kHostJump) {
    ++stats_.backward;
    return std::nullopt;
  }
  newest_arrival_ = sample.arrival;
  sample.clipped = gyro_max >= kGyroClipRads || accel_max >= kAccelClipMps2;
  return sample;
}

}  // namespace slamd
