// SPDX-License-Identifier: Apache-2.0
#include "observer/observer.h"

#include <sys/random.h>

#include <algorithm>
#include <cstdlib>

#include "core/failure.h"
#include "transport/cdr/codec.h"
#include "transport/topics.h"

namespace slew::observer {

using wire::Topic;

namespace {

// reactions to a signal are at most this late
constexpr SimDuration kLongestWait = milliseconds(20);
// a wait that is later than this is not load: the process was stopped, or its machine slept
constexpr std::int64_t kStandstillNs = 200'000'000;
constexpr SimDuration kRequestInterval = milliseconds(250);
// io_node's replies from before its end may arrive after its last status
constexpr SimDuration kLastReplies = milliseconds(200);

}  // namespace

void Observer::drain() {
  transport::Received message;
  while (transport_->take(message)) {
    if (message.object != nullptr) {
      view_.take_object(message, options_.receiver);
      continue;
    }
    view_.take(message.topic, message.bytes, std::nullopt, options_.receiver);
    wire::ControlReply reply;
    const bool is_wanted = on_reply_ || options_.receiver != nullptr;
    if (message.topic != Topic::control_reply || !is_wanted || !transport::decode(message.bytes, reply)) continue;
    if (on_reply_) on_reply_(reply);
    if (options_.receiver != nullptr) options_.receiver->take_reply(reply);
  }
}

bool Observer::wait_for(const std::function<bool()>& done, SimDuration at_most) {
  std::int64_t seen_ns = monotonic_ns();  // when it was awake last, or is to be
  std::int64_t end_ns = seen_ns + at_most.ns;
  while (true) {
    drain();
    if (done()) return true;
    const std::int64_t now_ns = monotonic_ns();
    if (stop_code() != 0) return false;
    if (now_ns - seen_ns > kStandstillNs) end_ns += now_ns - seen_ns;
    if (now_ns >= end_ns) {
      drain();
      return done();
    }
    seen_ns = std::min(end_ns, now_ns + kLongestWait.ns);
    transport_->wait_until(seen_ns);
  }
}

// ---- sending --------------------------------------------------------------------------------------------------

template <typename Message>
Status Observer::publish(const Message& message, const char* too_long) {
  if (!transport::encode(message, buffer_)) return Status::error(ExitCode::bad_input, too_long);
  return transport_->publish(transport::kTopicOf<Message>, buffer_);
}

Status Observer::send(const wire::ControllerInput& input) {
  return publish(input, "the name of a channel is too long; nothing was sent; names have at most 63 characters");
}

Status Observer::send(const wire::StatePart& part) {
  return publish(part, "the saved state is too large; nothing was sent");
}

std::uint64_t Observer::draw_number() {
  std::uint64_t number = 0;
  while (number == 0) {
    if (getrandom(&number, sizeof number, 0) != sizeof number) std::abort();
  }
  return number;
}

std::uint64_t Observer::send(wire::ControlRequest request) {
  request.session = options_.session;
  if (request.request == 0) request.request = draw_number();
  require(publish(request, "the request is too long; nothing was sent; names have at most 63 characters"));
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
    while (!is_answered && !is_gone() && stop_code() == 0 && monotonic_ns() < end_ns) {
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
  const std::string session = "session '" + options_.session + "' ";
  if (is_gone()) {
    const std::string& reason = view_.node(wire::Role::io).status.reason;
    throw Failure(ExitCode::failed, session + "ended before it answered" + (reason.empty() ? "" : ": " + reason) +
                                        "; there is nothing left to be changed; start it again");
  }
  if (const int stop = stop_code(); stop != 0) {
    throw Failure(static_cast<ExitCode>(stop), "interrupted; the request may have had an effect");
  }
  throw Failure(ExitCode::failed, session + "has not answered within " + seconds_text(waited) +
                                      "; the request may have had an effect; look with 'slewring sessions' whether it "
                                      "still runs");
}

}  // namespace slew::observer
