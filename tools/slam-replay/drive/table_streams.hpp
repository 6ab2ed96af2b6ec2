#pragma once
// The tables of a drive folder (imu.csv, gps.csv, wheel.csv, scan.csv) as streams. It is not for recorded bytes: those are in wire_streams.hpp.

#include <fstream>
#include <optional>
#include <string>

#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_csv_reader.hpp"
#include "drivers/wheel/wheel_parser.hpp"
#include "tools/slam-replay/drive/scan_csv_reader.hpp"
#include "tools/slam-replay/drive/sentence_csv_reader.hpp"
#include "tools/slam-replay/drive/stream.hpp"

namespace slamd::replay {

/// Reader: one over a std::istream with next(), which gives an optional Item. tell(reader, report) is found for it.
template <class Reader, class Item>
class TableStream : public Stream<Item> {
 public:
  /// The file must be there.
  template <class... Config>
  explicit TableStream(const std::string& path, const Config&... config) : path_{path}, file_{path}, reader_{file_, config...} {
    file_.seekg(0, std::ios::end);
    bytes_ = file_.tellg();
    file_.seekg(0);
  }

  const Item* next() override {
    item_ = reader_.next();
    given_ += item_ ? 1 : 0;
    return item_ ? &*item_ : nullptr;
  }
  StreamReport report() const override {
    StreamReport report;
    report.items = given_;
    tell(reader_, report);
    if constexpr (requires { reader_.bad_lines(); }) {
      if (reader_.bad_lines().count > 0) report.complaint = reader_.bad_lines().text(path_);
    }
    return report;
  }
  double progress() const override {
    const std::streamoff at = file_.good() ? std::streamoff{file_.tellg()} : bytes_;
    return bytes_ > 0 ? static_cast<double>(at) / static_cast<double>(bytes_) : 0.0;
  }

 private:
  std::string path_;
  mutable std::ifstream file_;
  Reader reader_;
  std::optional<Item> item_;
  std::streamoff bytes_ = 0;
  std::uint64_t given_ = 0;
};

using GpsCsvReader = SentenceCsvReader<NmeaParser, GnssFix>;
using WheelCsvReader = SentenceCsvReader<WheelParser, WheelOdometry>;

void tell(const ImuCsvReader& reader, StreamReport& report);
void tell(const GpsCsvReader& reader, StreamReport& report);
void tell(const WheelCsvReader& reader, StreamReport& report);
void tell(const ScanCsvReader& reader, StreamReport& report);

using ImuTableStream = TableStream<ImuCsvReader, ImuSample>;
using GpsTableStream = TableStream<GpsCsvReader, GnssFix>;
using WheelTableStream = TableStream<WheelCsvReader, WheelOdometry>;
using ScanTableStream = TableStream<ScanCsvReader, LaserScan>;

}  // namespace slamd::replay
