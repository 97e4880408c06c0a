// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/mechanics_cost.h"

#include <algorithm>

#include "analysis/description/timed_call.h"
#include "multibody/formulations/formulation.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace {

// the sampled coordinates in a model that may have fewer modes
multibody::State state_of(const multibody::Model& model, const multibody::Model& sampled,
                          const multibody::State& from) {
  multibody::State state = multibody::start_state(model);
  const auto joints = [](const multibody::Model& one, int multibody::FlexiblePart::*first, std::size_t all) {
    std::size_t count = all;
    for (const multibody::FlexiblePart& part : one.parts) {
      if (part.modes > 0) count = std::min(count, static_cast<std::size_t>(part.*first));
    }
    return count;
  };
  std::copy_n(from.q.begin(), joints(sampled, &multibody::FlexiblePart::q, from.q.size()), state.q.begin());
  std::copy_n(from.u.begin(), joints(sampled, &multibody::FlexiblePart::u, from.u.size()), state.u.begin());
  for (const multibody::FlexiblePart& part : model.parts) {
    for (const multibody::FlexiblePart& other : sampled.parts) {
      if (other.name != part.name || other.modes != part.modes) continue;
      std::copy_n(from.q.begin() + other.q, part.modes, state.q.begin() + part.q);
      std::copy_n(from.u.begin() + other.u, part.modes, state.u.begin() + part.u);
    }
  }
  state.time = from.time;
  return state;
}

}  // namespace

MechanicsSample sample(const mechanics_node::MechanicsSubsystem& mechanics, const scene::Scene& scene) {
  MechanicsSample sample{mechanics.state(), {}};
  std::vector<double> values(mechanics.variables().size());
  mechanics.read_variables(values);
  for (const scene::PortDef& port : scene.ports) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (mechanics.variables()[i].name == port.name + ".line_force")
        sample.port_force.push_back(port.ratio * values[i]);
    }
  }
  return sample;
}

MechanicsCalls time_mechanics(const MechanicsVariant& variant, std::span<const MechanicsSample> samples) {
  const scene::Scene& scene = *variant.scene;
  multibody::MechanicsDef def = scene.mechanics;
  std::erase_if(def.contacts, [&](const auto& pair) { return pair.name == variant.left_out; });
  const multibody::Model model = multibody::build_model(def, scene::row_names(scene));
  const double H = scene.session.step;
  const int substeps = multibody::substep_count(model, H);
  const multibody::StepRule rule = multibody::step_rule(def);
  multibody::Workspace ws(model);
  std::vector<double> force(model.rows.size()), slope(model.rows.size());
  MechanicsCalls calls;
  for (const MechanicsSample& one : samples) {
    multibody::State start = state_of(model, *variant.sampled, one.state);
    std::copy(one.port_force.begin(), one.port_force.end(), force.begin());
    multibody::Dynamics dynamics(def.formulation, model, start, rule);
    calls.evaluate += substeps * fastest_of([&] { dynamics.evaluate(model, start, ws); });
    calls.observe += fastest_of([&] { multibody::observe(model, start, ws); });
    // each sub-step restarts: states integrated beside the mechanism's must not carry over
    std::int64_t fastest = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < kCalls; ++i) {
      multibody::State state = start;
      multibody::Dynamics fresh(def.formulation, model, state, rule);
      fresh.evaluate(model, state, ws);
      const std::int64_t begin = monotonic_ns();
      static_cast<void>(fresh.advance(model, state, ws, H / substeps, force, slope));
      fastest = std::min(fastest, monotonic_ns() - begin);
    }
    calls.advance += substeps * static_cast<double>(fastest);
  }
  const double count = std::max<double>(1, static_cast<double>(samples.size()));
  return {calls.evaluate / count, calls.advance / count, calls.observe / count};
}

}  // namespace slew::analysis
