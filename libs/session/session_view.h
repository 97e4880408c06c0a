// An observer's view of a session: its processes and their health, the variables' names, values and extremes.
//
// Fed with messages, from a live transport or from a recording. Messages of other sessions are ignored.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "node/flag_counter.h"
#include "session/curves.h"
#include "transport/transport.h"
#include "transport/wire.h"

namespace slew::session {

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

class SessionView {
 public:
  // name of the session to look at; empty takes the first one that is received.
  explicit SessionView(std::string name = {}) : name_(std::move(name)) {}

  // time: of the message in the session [s]; none: that of its step.
  void take(wire::Topic topic, std::span<const std::byte> bytes, std::optional<double> time = std::nullopt);
  // Keeps variables as curves from now on.
  void keep_curves(Curves curves) { curves_ = empty_curves_ = std::move(curves); }
  // No further name of a variable comes.
  void end_names() noexcept {
    if (curves_) curves_->end_names();
  }

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

  // All variables known so far, by role and index.
  [[nodiscard]] std::vector<const VariableView*> variables() const;
  [[nodiscard]] const VariableView* find(std::string_view name) const;
  // Its values are left out at present, to reduce the load of their publisher.
  [[nodiscard]] bool is_left_out(std::string_view name) const;
  // io_node's last answer to this controller about a channel; null before.
  [[nodiscard]] const wire::ControllerLease* lease(const std::string& controller, const std::string& channel) const;

  // What the physics samples reported, as far as the transport reads their topics.
  [[nodiscard]] const node::FlagCounter& flags() const noexcept { return flags_; }
  // What was kept of the variables; null: nothing.
  [[nodiscard]] const Curves* curves() const noexcept { return curves_ ? &*curves_ : nullptr; }
  // Of all blocks of variables that have come, whatever their order.
  [[nodiscard]] std::uint64_t variables_digest() const noexcept { return variables_digest_; }

  // Every node that offers variables has published all their names.
  [[nodiscard]] bool has_whole_directory() const noexcept;

 private:
  void take_session(std::span<const std::byte> bytes);
  void look_at(std::optional<wire::SessionDescription> session);
  void take_lease(std::span<const std::byte> bytes);
  void take_status(std::span<const std::byte> bytes);
  void take_health(std::span<const std::byte> bytes);
  void take_directory(std::span<const std::byte> bytes);
  void take_block(std::span<const std::byte> bytes, std::optional<double> time);
  template <typename Sample>
  void take_sample(std::span<const std::byte> bytes, Sample& sample);
  [[nodiscard]] NodeView* node_of(const wire::Header& header);

  struct PendingMessage {
    wire::Topic topic;
    std::vector<std::byte> bytes;
  };

  std::string name_;
  std::optional<wire::SessionDescription> session_;
  std::optional<wire::SessionDescription>
      claimant_;                         // another session of the same name; it takes over when session_ is withdrawn
  std::vector<PendingMessage> pending_;  // messages received before the session was known
  std::array<NodeView, wire::kRoles> nodes_;
  std::array<std::vector<VariableView>, wire::kRoles> variables_;
  std::array<std::uint32_t, wire::kRoles> named_{};  // number of variables whose name has arrived
  std::array<bool, wire::kRoles> has_directory_{};   // whether a role's directory has arrived
  std::map<std::string, std::pair<std::size_t, std::size_t>, std::less<>> index_;
  std::map<std::pair<std::string, std::string>, wire::ControllerLease> leases_;
  StepIndex step_ = kJoinStep;
  wire::VariableBlock block_;
  node::FlagCounter flags_;
  std::optional<Curves> curves_, empty_curves_;
  std::uint64_t variables_digest_ = 0;
  wire::MechanismMessage mechanism_;
  wire::ActuatorMessage actuators_;
};

}  // namespace slew::session
