// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/mechanics_variables.h"

#include <algorithm>
#include <utility>

#include "coupling/static_forces.h"
#include "multibody/results/observe.h"

namespace slew::mechanics_node {
namespace {

// Line forces that would hold the ports at rest: W F = -a_free; zero where there are none.
coupling::PortArray holding_forces(const coupling::MechanismSample& sample, std::size_t ports) noexcept {
  coupling::PortArray F;
  F.resize(ports);
  if (!coupling::static_forces(sample.W.span(), sample.a_free.span(), F.span())) std::fill(F.begin(), F.end(), 0.0);
  return F;
}

}  // namespace

MechanicsVariables::MechanicsVariables(const multibody::Model& model, const std::vector<Port>& ports, int payload,
                                       bool has_partner_age)
    : list_(multibody::variables(model)),
      of_model_(list_.size()),
      payload_(payload),
      has_partner_age_(has_partner_age) {
  for (ElementVariable& variable : multibody::reaction_variables(model)) list_.push_back(std::move(variable));
  of_reactions_ = list_.size() - of_model_;
  for (const Port& port : ports) {
    const coupling::PortDimensions dimensions = coupling::dimensions_of(port.unit);
    for (const char* force : {".line_force", ".friction_force", ".end_stop_force", ".static_force"}) {
      list_.push_back({port.name + force, dimensions.force});
    }
    list_.push_back({port.name + ".static_force_per_kg", dimensions.force_per_mass});
    if (port.law.has_cushion()) list_.push_back({port.name + ".cushion_force", dimensions.force});
  }
  if (has_partner_age) list_.push_back({"mechanics.partner_age", Dimension::none});
  if (payload > 0) {
    list_.push_back({model.bodies[static_cast<std::size_t>(payload)].name + ".mass", Dimension::mass});
  }
}

MechanicsVariables::Work::Work(const multibody::Model& model, PayloadSensitivity sensitivity)
    : payload(std::move(sensitivity)), workspace(model), reactions(model.joints.size()) {}

void MechanicsVariables::read(const Instant& instant, Work& work, std::span<double> values) const noexcept {
  const multibody::Model& model = instant.mechanism.model();
  const multibody::State& state = instant.mechanism.state();
  multibody::read_variables(model, state, instant.mechanism.observed(), instant.row_force, values.first(of_model_));
  multibody::joint_reactions(model, state, work.workspace, instant.row_force, work.reactions);
  multibody::read_reactions(model, work.workspace, instant.row_force, work.reactions,
                            values.subspan(of_model_, of_reactions_));
  std::size_t k = of_model_ + of_reactions_;
  const std::size_t m = instant.ports.size();
  const double mass = payload_ > 0 ? mass_of(model, payload_) : 0;
  coupling::PortArray slopes;
  slopes.resize(m);
  work.payload.read(state, mass, work.workspace, slopes.span());
  const coupling::PortArray static_force = holding_forces(instant.published, m);
  for (std::size_t i = 0; i < m; ++i) {
    values[k++] = instant.published.F_line[i];
    values[k++] = instant.ports[i].friction;
    values[k++] = instant.ports[i].stop;
    values[k++] = static_force[i];
    values[k++] = slopes[i];
    const coupling::LineForceLaw& law = instant.ports[i].law;
    if (law.has_cushion()) values[k++] = law.cushion_force(instant.published.x[i], instant.published.v[i]);
  }
  if (has_partner_age_) values[k++] = static_cast<double>(instant.partner_age);
  if (payload_ > 0) values[k++] = mass;
}

}  // namespace slew::mechanics_node
