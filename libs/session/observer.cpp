#include "session/observer.h"

#include <sys/random.h>

#include <cstdlib>

#include "core/failure.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "session/survey.h"
#include "transport/cdr/codec.h"

namespace slew::session {

using wire::Topic;

namespace {

// reactions to a signal are at most this late
constexpr SimDuration kLongestWait = milliseconds(20);
constexpr SimDuration kRequestInterval = milliseconds(250);
// io_node's replies from before its end may arrive after its last status
constexpr SimDuration kLastReplies = milliseconds(200);

}  // namespace

Observer::Observer(std::unique_ptr<transport::Transport> transport, std::string session)
    : transport_(std::move(transport)), session_(std::move(session)), view_(session_) {}

void Observer::drain() {
  transport::Received message;
  while (transport_->take(message)) {
    view_.take(message.topic, message.bytes);
    wire::ControlReply reply;
    take_state(message);
    if (message.topic == Topic::control_reply && on_reply_ && transport::decode(message.bytes, reply)) on_reply_(reply);
  }
}

void Observer::take_state(const transport::Received& message) {
  wire::StatePart part;
  if (message.topic != Topic::state || !transport::decode(message.bytes, part)) return;
  const bool is_answer = part.header.role == wire::Role::io && part.request != 0 && view_.has_session() &&
                         part.header.session == view_.session().header.session;
  if (is_answer) states_[{part.request, part.role}].take(part);
}

const node::Checkpoint* Observer::state(std::uint64_t request, wire::Role role) const {
  const auto found = states_.find({request, role});
  return found != states_.end() && found->second.is_whole() ? &found->second.checkpoint() : nullptr;
}

void Observer::give_state(std::uint64_t request, wire::Role role, const node::Checkpoint& state) {
  wire::Header header;
  header.session = view_.session().header.session;
  header.role = wire::Role::observer;
  header.phase = wire::Phase::running;
  header.step = state.step;
  transport::ByteBuffer bytes;
  for (const wire::StatePart& part : node::parts_of(state, header, role, request)) {
    if (!transport::encode(part, bytes)) {
      throw Failure(ExitCode::bad_input, "the saved state is too large; nothing was sent");
    }
    require(transport_->publish(Topic::state, bytes));
  }
}

bool Observer::wait_for(const std::function<bool()>& done, SimDuration at_most) {
  const std::int64_t end_ns = monotonic_ns() + at_most.ns;
  while (true) {
    drain();
    if (done()) return true;
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns >= end_ns || node::stop_requested.load() != 0) return false;
    transport_->wait_until(std::min(end_ns, now_ns + kLongestWait.ns));
  }
}

std::uint64_t Observer::draw_number() {
  std::uint64_t number = 0;
  while (number == 0) {
    if (getrandom(&number, sizeof number, 0) != sizeof number) std::abort();
  }
  return number;
}

std::uint64_t Observer::send(wire::ControlRequest request) {
  request.session = session_;
  if (request.request == 0) request.request = draw_number();
  transport::ByteBuffer bytes;
  if (!transport::encode(request, bytes)) {
    throw Failure(ExitCode::bad_input, "the request is too long; nothing was sent; names have at most 63 characters");
  }
  require(transport_->publish(Topic::control_request, bytes));
  return request.request;
}

// This program receives from io_node and sees its readers. The middleware does not report whether io_node sees this
// program's writers.
bool Observer::wait_until_matched() {
  const auto is_matched = [this] {
    const NodeView& io = view_.node(wire::Role::io);
    return io.health.header.session == view_.session().header.session &&
           transport_->matched_readers(Topic::control_request) > 0 && transport_->matched_readers(Topic::state) > 0;
  };
  return wait_for([&] { return is_gone() || is_matched(); }, kAnswerTimeout) && !is_gone();
}

bool Observer::is_gone() const noexcept {
  return !view_.has_session() || view_.is_over();
}

wire::ControlReply Observer::request_reply(wire::ControlRequest request, SimDuration at_most,
                                           const std::function<void()>& send_first) {
  if (request.request == 0) request.request = draw_number();
  wire::ControlReply answer;
  bool is_answered = false;
  on_reply_ = [&](const wire::ControlReply& reply) {
    if (reply.request != request.request) return;
    answer = reply;
    is_answered = true;
  };
  if (wait_until_matched()) {
    // repeated until it is received: io_node recognises a copy
    const std::int64_t end_ns = monotonic_ns() + at_most.ns;
    while (!is_answered && !is_gone() && node::stop_requested.load() == 0 && monotonic_ns() < end_ns) {
      if (send_first) send_first();
      send(request);
      wait_for([&] { return is_answered || is_gone(); }, kRequestInterval);
    }
    if (is_gone()) wait_for([&] { return is_answered; }, kLastReplies);
  }
  on_reply_ = nullptr;
  if (!is_answered) throw_unanswered(at_most);
  return answer;
}

void Observer::throw_unanswered(SimDuration waited) const {
  if (is_gone()) {
    const std::string& reason = view_.node(wire::Role::io).status.reason;
    throw Failure(ExitCode::failed, "session '" + session_ + "' ended before it answered" +
                                        (reason.empty() ? "" : ": " + reason) +
                                        "; there is nothing left to be changed; start it again");
  }
  if (const int stop = node::stop_requested.load(); stop != 0) {
    throw Failure(static_cast<ExitCode>(stop), "interrupted; the request may have had an effect");
  }
  throw Failure(ExitCode::failed, "session '" + session_ + "' has not answered within " + node::seconds_text(waited) +
                                      "; the request may have had an effect; look with 'slewring sessions' whether it "
                                      "still runs");
}

void Observer::send(const wire::ControllerInput& input) {
  transport::ByteBuffer bytes;
  // a lost lever position needs no reaction: the next one follows within 50 ms
  if (transport::encode(input, bytes)) static_cast<void>(transport_->publish(Topic::controller_input, bytes));
}

std::unique_ptr<Observer> find_session(node::SessionOptions options, Access access) {
  if (options.session.empty()) options.session = only_session(options);
  auto transport =
      access == Access::look ? node::open_viewer(options) : node::open_transport(wire::Role::observer, options);
  auto observer = std::make_unique<Observer>(std::move(transport), options.session);
  const bool is_found = observer->wait_for([&] { return observer->view().has_session(); }, kFindTimeout);
  if (is_found) return observer;
  if (const int stop = node::stop_requested.load(); stop != 0)
    throw Failure(static_cast<ExitCode>(stop), "interrupted");
  throw Failure(ExitCode::failed, "no session '" + options.session + "' was found on domain " +
                                      std::to_string(options.domain) +
                                      " within 3 s; see 'slewring sessions', and compare --domain, --interface, "
                                      "--peer and --keys with those of the session");
}

}  // namespace slew::session
