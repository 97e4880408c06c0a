// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/shared_volumes.h"

#include "math/relaxing_spring.h"

namespace slew::hydraulics_node {
namespace {

hydraulics::StateIndex volume_of(const hydraulics::Actuator& actuator, std::size_t side) noexcept {
  return side == 0 ? actuator.port_a : actuator.port_b;
}

double signed_area(const hydraulics::Actuator& actuator, std::size_t side, const double* y) noexcept {
  return actuator.setting_at(y) * (side == 0 ? actuator.area_a : -actuator.area_b);
}

}  // namespace

SharedVolumes::SharedVolumes(const hydraulics::Circuit& circuit) {
  const auto actuators = circuit.actuators();
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    for (std::size_t j = 0; j < actuators.size(); ++j) {
      for (const std::size_t side : {0u, 1u}) {
        for (const std::size_t other : {0u, 1u}) {
          const hydraulics::StateIndex volume = volume_of(actuators[i], side);
          if (i == j || volume != volume_of(actuators[j], other) || circuit.is_fixed(volume)) continue;
          pairs_.push_back({{i, side}, {j, other}});
        }
      }
    }
  }
}

void SharedVolumes::write(std::span<const hydraulics::ActuatorSprings> springs, const hydraulics::Circuit& circuit,
                          const double* y, double H, const coupling::PortArray& lambda,
                          coupling::PortMatrix& K_cross) const noexcept {
  const std::size_t m = lambda.size();
  K_cross.resize(m * m);
  for (double& K : K_cross) K = 0;
  for (const auto& [own, other] : pairs_) {
    const double area = signed_area(circuit.actuators()[own.port], own.side, y);
    if (area == 0) continue;
    const math::RelaxingSpring& spring = springs[own.port][own.side];
    const double share = math::remaining_share(spring.lambda * H) / math::remaining_share(lambda[own.port] * H);
    K_cross[own.port * m + other.port] +=
        spring.K * share * signed_area(circuit.actuators()[other.port], other.side, y) / area;
  }
}

double SharedVolumes::displacement_of_others(std::size_t port, std::size_t side, const hydraulics::Circuit& circuit,
                                             const double* y, std::span<const double> s) const noexcept {
  double sum = 0;
  for (const auto& [own, other] : pairs_) {
    if (own.port != port || own.side != side) continue;
    const double area = signed_area(circuit.actuators()[port], side, y);
    if (area != 0) sum += signed_area(circuit.actuators()[other.port], other.side, y) / area * s[other.port];
  }
  return sum;
}

}  // namespace slew::hydraulics_node
