#include "tools/slam-replay/drive/table_streams.hpp"

#include "tools/slam-replay/drive/wire_streams.hpp"

namespace slamd::replay {

void tell(const ImuCsvReader& reader, StreamReport& report) {
  const ImuCsvReader::Stats& stats = reader.stats();
  report.missing = reader.clock().missing();
  report.clock_jumps = reader.clock().jumps();
  report.rejections.push_back({"imu", "bad_lines", stats.bad_lines});
  report.rejections.push_back({"imu", "out_of_range", stats.out_of_range});
  report.rejections.push_back({"imu", "backward", stats.backward});
}

void tell(const GpsCsvReader& reader, StreamReport& report) {
  tell(reader.parser(), report);
  report.rejections.push_back({"gps", "bad_lines", reader.bad_lines().count});
}

void tell(const WheelCsvReader& reader, StreamReport& report) {
  tell(reader.parser(), report);
  report.rejections.push_back({"wheel", "bad_lines", reader.bad_lines().count});
}

void tell(const ScanCsvReader& reader, StreamReport& report) {
  report.rejections.push_back({"laser", "bad_lines", reader.bad_lines().count});
}

}  // namespace slamd::replay
