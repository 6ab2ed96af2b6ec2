#include "drivers/io/serial_source.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/serial_port.hpp>
#include <cerrno>
#include <utility>

namespace slamd {
namespace {

using boost::asio::serial_port;

constexpr Duration kWriteTimeout = std::chrono::seconds{1};

static_assert(std::chrono::steady_clock::is_steady);  // libstdc++: CLOCK_MONOTONIC, nanoseconds
HostTime now() {
  return ReopenTimer::now();
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

enum class Wait : std::uint8_t { kReady, kTimeout, kGone };

/// direction  POLLIN or POLLOUT
Wait wait_ready(int fd, short direction, HostTime deadline) {
  const auto left = std::max(Duration::zero(), deadline - now());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
  const timespec timeout{seconds.count(), (left - seconds).count()};
  pollfd poll_fd{fd, direction, 0};
  const int ready = ppoll(&poll_fd, 1, &timeout, nullptr);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return Wait::kTimeout;
  return ready > 0 && (poll_fd.revents & direction) != 0 ? Wait::kReady : Wait::kGone;
}

}  // namespace

struct SerialSource::Port {
  boost::asio::io_context io;
  serial_port port{io};
  std::array<std::uint8_t, kMaxRead> buffer{};
};

SerialSource::SerialSource(SerialSourceConfig config)
    : config_{std::move(config)}, port_{std::make_unique<Port>()}, reopen_{config_.reopen} {}
SerialSource::SerialSource(SerialSource&&) noexcept = default;
SerialSource& SerialSource::operator=(SerialSource&&) noexcept = default;
SerialSource::~SerialSource() = default;

bool SerialSource::is_open() const {
  return port_->port.is_open();
}

SourceRead SerialSource::read(Duration timeout) {
  const HostTime deadline = now() + timeout;
  if (!is_open() && !open()) {
    reopen_.wait(deadline);
    return {};
  }
  const int fd = port_->port.native_handle();
  const Wait wait = wait_ready(fd, POLLIN, deadline);
  if (wait == Wait::kTimeout) return {};
  const ssize_t size = wait == Wait::kReady ? ::read(fd, port_->buffer.data(), port_->buffer.size()) : -1;
  const HostTime arrival = now();
  if (size > 0) {
    stats_.bytes += static_cast<std::uint64_t>(size);
    return {{port_->buffer.data(), static_cast<std::size_t>(size)}, arrival};
  }
  const bool try_again = wait == Wait::kReady && size < 0 && (errno == EAGAIN || errno == EINTR);
  if (!try_again) lose();
  return {};
}

bool SerialSource::write(std::span<const std::uint8_t> bytes) {
  const HostTime deadline = now() + kWriteTimeout;
  while (is_open() && !bytes.empty()) {
    const int fd = port_->port.native_handle();
    if (wait_ready(fd, POLLOUT, deadline) != Wait::kReady) return false;
    const ssize_t size = ::write(fd, bytes.data(), bytes.size());
    if (size < 0 && errno != EAGAIN && errno != EINTR) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(0, size)));
  }
  return is_open();
}

/// Not before it is due. Bytes that waited in the port since before are dropped: their arrival is not known.
bool SerialSource::open() {
  if (!reopen_.is_due()) return false;
  boost::system::error_code error;
  port_->port.open(config_.path, error);
  if (!error && configure(port_->port, config_.baud)) {
    const int dtr = TIOCM_DTR;
    if (!config_.raise_dtr) ::ioctl(port_->port.native_handle(), TIOCMBIC, &dtr);  // pseudo terminals have no such line
    tcflush(port_->port.native_handle(), TCIFLUSH);
    ++stats_.openings;
    reopen_.succeeded();
    return true;
  }
  boost::system::error_code ignored;
  port_->port.close(ignored);
  ++stats_.failed_openings;
  reopen_.failed();
  return false;
}

void SerialSource::lose() {
  boost::system::error_code ignored;
  port_->port.close(ignored);
  ++stats_.losses;
  reopen_.lost();
}

}  // namespace slamd
