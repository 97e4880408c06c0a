// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/emptying_chambers.h"

#include <algorithm>
#include <array>

namespace slew::hydraulics_node {
namespace {

using coupling::kMaxPorts;

constexpr int kParts = 32;  // of H; stable to omega H = 64

double at_empty(const hydraulics::ActuatorLinearisation& actuator, std::size_t side) noexcept {
  return side == 0 ? actuator.empty_a : actuator.empty_b;
}

// How much of the way to the pressure floor a change of force goes; below 0: away from it.
double way_to_empty(double change, double at_empty) noexcept {
  return at_empty != 0 ? change / at_empty : 0;
}

}  // namespace

void EmptyingChambers::end_springs(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                                   const SharedVolumes& shared, const ReducedMechanics& mechanics, double H,
                                   std::span<hydraulics::ActuatorSprings> springs) noexcept {
  const std::span<const hydraulics::ActuatorLinearisation> actuators = integrator.actuators();
  bool may_empty = false;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      may_empty |= way_to_empty(springs[i][side].F_dot * H, at_empty(actuators[i], side)) > 1;
    }
  }
  if (!may_empty || !mechanics.has_sample()) return;
  foresee(integrator, circuit, shared, mechanics, H, springs);
  for (std::size_t i = 0; i < springs.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (ports_[i].t_0[side] == 0) continue;
      math::RelaxingSpring& spring = springs[i][side];
      spring = math::ended_at(spring, at_empty(actuators[i], side), ports_[i].t_0[side], H);
      // t_0 has the foreseen motion already
      spring.F_dot += spring.K * ports_[i].way[side] / H;
    }
  }
}

// (1) by the leapfrog method
void EmptyingChambers::foresee(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                               const SharedVolumes& shared, const ReducedMechanics& mechanics, double H,
                               std::span<const hydraulics::ActuatorSprings> springs) noexcept {
  const std::span<const hydraulics::ActuatorLinearisation> actuators = integrator.actuators();
  const std::size_t m = ports_.size();
  std::array<double, kMaxPorts> F{}, x{}, v{}, a{}, s{};
  for (std::size_t i = 0; i < m; ++i) F[i] = actuators[i].F, x[i] = actuators[i].x, v[i] = actuators[i].v;
  mechanics.free_accelerations(F.data(), x.data(), v.data(), a.data());
  for (std::size_t i = 0; i < m; ++i) {
    ports_[i] = Port{};
    ports_[i].a = a[i];
  }
  const double h = H / kParts;
  for (int part = 0; part < kParts; ++part) {
    for (std::size_t i = 0; i < m; ++i) {
      Port& port = ports_[i];
      port.u += (part == 0 ? 0.5 : 1.0) * h * a[i];
      port.s += h * port.u;
      s[i] = port.s;
    }
    const double t = (part + 1) * h;
    for (std::size_t i = 0; i < m; ++i) {
      Port& port = ports_[i];
      for (std::size_t side = 0; side < 3; ++side) {
        const math::RelaxingSpring& spring = springs[i][side];
        if (side == 2) {
          port.dF[side] = spring.F_dot * t - spring.K * port.s;
          continue;
        }
        port.way[side] = port.s + shared.displacement_of_others(i, side, circuit, integrator.state().data(), s);
        const double before = port.dF[side];
        port.dF[side] = spring.F_dot * t - spring.K * port.way[side];
        const double end = at_empty(actuators[i], side), way = way_to_empty(port.dF[side], end);
        if (port.t_0[side] == 0 && way >= 1) {
          const double way_before = way_to_empty(before, end);
          port.t_0[side] = t - h * (way - 1) / std::max(way - way_before, 1e-300);
        }
        if (port.t_0[side] != 0) port.dF[side] = end;
      }
    }
    for (std::size_t i = 0; i < m; ++i) {
      a[i] = ports_[i].a;
      for (std::size_t j = 0; j < m; ++j) {
        a[i] += mechanics.W(i, j) * (ports_[j].dF[0] + ports_[j].dF[1] + ports_[j].dF[2]);
      }
    }
  }
}

}  // namespace slew::hydraulics_node
