#pragma once
// One client's connection: reads its request lines, answers them in order, sends its notifications, and holds it to the
// limits. Lives on the server's thread only.

#include <atomic>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>

#include "daemon/server/job_runner.hpp"
#include "daemon/server/line_buffer.hpp"
#include "daemon/server/methods.hpp"
#include "daemon/server/outbox.hpp"
#include "daemon/server/server_counts.hpp"
#include "daemon/server/subscriptions.hpp"
#include "daemon/server/token_bucket.hpp"

namespace slamd {

class Session : public std::enable_shared_from_this<Session> {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;

  /// What all sessions share; outlives them.
  struct Context {
    Methods& methods;
    JobRunner& jobs;
    const ServerLimits& limits;
    ServerCounts& counts;
    std::function<void(std::shared_ptr<Session>)> closed;  // called once
  };

  Session(Socket socket, Right right, Context& context);

  void start() { read(); }
  void close();

  Subscriptions& subscriptions() { return subscriptions_; }

  /// Sends a notification, or counts it as lost when the client has not taken the earlier ones.
  void notify(const Outbox::Line& line);

  /// Drops a client that has taken nothing for limits.stall_timeout_s.
  void check_stall(HostTime now);

 private:
  void read();
  void work();
  void work_after(Duration pause);
  void handle(const std::string& line);
  void answer(const RpcRequest& request, Methods::Handled handled);
  void start_job(const RpcRequest& request, Job job);
  void refuse_line();
  void end_input(bool hung_up);
  void close_if_done();
  void send(std::string line, UniqueFd fd = {});
  void push(Outbox::Line line, UniqueFd fd = {});
  void flush();
  bool has_room() const { return outbox_.bytes() <= context_.limits.max_outbound_bytes; }

  Socket socket_;
  const Right right_;
  boost::asio::steady_timer turn_timer_;  // when work() goes on
  Context& context_;
  LineBuffer lines_;
  TokenBucket bucket_;
  Outbox outbox_;
  Subscriptions subscriptions_;
  std::shared_ptr<std::atomic<bool>> closed_ = std::make_shared<std::atomic<bool>>(false);
  std::optional<std::string> waiting_line_;  // read, but its turn has not come (rate, room)
  std::size_t pending_jobs_ = 0;
  std::uint64_t lost_ = 0;  // notifications since it was last told
  HostTime progress_time_;  // when it last took something, or the outbox was empty
  bool input_ended_ = false;
  bool sending_ = false;  // the socket was full: flush() goes on when it is not
  bool no_room_ = false;  // the outbox was full: work() goes on when it is not
};

}  // namespace slamd
