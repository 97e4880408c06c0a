// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/variable_values.h"

#include "io_node/input_gate.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

// The first of kChannelVariables: raw, control, age. The others belong to a controller.
constexpr std::size_t kMeasuredOfInput = 3;

}  // namespace

std::vector<ElementVariable> variables_of_run(const scene::Scene& scene, const session::DirectSession& session) {
  std::vector<ElementVariable> all;
  for (const wire::Role role : transport::physics_roles()) {
    if (session.subsystem(role) == nullptr) continue;
    const std::span<const ElementVariable> own = session.subsystem(role)->variables();
    all.insert(all.end(), own.begin(), own.end());
  }
  for (const scene::InputDef& input : scene.inputs) {
    for (std::size_t k = 0; k < kMeasuredOfInput; ++k) {
      all.push_back({input.name + io_node::kChannelVariables[k].quantity, Dimension::none});
    }
  }
  return all;
}

VariableValues::VariableValues(const PlayedScene& played) : played_(played) {
  std::size_t size = played.inputs().size() * kMeasuredOfInput;
  for (const wire::Role role : transport::physics_roles()) {
    const coupling::Subsystem* subsystem = played.session().subsystem(role);
    if (subsystem != nullptr) size += subsystem->variables().size();
  }
  values_.resize(size);
}

std::span<const double> VariableValues::read() {
  std::span<double> rest = values_;
  for (const wire::Role role : transport::physics_roles()) {
    const coupling::Subsystem* subsystem = played_.session().subsystem(role);
    if (subsystem == nullptr) continue;
    const std::size_t count = subsystem->variables().size();
    subsystem->read_variables(rest.first(count));
    rest = rest.subspan(count);
  }
  const io_node::InputGate& inputs = played_.inputs();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    rest[0] = inputs.raw(i);
    rest[1] = inputs.control(i);
    rest[2] = static_cast<double>(inputs.age(i));
    rest = rest.subspan(kMeasuredOfInput);
  }
  return values_;
}

bool VariableValues::has_failed() const noexcept {
  const session::DirectSession& session = played_.session();
  return session.report(wire::Role::mechanics).has_failed() || session.report(wire::Role::hydraulics).has_failed();
}

bool VariableValues::has_converged() const noexcept {
  const session::DirectSession& session = played_.session();
  return !session.report(wire::Role::mechanics).has(StepFlag::not_converged) &&
         !session.report(wire::Role::hydraulics).has(StepFlag::not_converged);
}

}  // namespace slew::analysis
