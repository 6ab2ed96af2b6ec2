#include "tools/slam-replay/report_parts.hpp"

namespace slamd::replay {

Json milliseconds(const Histogram& histogram) {
  const Percentiles p = histogram.percentiles();
  const auto ms = [](Duration d) { return to_seconds(d) * 1e3; };
  return {{"p50", ms(p.p50)}, {"p90", ms(p.p90)}, {"p99", ms(p.p99)}, {"p999", ms(p.p999)}, {"max", ms(p.max)}};
}

namespace {

Json names_of(std::uint32_t reasons) {
  Json names = Json::array();
  for (std::uint32_t i = 0; i < 32; ++i) {
    if ((reasons >> i & 1U) != 0) names.push_back(name(static_cast<StatusReason>(1U << i)));
  }
  return names;
}

}  // namespace

Json status_line(const std::vector<StatusChange>& changes) {
  Json line = Json::array();
  for (const StatusChange& change : changes) {
    line.push_back({{"t_s", to_seconds(change.time.time_since_epoch())},
                    {"status", name(change.status)},
                    {"reasons", names_of(change.reasons)}});
  }
  return line;
}

Json stream_rejections(const Sensors& sensors) {
  Json out;
  const auto add = [&out](const auto& stream) {
    if (!stream) return;
    for (const StreamReport::Rejection& r : stream->report().rejections) {
      Json& count = out[r.group][r.cause];
      count = (count.is_null() ? 0 : count.template get<std::uint64_t>()) + r.count;
    }
  };
  add(sensors.lidar);
  add(sensors.imu);
  add(sensors.gnss);
  add(sensors.wheel);
  add(sensors.laser);
  return out;
}

}  // namespace slamd::replay
