// SPDX-License-Identifier: Apache-2.0
// Observes a live session from outside and sends it requests: a transport, and the view that its messages fill.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "observer/session_view.h"
#include "transport/transport.h"

namespace slew::observer {

inline constexpr SimDuration kAnswerTimeout = milliseconds(3000);  // longest wait for a reply

struct ObserverOptions {
  std::string session;
  Choice choice = Choice::newest;
  Receiver* receiver = nullptr;  // lives as long as the observer; null: none
  // not 0: waits end. With a signal handler's flag, its value is the exit code of the Failure
  const std::atomic<int>* stop = nullptr;
};

class Observer {
 public:
  Observer(std::unique_ptr<transport::Transport> transport, ObserverOptions options)
      : transport_(std::move(transport)), options_(std::move(options)), view_(options_.session, options_.choice) {}

  [[nodiscard]] const SessionView& view() const noexcept { return view_; }
  [[nodiscard]] const std::string& session_name() const noexcept { return options_.session; }
  // A stop was requested.
  [[nodiscard]] bool is_stopped() const noexcept { return stop_code() != 0; }

  // Takes what has arrived. Does not wait.
  void drain();

  // Takes messages until `done` is true or the time is over. False in the second case, and when a stop was requested.
  // Time in which this process itself stood still does not count as waiting.
  bool wait_for(const std::function<bool()>& done, SimDuration at_most);

  // Sends a request, and each time before it the messages that belong to it, until io_node replies. Throws Failure when
  // no reply comes in time, or the session ends first.
  [[nodiscard]] wire::ControlReply request_reply(wire::ControlRequest request, SimDuration at_most = kAnswerTimeout,
                                                 const std::function<void()>& send_first = nullptr);

  // Sends a request without waiting: its effect shows in the view. Returns the request's number, which is drawn unless
  // it has one. Throws Failure when it cannot be sent.
  std::uint64_t send(wire::ControlRequest request);
  [[nodiscard]] static std::uint64_t draw_number();

  // Error (bad_input): the message is too long; nothing was sent.
  Status send(const wire::ControllerInput& input);
  Status send(const wire::StatePart& part);

 private:
  // Waits until io_node is received and reads this observer's requests. False: not within kAnswerTimeout, or the
  // session has ended.
  bool wait_until_matched();
  [[nodiscard]] bool is_gone() const noexcept { return !view_.has_session() || view_.is_over(); }
  [[nodiscard]] int stop_code() const noexcept { return options_.stop != nullptr ? options_.stop->load() : 0; }
  [[noreturn]] void throw_unanswered(SimDuration waited) const;
  // too_long: text of the error when the message cannot be encoded.
  template <typename Message>
  Status publish(const Message& message, const char* too_long);

  std::unique_ptr<transport::Transport> transport_;
  ObserverOptions options_;
  SessionView view_;
  std::function<void(const wire::ControlReply&)> on_reply_;
  std::vector<std::byte> buffer_;
};

}  // namespace slew::observer
