#include "daemon/server/session.hpp"

#include <poll.h>

#include <boost/asio/buffer.hpp>
#include <exception>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/server/protocol/protocol.hpp"

namespace slamd {
namespace {

using boost::system::error_code;
namespace error = protocol::error;

constexpr int kLinesPerTurn = 8;               // then the other clients have theirs
constexpr std::size_t kMaxJobsOfOneClient = 2;
constexpr std::size_t kMaxUntakenFds = 2;      // each may be a map of some megabytes
constexpr Duration kTakingPeriod = std::chrono::milliseconds{10};  // between two looks whether they were taken

bool has_hung_up(int socket) {
  pollfd state{.fd = socket, .events = 0, .revents = 0};
  return ::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR)) != 0;
}

}  // namespace

Session::Session(Socket socket, Right right, Context& context)
    : socket_{std::move(socket)},
      right_{right},
      turn_timer_{socket_.get_executor()},
      context_{context},
      lines_{context.limits.max_request_bytes},
      bucket_{context.limits.max_requests_per_s},
      progress_time_{host_now()} {}

void Session::close() {
  if (closed_->exchange(true)) return;
  error_code ignored;
  turn_timer_.cancel(ignored);
  socket_.close(ignored);
  context_.closed(shared_from_this());
}

void Session::read() {
  const std::span<char> room = lines_.prepare();
  socket_.async_read_some(boost::asio::buffer(room.data(), room.size()),
                          [self = shared_from_this()](error_code failure, std::size_t count) {
                            self->lines_.commit(count);
                            if (*self->closed_) return;
                            if (failure) return self->end_input(has_hung_up(self->socket_.native_handle()));
                            self->work();
                          });
}

/// Handles waiting lines until there are none, the client's rate or room is used up, it leaves descriptors untaken, or its turn is
/// over. Goes on by itself: with the next bytes, by the timer, or when the socket has taken what waited (flush).
void Session::work() {
  for (int i = 0; i < kLinesPerTurn; ++i) {
    no_room_ = !has_room();
    if (*closed_ || no_room_) return;
    if (outbox_.untaken_fds(socket_.native_handle()) >= kMaxUntakenFds) return work_after(kTakingPeriod);
    if (!waiting_line_) waiting_line_ = lines_.next();
    if (!waiting_line_) {
      if (input_ended_) return close_if_done();
      return lines_.too_long() ? refuse_line() : read();
    }
    if (!bucket_.take(host_now())) {
      ++context_.counts.throttled;
      return work_after(bucket_.wait());
    }
    const std::string line = *std::exchange(waiting_line_, std::nullopt);
    line.size() > context_.limits.max_request_bytes ? refuse_line() : handle(line);
  }
  work_after(Duration{0});
}

void Session::work_after(Duration pause) {
  turn_timer_.expires_after(pause);
  turn_timer_.async_wait([self = shared_from_this()](error_code failure) {
    if (!failure) self->work();
  });
}

void Session::handle(const std::string& line) {
  if (line.empty() || line == "\r") return;
  ++context_.counts.requests;
  auto parsed = parse_request(line);
  if (const RpcFault* fault = std::get_if<RpcFault>(&parsed)) {
    ++context_.counts.bad_requests;
    return send(error_line(fault->id, fault->error));
  }
  const RpcRequest& request = std::get<RpcRequest>(parsed);
  try {
    answer(request, context_.methods.call(request, right_, subscriptions_));
  } catch (const std::exception&) {
    ++context_.counts.internal_errors;
    answer(request, RpcError{error::kInternal, "internal error"});
  }
}

void Session::answer(const RpcRequest& request, Methods::Handled handled) {
  if (Job* job = std::get_if<Job>(&handled)) return start_job(request, std::move(*job));
  if (const RpcError* failure = std::get_if<RpcError>(&handled)) {
    ++context_.counts.failed_requests;
    if (failure->code == error::kNotAllowed) ++context_.counts.refused_control;
    if (request.wants_answer) send(error_line(request.id, *failure));
    return;
  }
  Reply& reply = std::get<Reply>(handled);
  if (request.wants_answer) send(result_line(request.id, std::move(reply.result)), std::move(reply.fd));
}

void Session::start_job(const RpcRequest& request, Job job) {
  JobRunner::Ticket ticket;
  ticket.cancelled = closed_;
  ticket.done = [self = shared_from_this(), request](Outcome outcome) {
    --self->pending_jobs_;
    if (*self->closed_) return;
    std::visit([&](auto& value) { self->answer(request, std::move(value)); }, outcome);
    self->close_if_done();
  };
  if (job.tell_progress && request.wants_answer) {
    ticket.progress = [self = shared_from_this(), id = request.id](const char* stage, double share) {
      const nlohmann::json params = {{"id", id}, {"stage", stage}, {"share", share}};
      self->notify(std::make_shared<std::string>(notification_line(protocol::notification::kProgress, params)));
    };
  }
  const bool accepted =
      pending_jobs_ < kMaxJobsOfOneClient && context_.jobs.submit(std::move(job), std::move(ticket));
  if (accepted) {
    ++pending_jobs_;
  } else {
    ++context_.counts.refused_jobs;
    answer(request, RpcError{error::kBusy, "too many maps and files are in work"});
  }
}

void Session::refuse_line() {
  ++context_.counts.too_long;
  lines_.clear();
  input_ended_ = true;
  subscriptions_ = {};
  send(error_line(nullptr, {error::kTooLong, "the request line is too long"}));
  close_if_done();
}

/// The client sends no more. If it only shut down its sending side, it still gets its answers and notifications.
void Session::end_input(bool hung_up) {
  input_ended_ = true;
  if (hung_up) return close();
  socket_.async_wait(Socket::wait_error, [self = shared_from_this()](error_code) { self->close(); });
  close_if_done();
}

void Session::close_if_done() {
  if (input_ended_ && pending_jobs_ == 0 && outbox_.empty() && !subscriptions_.any()) close();
}

void Session::notify(const Outbox::Line& line) {
  if (*closed_) return;
  if (outbox_.bytes() + line->size() > context_.limits.max_outbound_bytes / 8) {
    ++lost_;
    ++context_.counts.lost_notifications;
    return;
  }
  if (lost_ > 0) {
    push(std::make_shared<std::string>(
        notification_line(protocol::notification::kLost, {{"count", std::exchange(lost_, 0)}})));
  }
  ++context_.counts.notifications;
  push(line);
  flush();
}

void Session::check_stall(HostTime now) {
  const bool waits = !outbox_.empty() || outbox_.untaken_fds(socket_.native_handle()) > 0;
  if (!waits || to_seconds(now - progress_time_) < context_.limits.stall_timeout_s) return;
  ++context_.counts.stalled_clients;
  close();
}

void Session::send(std::string line, UniqueFd fd) {
  if (*closed_) return;
  push(std::make_shared<std::string>(std::move(line)), std::move(fd));
  flush();
}

void Session::push(Outbox::Line line, UniqueFd fd) {
  if (outbox_.empty()) progress_time_ = host_now();
  outbox_.push(std::move(line), std::move(fd));
}

void Session::flush() {
  if (sending_ || *closed_) return;
  const std::size_t before = outbox_.total_sent();
  const Outbox::Flush result = outbox_.flush(socket_.native_handle());
  if (outbox_.total_sent() != before) progress_time_ = host_now();
  if (result == Outbox::Flush::kBroken) return close();
  if (result == Outbox::Flush::kDone) return;
  sending_ = true;
  socket_.async_wait(Socket::wait_write, [self = shared_from_this()](error_code failure) {
    self->sending_ = false;
    if (failure) return self->close();
    self->flush();
    if (self->no_room_ && self->has_room()) self->work();
    self->close_if_done();
  });
}

}  // namespace slamd
