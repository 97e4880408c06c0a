#include "cli/observer.h"

#include <sys/random.h>

#include <cstdlib>

#include "cli/survey.h"
#include "cli_support/carrier.h"
#include "cli_support/failure.h"
#include "node/driver.h"
#include "transport/codec.h"

namespace slew::cli {

using cli_support::Failure;
using wire::Topic;

namespace {

// reactions to a signal are at most this late
constexpr SimDuration kLongestWait = milliseconds(20);

}  // namespace

Observer::Observer(std::unique_ptr<transport::Transport> carrier, std::string session)
    : carrier_(std::move(carrier)), session_(std::move(session)), view_(session_) {}

void Observer::drain() {
  transport::Received message;
  while (carrier_->take(message)) {
    view_.take(message.topic, message.bytes);
    wire::ControlReply reply;
    if (message.topic == Topic::control_reply && on_reply_ && transport::decode(message.bytes, reply)) on_reply_(reply);
  }
}

bool Observer::wait_for(const std::function<bool()>& done, SimDuration at_most) {
  const std::int64_t end_ns = monotonic_ns() + at_most.ns;
  while (true) {
    drain();
    if (done()) return true;
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns >= end_ns || node::stop_requested.load() != 0) return false;
    carrier_->wait_until(std::min(end_ns, now_ns + kLongestWait.ns));
  }
}

std::uint64_t Observer::send(wire::ControlRequest request) {
  request.session = session_;
  if (getrandom(&request.request, sizeof request.request, 0) != sizeof request.request) std::abort();
  transport::ByteBuffer bytes;
  if (!transport::encode(request, bytes)) {
    throw Failure(ExitCode::bad_input, "the request is too long; nothing was sent; names have at most 63 characters");
  }
  cli_support::require(carrier_->publish(Topic::control_request, bytes));
  return request.request;
}

// A request is lost when io_node does not know this reader yet; its health shows that both have found each other.
bool Observer::wait_until_heard() {
  return wait_for(
      [this] {
        const NodeView& io = view_.node(wire::Role::io);
        return io.health.header.session == view_.session().header.session &&
               cli_support::is_heard(*carrier_, Topic::control_request);
      },
      kAnswerTimeout);
}

wire::ControlReply Observer::ask(wire::ControlRequest request) {
  wire::ControlReply answer;
  bool is_answered = false;
  std::uint64_t number = 0;
  on_reply_ = [&](const wire::ControlReply& reply) {
    if (reply.request != number) return;
    answer = reply;
    is_answered = true;
  };
  if (wait_until_heard()) {
    number = send(std::move(request));
    wait_for([&] { return is_answered; }, kAnswerTimeout);
  }
  on_reply_ = nullptr;
  if (!is_answered) {
    throw Failure(ExitCode::failed, "session '" + session_ +
                                        "' has not answered within 3 s; the request may have had an effect; look with "
                                        "'slewring sessions' whether it still runs");
  }
  return answer;
}

void Observer::send(const wire::ControllerInput& input) {
  transport::ByteBuffer bytes;
  // a lost lever position needs no reaction: the next one follows within 50 ms
  if (transport::encode(input, bytes)) static_cast<void>(carrier_->publish(Topic::controller_input, bytes));
}

std::unique_ptr<Observer> find_session(cli_support::SessionOptions options) {
  if (options.session.empty()) options.session = only_session(options);
  auto observer = std::make_unique<Observer>(cli_support::open_carrier(wire::Role::observer, options), options.session);
  const bool is_found = observer->wait_for([&] { return observer->view().has_session(); }, kFindTimeout);
  if (is_found) return observer;
  if (const int stop = node::stop_requested.load(); stop != 0)
    throw Failure(static_cast<ExitCode>(stop), "interrupted");
  throw Failure(ExitCode::failed, "no session '" + options.session + "' was found on domain " +
                                      std::to_string(options.domain) +
                                      " within 3 s; see 'slewring sessions', and compare --domain, --interface, "
                                      "--peer and --keys with those of the session");
}

}  // namespace slew::cli
