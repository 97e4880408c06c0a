// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/largest_force.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coupling/line_force.h"

namespace slew::analysis {
namespace {

constexpr double kCreep = 0.05;  // m/s, up to which the largest friction counts: the load has to begin to move
constexpr int kCreepPoints = 50;

// largest friction on the way to kCreep [N]
double largest_friction(const coupling::LineForceLaw& law, double F, double direction) {
  double largest = 0;
  // in equal ratios, since breaking away takes place at a tenth of a millimetre a second
  for (int k = 0; k <= kCreepPoints; ++k) {
    const double v = kCreep * std::exp2(-0.25 * k);
    largest = std::max(largest, std::fabs(law.friction(F, direction * v)));
  }
  return largest;
}

}  // namespace

LargestForces::LargestForces(const scene::Scene& scene, std::vector<double> strokes)
    : scene_(scene), circuit_(scene.hydraulics), strokes_(std::move(strokes)) {
  find_commands();
  for (std::size_t c = 0; c < commands_.size(); ++c) stalls_.push_back(stall(c));
}

// every input at full stick in both directions; the neutral circuit without inputs
void LargestForces::find_commands() {
  for (const scene::InputDef& input : scene_.inputs) {
    const int control = circuit_.find_control(input.primitive);
    if (control < 0) continue;
    for (const double stick : {1.0, -1.0}) {
      if (stick < 0 && input.type == scene::InputType::digital) continue;
      commands_.push_back({input.name, stick, {control, stick * input.scale}});
    }
  }
  if (commands_.empty()) commands_.push_back({});
}

hydraulics::Stall LargestForces::stall(std::size_t command) const {
  return hydraulics::find_stall(scene_.hydraulics, strokes_, commands_[command].held);
}

LargestForce LargestForces::of(std::size_t port, double direction) const {
  LargestForce largest;
  for (std::size_t c = 1; c < stalls_.size(); ++c) {
    if (direction * stalls_[c].forces[port] > direction * stalls_[largest.command].forces[port]) largest.command = c;
  }
  const hydraulics::Stall& best = stalls_[largest.command];
  const hydraulics::Actuator& actuator = circuit_.actuators()[port];
  const int chamber = direction > 0 ? actuator.port_a : actuator.port_b;
  largest.chamber = circuit_.volume_name(chamber);
  largest.pressure = best.pressures[static_cast<std::size_t>(chamber)];
  largest.input = commands_[largest.command].input;
  largest.stick = commands_[largest.command].stick;
  largest.is_steady = best.is_steady;
  const coupling::LineForceLaw law(scene_.ports[port].line_force);
  const double F = best.forces[port];
  // friction reduces the force and does not reverse it
  largest.force = F - direction * std::min(std::fabs(F), largest_friction(law, F, direction));
  return largest;
}

}  // namespace slew::analysis
