#include "drivers/io/serial_source.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <cerrno>
#include <thread>
#include <utility>

namespace slamd {
namespace {

using boost::asio::serial_port;

static_assert(std::chrono::steady_clock::is_steady);  // libstdc++: CLOCK_MONOTONIC, nanoseconds
HostTime now() {
  return HostTime{std::chrono::steady_clock::now().time_since_epoch()};
}

bool configure(serial_port& port, std::uint32_t baud) {
  boost::system::error_code error;
  const auto set = [&](const auto& option) {
    if (!error) port.set_option(option, error);
  };
  set(serial_port::baud_rate{baud});
  set(serial_port::character_size{8});
  set(serial_port::parity{serial_port::parity::none});
  set(serial_port::stop_bits{serial_port::stop_bits::one});
  set(serial_port::flow_control{serial_port::flow_control::none});
  return !error;
}

enum class Wait : std::uint8_t { kReadable, kTimeout, kGone };

Wait wait_readable(int fd, HostTime deadline) {
  const auto left = std::max(Duration::zero(), deadline - now());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  const timespec timeout{seconds.count(), (left - seconds).count()};
  pollfd poll_fd{fd, POLLIN, 0};
  const int ready = ppoll(&poll_fd, 1, &timeout, nullptr);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return Wait::kTimeout;
  return ready > 0 && (poll_fd.revents & POLLIN) != 0 ? Wait::kReadable : Wait::kGone;
}

}  // namespace

struct SerialSource::Port {
  boost::asio::io_context io;
  serial_port port{io};
  std::array<std::uint8_t, kMaxRead> buffer{};
};

SerialSource::SerialSource(SerialSourceConfig config) : config_{std::move(config)}, port_{std::make_unique<Port>()} {}
SerialSource::SerialSource(SerialSource&&) noexcept = default;
SerialSource& SerialSource::operator=(SerialSource&&) noexcept = default;
SerialSource::~SerialSource() = default;

bool SerialSource::is_open() const {
  return port_->port.is_open();
}

SerialRead SerialSource::read(Duration timeout) {
  const HostTime deadline = now() + timeout;
  if (!is_open() && !open()) {
    wait_to_reopen(deadline);
    return {};
  }
  const int fd = port_->port.native_handle();
  const Wait wait = wait_readable(fd, deadline);
  if (wait == Wait::kTimeout) return {};
  const ssize_t size = wait == Wait::kReadable ? ::read(fd, port_->buffer.data(), port_->buffer.size()) : -1;
  const HostTime arrival = now();
  if (size > 0) {
    stats_.bytes += static_cast<std::uint64_t>(size);
    return {{port_->buffer.data(), static_cast<std::size_t>(size)}, arrival};
  }
  const bool try_again = wait == Wait::kReadable && size < 0 && (errno == EAGAIN || errno == EINTR);
  if (!try_again) lose();
  return {};
}

/// Not before next_opening_. Bytes that waited in the port since before are dropped: their arrival is not known.
bool SerialSource::open() {
  if (now() < next_opening_) return false;
  boost::system::error_code error;
  port_->port.open(config_.path, error);
  if (!error && configure(port_->port, config_.baud)) {
    tcflush(port_->port.native_handle(), TCIFLUSH);
    ++stats_.openings;
    backoff_ = Duration::zero();
    return true;
  }
  boost::system::error_code ignored;
  port_->port.close(ignored);
  ++stats_.failed_openings;
  backoff_ = std::clamp(2 * backoff_, config_.reopen_min, config_.reopen_max);
  next_opening_ = now() + backoff_;
  return false;
}

void SerialSource::lose() {
  boost::system::error_code ignored;
  port_->port.close(ignored);
  ++stats_.losses;
  next_opening_ = now() + config_.reopen_min;
}

void SerialSource::wait_to_reopen(HostTime deadline) {
  const Duration left = std::min(deadline, next_opening_) - now();
  if (left > Duration::zero()) std::this_thread::sleep_for(left);
}

}  // namespace slamd
