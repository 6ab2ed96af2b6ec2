#include "tools/slam-replay/drive/drive.hpp"

#include <algorithm>
#include <utility>

namespace slamd::replay {

Drive::Drive(Sensors sensors, const EventMergeConfig& merge) : sensors_{std::move(sensors)}, config_{merge}, merge_{merge} {}

template <class Item>
void Drive::Head<Item>::refill(Stream<Item>* stream) {
  if (!taken || ended) return;
  item = stream == nullptr ? nullptr : stream->next();
  taken = item == nullptr;
  ended = item == nullptr;
}

template <class Item>
std::optional<HostTime> Drive::Head<Item>::arrival() const {
  if (taken) return std::nullopt;
  return item->arrival;
}

template <class Item>
const Item* Drive::Head<Item>::take() {
  taken = true;
  return item;
}

double Drive::scan_share(HostTime scan_end) const {
  const auto found = sensors_.scan_shares.find(scan_end);
  return found == sensors_.scan_shares.end() ? 1.0 : found->second;
}

Event Drive::next() {
  packet_.refill(sensors_.lidar.get());
  sample_.refill(sensors_.imu.get());
  fix_.refill(sensors_.gnss.get());
  wheel_.refill(sensors_.wheel.get());
  laser_.refill(sensors_.laser.get());
  const EventHeads heads{sample_.arrival(), packet_.arrival(), fix_.arrival(), wheel_.arrival(), laser_.arrival()};
  HostTime oldest = HostTime::max();
  for (const auto& arrival : {heads.imu, heads.lidar, heads.gnss, heads.wheel, heads.laser}) {
    oldest = std::min(oldest, arrival.value_or(HostTime::max()));
  }
  if (oldest == HostTime::max()) return std::monostate{};
  const NextEvent event = merge_.next(heads, oldest + config_.hold_back);
  switch (event.kind) {
    case NextEvent::Kind::kLidar: return packet_.take();
    case NextEvent::Kind::kImu: return sample_.take();
    case NextEvent::Kind::kGnss: return fix_.take();
    case NextEvent::Kind::kWheel: return wheel_.take();
    case NextEvent::Kind::kLaser: return laser_.take();
    case NextEvent::Kind::kSilence:
    case NextEvent::Kind::kNone: break;
  }
  return Silence{event.time};
}

double Drive::progress() const {
  if (sensors_.lidar) return sensors_.lidar->progress();
  if (sensors_.laser) return sensors_.laser->progress();
  return sensors_.imu ? sensors_.imu->progress() : 0.0;
}

}  // namespace slamd::replay
