// Any bytes as what a daemon sends to a client: its handshake, an answer, notifications. Every call of the client ends with a value
// or with a failure of its own, whatever came.

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <semaphore>
#include <string>
#include <string_view>
#include <thread>

#include "tools/client/session.hpp"

namespace {

using namespace slamd;
using namespace slamd::client;
using namespace std::chrono_literals;

constexpr std::string_view kHandshake = R"({"jsonrpc":"2.0","id":1,"result":{"protocol":1}})"
                                        "\n";

void require(bool holds) {
  if (!holds) std::abort();
}

/// Sends what it is given to whoever connects, and hangs up.
class Daemon {
 public:
  Daemon() : path_{std::filesystem::temp_directory_path() / ("fuzz_client." + std::to_string(::getpid()))} {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    ::unlink(path_.c_str());
    require(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    require(::listen(listener_.get(), 1) == 0);
    std::thread{[this] { serve(); }}.detach();
  }
  const std::string& path() const { return path_; }

  /// To the next who connects.
  void say(std::string bytes) {
    bytes_ = std::move(bytes);
    ready_.release();
  }
  /// Until whom it was said to has gone.
  void await_end() { ended_.acquire(); }

 private:
  void serve() {
    while (true) {
      ready_.acquire();
      const UniqueFd client{::accept(listener_.get(), nullptr, nullptr)};
      [[maybe_unused]] const ssize_t sent = ::send(client.get(), bytes_.data(), bytes_.size(), MSG_NOSIGNAL);
      ::shutdown(client.get(), SHUT_WR);
      for (char rest[256]; ::read(client.get(), rest, sizeof rest) > 0;) {
      }
      ended_.release();
    }
  }

  std::string path_;
  UniqueFd listener_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  std::string bytes_;
  std::binary_semaphore ready_{0}, ended_{0};
};

template <class Call>
bool ends(Call call) {
  try {
    call();
    return true;
  } catch (const Failure&) {
    return false;
  } catch (const nlohmann::json::exception&) {  // the C interface's guard makes SLAMD_PROTOCOL of it
    return false;
  }
}

void talk(Daemon& daemon, std::string bytes) {
  daemon.say(std::move(bytes));
  ends([&daemon] {
    Session session{daemon.path(), 1s};
    ends([&session] { session.call("get_pose", {}, [](const nlohmann::json&) {}); });
    while (ends([&session] { pose_of(session.next()["params"]); })) {
    }
  });
  daemon.await_end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static Daemon& daemon = *new Daemon;  // lives as long as its thread
  const std::string said{reinterpret_cast<const char*>(bytes), size};
  if (size > 60'000) return 0;  // fits into the socket: nobody waits for the other
  talk(daemon, said);
  talk(daemon, std::string{kHandshake} + said);
  return 0;
}
