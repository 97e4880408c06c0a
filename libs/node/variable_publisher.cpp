// SPDX-License-Identifier: Apache-2.0
#include "node/variable_publisher.h"

#include <algorithm>
#include <string>

namespace slew::node {

using wire::Phase;
using wire::Topic;

void VariablePublisher::probe(SessionMember& member) {
  block_.header = member.header(Phase::join, kJoinStep);
  if (!member.is_acknowledged_on(Topic::variables)) member.publish(Topic::variables, block_);
}

void VariablePublisher::publish(SessionMember& member, StepIndex step) {
  if (built_.published_variables.empty()) return;
  values_.resize(built_.subsystem->variables().size());
  built_.subsystem->read_variables(values_);
  publish_blocks(member, step, Content::values);
}

void VariablePublisher::publish_shed(SessionMember& member, StepIndex step) {
  publish_blocks(member, step, Content::none);
}

void VariablePublisher::publish_blocks(SessionMember& member, StepIndex step, Content content) {
  const std::size_t total = built_.published_variables.size();
  for (std::size_t first = 0; first < total; first += wire::kMaxVariablesPerBlock) {
    const std::size_t count = std::min(wire::kMaxVariablesPerBlock, total - first);
    block_.header = member.header(Phase::running, step);
    block_.first = static_cast<std::uint32_t>(first);
    block_.values.resize(content == Content::values ? count : 0);
    for (std::size_t i = 0; i < block_.values.size(); ++i) {
      block_.values[i] = values_[built_.published_variables[first + i]];
    }
    member.publish(Topic::variables, block_);
  }
}

void VariablePublisher::publish_directory(SessionMember& member) const {
  const std::span<const ElementVariable> variables = built_.subsystem->variables();
  const std::size_t total = built_.published_variables.size();
  for (std::size_t first = 0; first < total || first == 0; first += wire::kMaxVariablesPerBlock) {
    wire::VariableDirectory directory;
    directory.header = member.header(Phase::running, 0);
    directory.total = static_cast<std::uint32_t>(total);
    directory.first = static_cast<std::uint32_t>(first);
    const std::size_t count = std::min(wire::kMaxVariablesPerBlock, total - first);
    for (std::size_t i = 0; i < count; ++i) {
      const ElementVariable& variable = variables[built_.published_variables[first + i]];
      directory.entries.push_back({variable.name, std::string(info(variable.dimension).si_unit)});
    }
    member.publish(Topic::variable_directory, directory);
  }
}

}  // namespace slew::node
