// SPDX-License-Identifier: Apache-2.0
// An observer's view of a session: its processes and their health, the variables' names, values and extremes.
//
// Fed with messages, from a live transport or from a recording. Messages of other sessions, and of processes whose
// place was given to others, are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::observer {

// Computing time of a node's steps, from its health messages or measured directly.
struct StepTimes {
  double sum = 0;  // s
  std::uint64_t steps = 0;
  double max = 0;  // s
  [[nodiscard]] double mean() const noexcept { return steps > 0 ? sum / static_cast<double>(steps) : 0; }
};

struct NodeView {
  bool is_known = false;
  wire::NodeStatus status;
  wire::Health health;
  std::uint64_t healths = 0;  // messages so far
  StepTimes times;
  std::uint64_t steps_seen = 0;  // Health::steps_done of the last health message
  // blocks of its variables, and the number of blocks without values: left out under load
  std::uint64_t blocks = 0, blocks_left_out = 0;
  std::optional<StepIndex> left_out_since;
};

struct VariableView {
  std::string name;
  std::string unit;
  double value = std::numeric_limits<double>::quiet_NaN();
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  StepIndex step = kJoinStep;  // step of the value
};

// Writer of a variable, and its index among the writer's variables.
struct VariablePlace {
  wire::Role role = wire::Role::io;
  std::uint32_t index = 0;
  auto operator<=>(const VariablePlace&) const = default;
};

// Receives the messages of the session that a view has accepted, in addition to the view.
class Receiver {
 public:
  Receiver() = default;
  virtual ~Receiver() = default;
  // Another session has become the view's one, or none is left: messages from before belong to the earlier one.
  virtual void begin_session() {}
  // Every message of the session, as it came, before it is read; of a recording also those that name no session. time:
  // of the message, or its step, in the session [s].
  virtual void take_wire(wire::Topic, std::span<const std::byte> /*bytes*/, double /*time*/) {}
  virtual void take_directory(const wire::VariableDirectory&) {}
  // In phase RUNNING. time: of the block in the session [s].
  virtual void take_block(const wire::VariableBlock&, std::span<const std::byte> /*bytes*/, double /*time*/) {}
  virtual void take_sample(const wire::Header&, const wire::SampleState&) {}
  virtual void take_lease(const wire::ControllerLease&) {}
  virtual void take_state(const wire::StatePart&) {}
  // Of a live session, whichever process requested it.
  virtual void take_reply(const wire::ControlReply&) {}

 protected:
  Receiver(const Receiver&) = default;
  Receiver& operator=(const Receiver&) = default;
};

// Which of several sessions of one name is viewed.
enum class Choice : std::uint8_t {
  newest,  // one that starts later takes the place, and gives it back when it is withdrawn
  first    // the first one that was received, to its end
};

class SessionView {
 public:
  // name of the session to look at; empty takes the first one that is received.
  explicit SessionView(std::string name = {}, Choice choice = Choice::newest)
      : name_(std::move(name)), choice_(choice) {}

  // time: of the message in the session [s]; none: that of its step. receiver: may be null.
  void take(wire::Topic topic, std::span<const std::byte> bytes, std::optional<double> time = std::nullopt,
            Receiver* receiver = nullptr);
  // A sample of a physics node that came as an object. The receiver gets its state, not its bytes.
  void take_object(const transport::Received& sample, Receiver* receiver);

  [[nodiscard]] bool has_session() const noexcept { return session_.has_value(); }
  [[nodiscard]] const wire::SessionDescription& session() const noexcept { return *session_; }
  [[nodiscard]] const NodeView& node(wire::Role role) const noexcept { return nodes_[static_cast<std::size_t>(role)]; }
  // Step times that were measured directly, in the place of those from health messages.
  void set_times(wire::Role role, const StepTimes& times) { nodes_[static_cast<std::size_t>(role)].times = times; }
  // Highest step that a message of the session has named.
  [[nodiscard]] StepIndex step() const noexcept { return step_; }
  // The session stands because a pause was requested, not because it waits for a node.
  [[nodiscard]] bool is_paused() const noexcept;
  // io_node has published the session's end.
  [[nodiscard]] bool is_over() const noexcept;
  // Reason of the end, which may be empty: io_node's, or that of another node where io_node itself may be lost. None:
  // the session goes on.
  [[nodiscard]] const std::optional<std::string>& end() const noexcept { return end_; }

  // All variables named so far, by role and index.
  [[nodiscard]] std::vector<const VariableView*> variables() const;
  // Their places in the order in which the names arrived.
  [[nodiscard]] const std::vector<VariablePlace>& places() const noexcept { return places_; }
  [[nodiscard]] const VariableView& variable(const VariablePlace& place) const noexcept {
    return variables_[static_cast<std::size_t>(place.role)][place.index];
  }
  // Null: no variable of that name so far.
  [[nodiscard]] const VariablePlace* find_place(std::string_view name) const;
  [[nodiscard]] const VariableView* find(std::string_view name) const;
  // Its values are left out at present, to reduce the load of their publisher.
  [[nodiscard]] bool is_left_out(std::string_view name) const;
  // Every node that offers variables has published all their names.
  [[nodiscard]] bool has_whole_directory() const noexcept;
  // io_node's last answer to this controller about a channel; null before.
  [[nodiscard]] const wire::ControllerLease* lease(const std::string& controller, const std::string& channel) const;

 private:
  using Bytes = std::span<const std::byte>;

  void pass_on(wire::Topic topic, Bytes bytes, std::optional<double> time, Receiver& receiver);
  void take_session(Bytes bytes, Receiver* receiver);
  void look_at(std::optional<wire::SessionDescription> session, Receiver* receiver);
  void take_lease(Bytes bytes, Receiver* receiver);
  void take_status(Bytes bytes);
  void note_end(const wire::NodeStatus& status);
  void take_health(Bytes bytes);
  void take_directory(Bytes bytes, Receiver* receiver);
  void take_block(Bytes bytes, std::optional<double> time, Receiver* receiver);
  void take_state(Bytes bytes, Receiver* receiver);
  template <typename Sample>
  void take_sample(Bytes bytes, Receiver* receiver);
  [[nodiscard]] NodeView* node_of(const wire::Header& header);

  struct PendingMessage {
    wire::Topic topic;
    std::vector<std::byte> bytes;
    std::optional<double> time;
  };

  std::string name_;
  Choice choice_;
  std::optional<wire::SessionDescription> session_;
  std::optional<wire::SessionDescription>
      claimant_;                         // another session of the same name; it takes over when session_ is withdrawn
  std::vector<PendingMessage> pending_;  // messages received before the session was known
  std::array<NodeView, wire::kRoles> nodes_;
  std::array<std::deque<VariableView>, wire::kRoles> variables_;
  std::array<std::uint32_t, wire::kRoles> named_{};  // number of variables whose name has arrived
  std::array<bool, wire::kRoles> has_directory_{};   // whether a role's directory has arrived
  std::vector<VariablePlace> places_;
  std::map<std::string, VariablePlace, std::less<>> index_;
  std::map<std::pair<std::string, std::string>, wire::ControllerLease> leases_;
  StepIndex step_ = kJoinStep;
  std::optional<std::string> end_;
  wire::VariableBlock block_;
};

}  // namespace slew::observer
