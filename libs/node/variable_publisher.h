// SPDX-License-Identifier: Apache-2.0
// Publishes the variables of a physics node that the scene selects: their directory once, their values in blocks.
#pragma once

#include <vector>

#include "node/session_member.h"
#include "node/subsystem_factory.h"

namespace slew::node {

class VariablePublisher {
 public:
  // built: outlives this object; complete before the first directory.
  explicit VariablePublisher(const BuiltSubsystem& built) noexcept : built_(built) {}

  // JOIN: step -1 on the topic, until every reader has acknowledged it.
  void probe(SessionMember& member);
  // Publishes names and units. An empty directory is published as well, so that clients do not wait for it.
  void publish_directory(SessionMember& member) const;
  // Publishes the values at a step. No allocation after the first call.
  void publish(SessionMember& member, StepIndex step);
  // Publishes the same blocks without values, so that no reader counts them as lost while the session sheds load.
  void publish_shed(SessionMember& member, StepIndex step);

 private:
  enum class Content : std::uint8_t { values, none };
  void publish_blocks(SessionMember& member, StepIndex step, Content content);

  const BuiltSubsystem& built_;
  std::vector<double> values_;  // values of all variables of the subsystem
  wire::VariableBlock block_;
};

}  // namespace slew::node
