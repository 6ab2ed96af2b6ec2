#include "daemon/server/server.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>
#include <exception>
#include <optional>
#include <thread>
#include <unordered_set>
#include <utility>

#include "daemon/server/grid_job.hpp"
#include "daemon/server/host_clock.hpp"
#include "daemon/server/listening_socket.hpp"
#include "daemon/server/peer.hpp"
#include "daemon/server/pose_json.hpp"
#include "daemon/server/protocol/protocol.hpp"
#include "daemon/server/session.hpp"

namespace slamd {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using asio::local::stream_protocol;

constexpr Duration kTick = std::chrono::milliseconds{250};
constexpr std::uint64_t kTicksPerSample = 4;
constexpr int kBacklog = 128;

/// Threads made while it lives take no signals: those belong to the main thread.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

class Server::Impl {
 public:
  Impl(ServerConfig config, ServerSources sources, std::string version)
      : config_{std::move(config)},
        sources_{sources},
        methods_{config_, sources_, std::move(version), [this] { return counts_.to_json(); }} {}

  Result<void> start(UniqueFd listening);
  void reconfigure(const ServerConfig& config);
  void stop();

  std::atomic<std::uint64_t> heartbeats{0};
  std::atomic<std::size_t> clients{0};

 private:
  void run();
  void accept();
  void admit(stream_protocol::socket socket);
  void remove(std::shared_ptr<Session> session);
  void await_pose();
  void publish_pose(const PoseSample& sample);
  void await_tick();
  void tick(HostTime now);
  void publish_status(HostTime now);
  void publish_grid(HostTime now);

  ServerConfig config_;
  std::optional<gid_t> control_group_;  // none: every client controls
  ServerSources sources_;
  ServerCounts counts_;
  Methods methods_;
  asio::io_context io_{1};
  std::optional<ListeningSocket> listening_;
  stream_protocol::acceptor acceptor_{io_};
  asio::posix::stream_descriptor wake_{io_};
  asio::steady_timer timer_{io_};
  JobRunner jobs_{io_, config_.limits.max_jobs};
  Session::Context context_{methods_, jobs_, config_.limits, counts_,
                            [this](std::shared_ptr<Session> session) { remove(std::move(session)); }};
  std::unordered_set<std::shared_ptr<Session>> sessions_;
  bool accepting_ = false;
  std::pair<std::uint32_t, std::uint32_t> told_status_{0, 0};  // status and reasons of the newest pose
  std::thread thread_;
};

Result<void> Server::Impl::start(UniqueFd handed_over) {
  if (!config_.control_group.empty()) {
    const Result<gid_t> group = group_named(config_.control_group);
    if (!group) return Error{group.reason()};
    control_group_ = *group;
  }
  Result<ListeningSocket> listening = handed_over ? ListeningSocket::adopt(std::move(handed_over))
                                                  : ListeningSocket::open(config_.socket_path, kBacklog);
  if (!listening) return Error{listening.reason()};
  listening_.emplace(std::move(listening).value());
  try {
    acceptor_.assign(stream_protocol{}, ::fcntl(listening_->fd(), F_DUPFD_CLOEXEC, 0));
    wake_.assign(::fcntl(sources_.pose.wake_fd(), F_DUPFD_CLOEXEC, 0));
    accept();
    await_pose();
    await_tick();
    thread_ = std::thread{[this] { run(); }};
  } catch (const std::exception&) {
    listening_.reset();
    return Error{"the server's thread cannot be started"};
  }
  return {};
}

void Server::Impl::run() {
  pthread_setname_np(pthread_self(), "slamd-server");
  while (true) {
    try {
      io_.run();
      return;
    } catch (const std::exception&) {  // of one handler, for want of memory: the others go on
      ++counts_.internal_errors;
    }
  }
}

void Server::Impl::reconfigure(const ServerConfig& config) {
  asio::post(io_, [this, config] {
    config_.save_dir = config.save_dir;
    config_.limits = config.limits;
  });
}

void Server::Impl::stop() {
  if (!thread_.joinable()) return;
  jobs_.stop();
  asio::post(io_, [this] {
    error_code ignored;
    acceptor_.close(ignored);
    for (const std::shared_ptr<Session>& session : sessions_) session->close();
    io_.stop();
  });
  thread_.join();
  listening_.reset();
}

void Server::Impl::accept() {
  accepting_ = true;
  acceptor_.async_accept([this](error_code failure, stream_protocol::socket socket) {
    accepting_ = false;
    if (failure) return;  // no more descriptors: the next tick tries again
    admit(std::move(socket));
    accept();
  });
}

void Server::Impl::admit(stream_protocol::socket socket) {
  error_code ignored;
  socket.non_blocking(true, ignored);
  if (sessions_.size() >= config_.limits.max_clients) {
    ++counts_.refused_clients;
    Outbox refusal;
    refusal.push(std::make_shared<std::string>(error_line(nullptr, {protocol::error::kBusy, "too many clients"})));
    refusal.flush(socket.native_handle());
    return;
  }
  ++counts_.accepted;
  const bool controls = !control_group_ || may_control(peer_of(socket.native_handle()), *control_group_, ::geteuid());
  const Right right = controls ? Right::kControl : Right::kRead;
  auto session = std::make_shared<Session>(std::move(socket), right, context_);
  sessions_.insert(session);
  counts_.clients = sessions_.size();
  clients.store(sessions_.size(), std::memory_order_relaxed);
  session->start();
}

/// Later, because somebody may be going through sessions_ just now.
void Server::Impl::remove(std::shared_ptr<Session> session) {
  asio::post(io_, [this, session = std::move(session)] {
    sessions_.erase(session);
    counts_.clients = sessions_.size();
    clients.store(sessions_.size(), std::memory_order_relaxed);
  });
}

void Server::Impl::await_pose() {
  wake_.async_wait(asio::posix::stream_descriptor::wait_read, [this](error_code failure) {
    if (failure) return;
    std::uint64_t wakes = 0;
    [[maybe_unused]] const ssize_t count = ::read(wake_.native_handle(), &wakes, sizeof wakes);
    if (const std::optional<PoseSample> sample = sources_.pose.newest()) publish_pose(*sample);
    await_pose();
  });
}

void Server::Impl::publish_pose(const PoseSample& sample) {
  const HostTime time = from_ns<HostTime>(sample.host_time_ns);
  Outbox::Line line;  // made once, when the first subscriber wants it
  for (const std::shared_ptr<Session>& session : sessions_) {
    if (!session->subscriptions().pose.pass(time)) continue;
    if (!line) line = std::make_shared<std::string>(notification_line_of(protocol::notification::kPose, pose_text(sample)));
    session->notify(line);
  }
  const std::pair status{sample.status, sample.reasons};
  if (std::exchange(told_status_, status) == status) return;
  for (const std::shared_ptr<Session>& session : sessions_) session->subscriptions().status.hurry();
  methods_.outdate_status();
  publish_status(host_now());
}

void Server::Impl::await_tick() {
  timer_.expires_after(kTick);
  timer_.async_wait([this](error_code failure) {
    if (failure) return;
    tick(host_now());
    await_tick();
  });
}

void Server::Impl::tick(HostTime now) {
  const std::uint64_t ticks = heartbeats.fetch_add(1, std::memory_order_relaxed);
  if (ticks % kTicksPerSample == 0) sources_.health.sample(now);
  if (!accepting_) accept();
  for (const std::shared_ptr<Session>& session : sessions_) session->check_stall(now);
  publish_status(now);
  publish_grid(now);
}

void Server::Impl::publish_status(HostTime now) {
  Outbox::Line line;
  for (const std::shared_ptr<Session>& session : sessions_) {
    if (!session->subscriptions().status.pass(now)) continue;
    if (!line) line = std::make_shared<std::string>(notification_line(protocol::notification::kStatus, methods_.status()));
    session->notify(line);
  }
}

/// Only to those whom the newest grid was not told yet.
void Server::Impl::publish_grid(HostTime now) {
  if (sources_.grid == nullptr) return;
  const GridStore::Newest newest = sources_.grid->newest();
  if (newest.grid == nullptr) return;
  Outbox::Line line;
  for (const std::shared_ptr<Session>& session : sessions_) {
    Subscriptions& wanted = session->subscriptions();
    if (wanted.told_grid == newest.changes || !wanted.grid.pass(now)) continue;
    wanted.told_grid = newest.changes;
    if (!line) line = std::make_shared<std::string>(notification_line(protocol::notification::kGrid, grid_json(newest)));
    session->notify(line);
  }
}

Server::Server(ServerConfig config, ServerSources sources, std::string version) {
  const SignalsBlocked blocked;  // for the thread of the jobs
  impl_ = std::make_unique<Impl>(std::move(config), sources, std::move(version));
}

Server::~Server() { stop(); }

Result<void> Server::start(UniqueFd listening) {
  const SignalsBlocked blocked;
  return impl_->start(std::move(listening));
}

void Server::reconfigure(const ServerConfig& config) { impl_->reconfigure(config); }

void Server::stop() { impl_->stop(); }

std::uint64_t Server::heartbeats() const { return impl_->heartbeats.load(std::memory_order_relaxed); }

std::size_t Server::clients() const { return impl_->clients.load(std::memory_order_relaxed); }

}  // namespace slamd
