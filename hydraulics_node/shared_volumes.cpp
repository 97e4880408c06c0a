// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/shared_volumes.h"

#include "core/index.h"
#include "hydraulics/pump_lines.h"
#include "math/relaxing_spring.h"

namespace slew::hydraulics_node {
SharedVolumes::SharedVolumes(const hydraulics::Circuit& circuit, const hydraulics::HydraulicsDef& def) {
  const auto actuators = circuit.actuators();
  const std::vector<int> groups = hydraulics::joined_by_passages(def);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    for (std::size_t j = 0; j < actuators.size(); ++j) {
      for (const std::size_t side : {0u, 1u}) {
        for (const std::size_t other : {0u, 1u}) {
          const hydraulics::StateIndex volume = actuators[i].volume(side);
          const hydraulics::StateIndex others = actuators[j].volume(other);
          if (i == j || circuit.is_fixed(volume)) continue;
          if (volume == others) pairs_.push_back({{i, side}, {j, other}});
          is_joined_ |= groups[at(volume)] == groups[at(others)];
        }
      }
    }
  }
}

void SharedVolumes::write(std::span<const hydraulics::ActuatorSprings> springs,
                          const hydraulics::StepResponse* response, const hydraulics::Circuit& circuit, const double* y,
                          double H, const coupling::PortArray& lambda, coupling::PortMatrix& K_cross) const noexcept {
  const std::size_t m = lambda.size();
  K_cross.resize(m * m);
  for (double& K : K_cross) K = 0;
  const auto change_at_end = [&](std::size_t port, std::size_t side) {
    const math::RelaxingSpring& spring = springs[port][side];
    return spring.K * (math::remaining_share(spring.lambda * H) / math::remaining_share(lambda[port] * H));
  };
  for (std::size_t i = 0; i < m && response != nullptr; ++i) {
    for (const std::size_t side : {0u, 1u}) {
      if (springs[i][side].K == 0) continue;
      const double change = change_at_end(i, side);
      for (std::size_t j = 0; j < m; ++j) {
        if (j != i) K_cross[i * m + j] += change * response->share_of(i, side, j);
      }
    }
  }
  if (response != nullptr) return;
  for (const auto& [own, other] : pairs_) {
    const double area = circuit.actuators()[own.port].signed_area(own.side, y);
    if (area == 0) continue;
    K_cross[own.port * m + other.port] +=
        change_at_end(own.port, own.side) * circuit.actuators()[other.port].signed_area(other.side, y) / area;
  }
}

double SharedVolumes::displacement_of_others(std::size_t port, std::size_t side, const hydraulics::Circuit& circuit,
                                             const double* y, std::span<const double> s) const noexcept {
  double sum = 0;
  for (const auto& [own, other] : pairs_) {
    if (own.port != port || own.side != side) continue;
    const double area = circuit.actuators()[port].signed_area(side, y);
    if (area != 0) sum += circuit.actuators()[other.port].signed_area(other.side, y) / area * s[other.port];
  }
  return sum;
}

}  // namespace slew::hydraulics_node
