// SPDX-License-Identifier: Apache-2.0
// Variables that io_node publishes in every session, whatever recording.variables selects: those of the inputs, of the
// session, and of the steps of the physics nodes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io_node/input_gate.h"
#include "io_node/session_clock.h"
#include "io_node/tick_times.h"
#include "node/session_member.h"
#include "transport/wire.h"

namespace slew::io_node {

// In the order of the values. roles: of the session, as bits; those of physics nodes have variables.
[[nodiscard]] std::vector<wire::VariableEntry> own_variables(std::span<const std::string> inputs, std::uint32_t roles);

class SessionVariables {
 public:
  // All outlive this object.
  SessionVariables(node::SessionMember& member, const InputGate& gate, const SessionClock& clock,
                   const TickTimes& times, const node::NodeTiming& timing)
      : member_(member), gate_(gate), clock_(clock), times_(times), timing_(timing) {}

  // The health of a node, whose newest values are published.
  void receive_health(std::span<const std::byte> bytes);
  void publish_directory();
  // A block without values, for JOIN.
  void publish_probe();
  // The values of step n.
  void publish(StepIndex n, std::int64_t now_ns);

 private:
  void add_channel(std::size_t channel, StepIndex n, std::int64_t now_ns);
  void add_timing(StepIndex n, std::int64_t now_ns);

  node::SessionMember& member_;
  const InputGate& gate_;
  const SessionClock& clock_;
  const TickTimes& times_;
  const node::NodeTiming& timing_;
  std::array<wire::Health, wire::kRoles> healths_;
  wire::VariableBlock block_;
};

}  // namespace slew::io_node
