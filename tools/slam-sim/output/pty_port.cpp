#include "tools/slam-sim/output/pty_port.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace slamd::sim {
namespace {

constexpr int kUnreadLimit = 2048;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

}  // namespace

PtyPort::PtyPort(const std::filesystem::path& link)
    : master_{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)}, link_{link} {
  if (!master_ || ::grantpt(master_.get()) != 0 || ::unlockpt(master_.get()) != 0) fail("pseudo terminal");
  char name[64];
  if (::ptsname_r(master_.get(), name, sizeof name) != 0) fail("pseudo terminal");
  slave_ = FileDescriptor{::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC)};
  termios raw{};
  if (!slave_ || ::tcgetattr(slave_.get(), &raw) != 0) fail(name);
  ::cfmakeraw(&raw);
  if (::tcsetattr(slave_.get(), TCSANOW, &raw) != 0) fail(name);
  std::error_code error;
  if (std::filesystem::is_symlink(link_, error)) std::filesystem::remove(link_, error);
  std::filesystem::create_symlink(name, link_, error);
  if (error) throw std::runtime_error(link_.string() + ": " + error.message());
}

PtyPort::~PtyPort() {
  std::error_code ignored;
  std::filesystem::remove(link_, ignored);
}

bool PtyPort::write(std::span<const std::uint8_t> bytes) {
  int unread = 0;
  const bool stale = ::ioctl(slave_.get(), FIONREAD, &unread) == 0 && unread > kUnreadLimit;
  if (stale) ::tcflush(slave_.get(), TCIFLUSH);
  return ::write(master_.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()) && !stale;
}

std::span<const std::uint8_t> PtyPort::read() {
  const ssize_t size = ::read(master_.get(), received_.data(), received_.size());
  return std::span{received_}.first(size > 0 ? static_cast<std::size_t>(size) : 0);
}

}  // namespace slamd::sim
