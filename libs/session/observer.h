// Observes a live session from outside and sends it requests: the transport of a verb, and the view that it fills.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/time.h"
#include "node/checkpoint.h"
#include "node/session_options.h"
#include "session/session_view.h"
#include "transport/transport.h"

namespace slew::session {

// Longest wait of a verb for a session that should exist, and for a reply.
inline constexpr SimDuration kFindTimeout = milliseconds(3000);
inline constexpr SimDuration kAnswerTimeout = milliseconds(3000);

class Observer {
 public:
  Observer(std::unique_ptr<transport::Transport> transport, std::string session);

  [[nodiscard]] const SessionView& view() const noexcept { return view_; }
  [[nodiscard]] const std::string& session_name() const noexcept { return session_; }

  // Keeps these variables as curves from now on.
  void keep_curves(Curves curves) { view_.keep_curves(std::move(curves)); }

  // Takes what has arrived. Does not wait.
  void drain();

  // Takes messages until `done` is true or the time is over. False in the second case, and when a signal requests a
  // stop.
  bool wait_for(const std::function<bool()>& done, SimDuration at_most);

  // Sends a request, and each time before it the messages that belong to it, until io_node replies. Throws Failure when
  // no reply comes in time, or the session ends first.
  [[nodiscard]] wire::ControlReply request_reply(wire::ControlRequest request, SimDuration at_most = kAnswerTimeout,
                                                 const std::function<void()>& send_first = nullptr);

  // Sends a request without waiting: its effect shows in the view. Returns the request's number, which is drawn unless
  // it has one.
  std::uint64_t send(wire::ControlRequest request);
  [[nodiscard]] static std::uint64_t draw_number();

  // The state of a role that io_node has sent in reply to a request; null: it has not arrived whole.
  [[nodiscard]] const node::Checkpoint* state(std::uint64_t request, wire::Role role) const;
  // Sends io_node a role's state for a request. Throws Failure when it cannot be sent.
  void give_state(std::uint64_t request, wire::Role role, const node::Checkpoint& state);

  void send(const wire::ControllerInput& input);

 private:
  // Waits until io_node is received and reads this observer's requests. False: not within kAnswerTimeout, or the
  // session has ended.
  bool wait_until_matched();
  void take_state(const transport::Received& message);
  [[nodiscard]] bool is_gone() const noexcept;
  [[noreturn]] void throw_unanswered(SimDuration waited) const;

  std::unique_ptr<transport::Transport> transport_;
  std::string session_;
  SessionView view_;
  std::function<void(const wire::ControlReply&)> on_reply_;
  std::map<std::pair<std::uint64_t, wire::Role>, node::CheckpointParts> states_;  // by request and role
};

// An observer with `look` can send no requests.
enum class Access : std::uint8_t { look, steer };

// Opens an observer of the named session, or of the only one that runs on the domain, and waits until it receives from
// it. Throws Failure when there is none, or more than one and no name.
[[nodiscard]] std::unique_ptr<Observer> find_session(node::SessionOptions options, Access access);

}  // namespace slew::session
