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
  std::vector<double> weights(circuit_.actuators().size(), 0.0);
  weights[port] = direction;
  return of_command(port, direction, best_command(weights));
}

std::size_t LargestForces::best_command(std::span<const double> weights) const {
  const auto sum = [&](std::size_t command) {
    double of_ports = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) of_ports += weights[i] * stalls_[command].forces[i];
    return of_ports;
  };
  std::size_t best = 0;
  for (std::size_t c = 1; c < stalls_.size(); ++c) {
    if (sum(c) > sum(best)) best = c;
  }
  return best;
}

LargestForce LargestForces::of_command(std::size_t port, double direction, std::size_t command) const {
  LargestForce largest;
  largest.command = command;
  const hydraulics::Stall& best = stalls_[command];
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

int LargestForces::shared_volume(std::size_t port, std::size_t other) const {
  const hydraulics::Actuator &one = circuit_.actuators()[port], &two = circuit_.actuators()[other];
  for (const int volume : {one.port_a, one.port_b}) {
    if (!circuit_.is_fixed(volume) && (volume == two.port_a || volume == two.port_b)) return volume;
  }
  return -1;
}

bool LargestForces::is_held(int volume, std::size_t command) {
  const auto [found, is_new] = is_held_.try_emplace({command, volume}, true);
  if (is_new) {
    found->second =
        hydraulics::unheld_volumes(scene_.hydraulics, strokes_, commands_[command].held, {&volume, 1}).empty();
  }
  return found->second;
}

int LargestForces::unheld_between(std::size_t port, std::size_t other, double direction, std::size_t command) {
  if (port == other) return -1;
  const hydraulics::Actuator &one = circuit_.actuators()[port], &two = circuit_.actuators()[other];
  const int loaded = direction > 0 ? one.port_a : one.port_b;
  for (const int volume : {one.port_a, one.port_b}) {
    const bool is_shared = volume == two.port_a || volume == two.port_b;
    const bool is_between =
        (volume == one.port_a && volume == two.port_b) || (volume == one.port_b && volume == two.port_a);
    if (!is_shared || circuit_.is_fixed(volume) || !(is_between || volume == loaded)) continue;
    if (!is_held(volume, command)) return volume;
  }
  return -1;
}

}  // namespace slew::analysis
