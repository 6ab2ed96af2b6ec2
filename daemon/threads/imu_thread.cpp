#include "daemon/threads/imu_thread.hpp"

#include <algorithm>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/threads/clock_health.hpp"

namespace slamd {
void ImuThread::allow_faults() {
  constexpr WireFaultShape kShape{.delay = std::chrono::milliseconds{300}, .period = std::chrono::seconds{1},
                                  .held_reads = 512, .read_bytes = 128};
  faults_ = std::make_unique<SensorFault<ImuValueFault>>(streams_.faults.imu, kShape);
}

ImuThread::ImuThread(const ImuThreadConfig& config, const ImuFrameParser::Config& frames, PosePredictor predictor,
                     Streams& streams, PosePublisher& publisher)
    : config_{config},
      source_{make_imu_source(config.source)},
      parser_{frames},
      predictor_{std::move(predictor)},
      streams_{streams},
      publisher_{publisher} {}

void ImuThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const SourceRead read = source_->read(config_.silence);
    take_posterior();
    if (faults_ == nullptr) {
      take(read.bytes, read.arrival);
    } else {
      faults_->wire.pass(read.bytes, host_now(), [this](auto bytes, HostTime arrival) { take(bytes, arrival); });
    }
    const HostTime now = host_now();
    if (now - last_published_ >= config_.silence) carry_on(now);
    tell();
    passes_.fetch_add(1, std::memory_order_relaxed);
  }
}

void ImuThread::take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING {
  if (!bytes.empty()) now_.last_bytes = arrival;
  if (tap_ != nullptr) tap_->take({.payload = bytes, .arrival = arrival, .source = {}});
  parser_.feed(bytes, arrival, [this](const ImuSample& sample) {
    if (faults_ == nullptr) return take(sample);
    if (const std::optional<ImuSample> failed = faults_->values.apply(sample)) take(*failed);
  });
}

void ImuThread::take(const ImuSample& sample) {
  ++now_.samples;
  streams_.imu.try_push(sample);
  publish(predictor_.add(sample));
  imu_to_page_.record(host_now() - sample.arrival);
  now_.last_arrival = sample.arrival;
}

void ImuThread::take_posterior() SLAMD_NONBLOCKING {
  const Posterior* posterior = streams_.posterior.load();
  if (posterior == nullptr || posterior->snapshot.time == last_posterior_) return;
  last_posterior_ = posterior->snapshot.time;
  predictor_.correct(posterior->snapshot, posterior->state);
}

void ImuThread::carry_on(HostTime now) SLAMD_NONBLOCKING {
  if (last_posterior_ != HostTime{}) publish(predictor_.coast_to(now));
}

void ImuThread::publish(const NavState& state) {
  const MapLink* const link = streams_.map_link.load();
  const MapPlacement::Placed told = placement_.place(state, link != nullptr ? *link : MapLink{});
  publisher_.publish(told.state, told.T_map_odom, streams_.utc_offset_ns.load(std::memory_order_relaxed));
  last_published_ = host_now();
}

void ImuThread::tell() SLAMD_NONBLOCKING {
  now_.parser = parser_.stats();
  now_.source = source_->stats();
  now_.device_open = source_->is_open();
  now_.clock = clock_health(parser_.clock());
  report_.store(now_);
}

}  // namespace slamd
