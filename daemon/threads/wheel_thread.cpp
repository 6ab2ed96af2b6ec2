#include "daemon/threads/wheel_thread.hpp"

#include <algorithm>
#include <string>

#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{3};  // for pushed readings: an event may wait in a thread for 5 ms

}  // namespace

WheelThread::WheelThread(const WheelThreadConfig& config, Streams& streams)
    : source_{config.serial}, has_port_{!config.serial.path.empty()}, parser_{config.track}, streams_{streams} {}

/// As the line of the serial port that says the same: there is one way in, and one form in a recording.
bool WheelThread::push(const WheelReading& reading, HostTime arrival) {
  const std::string line = is_possible(reading) ? wheel_line(reading) : "";
  Pushed* const slot = line.empty() || line.size() > sizeof(Pushed::line) ? nullptr : pushed_.claim();
  if (slot == nullptr) return false;
  std::copy(line.begin(), line.end(), slot->line.begin());
  slot->size = line.size();
  slot->arrival = arrival;
  pushed_.commit();
  return true;
}

void WheelThread::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (has_port_) {
      const SourceRead read = source_.read(kLook);
      take(read.bytes, read.arrival);
    } else {
      pause_for(kLook);
    }
    for (; const Pushed* reading = pushed_.front(); pushed_.pop()) {
      ++now_.pushed;
      take({reinterpret_cast<const std::uint8_t*>(reading->line.data()), reading->size}, reading->arrival);
    }
    tell();
  }
}

void WheelThread::take(std::span<const std::uint8_t> bytes, HostTime arrival) SLAMD_NONBLOCKING {
  if (bytes.empty()) return;
  if (tap_ != nullptr) tap_->take({.payload = bytes, .arrival = arrival, .source = {}});
  parser_.feed(bytes, arrival, [this](const WheelOdometry& odometry) {
    ++now_.odometries;
    now_.last_arrival = odometry.arrival;
    streams_.wheel.try_push(odometry);
  });
}

void WheelThread::tell() {
  now_.parser = parser_.stats();
  now_.lines = parser_.line_stats();
  now_.track = parser_.track_stats();
  now_.serial = source_.stats();
  now_.device_open = source_.is_open();
  report_.store(now_);
}

}  // namespace slamd
