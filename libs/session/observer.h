// Looks at a live session from outside and speaks to it: the transport of a verb, and what is known through it.
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

// How long a verb waits for a session that should be there, and for an answer of it.
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

  // Takes messages until `done` is true or the time is over; false then, and when a signal asks to stop.
  bool wait_for(const std::function<bool()>& done, SimDuration at_most);

  // Sends a request, and each time before it what belongs to it, until io_node answers. Throws Failure when no answer
  // comes in time, or the session ends first.
  [[nodiscard]] wire::ControlReply ask(wire::ControlRequest request, SimDuration at_most = kAnswerTimeout,
                                       const std::function<void()>& send_first = nullptr);

  // The same without waiting: whether it had an effect is seen in the view. Returns the request's number, which is
  // drawn unless it has one.
  std::uint64_t send(wire::ControlRequest request);
  [[nodiscard]] static std::uint64_t draw_number();

  // The state of a role that io_node has given in answer to a request; null: it has not come whole.
  [[nodiscard]] const node::Checkpoint* state(std::uint64_t request, wire::Role role) const;
  // Gives io_node a role's state for a request. Throws Failure when it cannot be sent.
  void give_state(std::uint64_t request, wire::Role role, const node::Checkpoint& state);

  void send(const wire::ControllerInput& input);

 private:
  // io_node is heard, and reads what this observer writes. False: not within kAnswerTimeout, or the session has ended.
  bool wait_until_heard();
  void take_state(const transport::Received& message);
  [[nodiscard]] bool is_gone() const noexcept;
  [[noreturn]] void say_why_not_answered(SimDuration waited) const;

  std::unique_ptr<transport::Transport> transport_;
  std::string session_;
  SessionView view_;
  std::function<void(const wire::ControlReply&)> on_reply_;
  std::map<std::pair<std::uint64_t, wire::Role>, node::CheckpointParts> states_;  // by request and role
};

// An observer that only looks on can ask and send nothing.
enum class Access : std::uint8_t { look, steer };

// Opens an observer of the named session, or of the only one that runs on the domain, and waits until it is heard.
// Throws Failure when there is none, or more than one and no name.
[[nodiscard]] std::unique_ptr<Observer> find_session(node::SessionOptions options, Access access);

}  // namespace slew::session
