// SPDX-License-Identifier: Apache-2.0
// Stiffness between ports whose chambers share a volume of oil, or have volumes that open passages join.
//
// A chamber c of port i has the area s_c, with the setting of a variable motor, negative on the side of B. Its volume
// answers the motion of all chambers d on it, so that port i feels port j by
//   K_cross_ij = sum_c k_c sum_d s_d / s_c,   k_c = s_c^2 / C                                        (1)
// with the chambers c of i and d of j on one volume. Over a step the springs k_c relax with their own rates and the
// port's copy of them with its one lambda (math/relaxing_spring.h); (1) has the change of the force at the end of a
// step: each k_c times a(l_c H) / a(lambda_i H). Where the circuit around the chambers matters over a step
// (hydraulics/step_response.h), its shares of the pressure's change stand for s_d/s_c.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "coupling/samples.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics_node {

class SharedVolumes {
 public:
  SharedVolumes(const hydraulics::Circuit& circuit, const hydraulics::HydraulicsDef& def);
  [[nodiscard]] bool any() const noexcept { return is_joined_ || !pairs_.empty(); }
  // (1) at the circuit's state y. circuit: like the one of the construction; springs: by port; response: null if the
  // circuit around the chambers takes no part; lambda: of all ports; H: time between two exchanges [s].
  void write(std::span<const hydraulics::ActuatorSprings> springs, const hydraulics::StepResponse* response,
             const hydraulics::Circuit& circuit, const double* y, double H, const coupling::PortArray& lambda,
             coupling::PortMatrix& K_cross) const noexcept;
  // Displacement of a chamber's own port that would change its volume as the displacements s of the other ports on it
  // do.
  [[nodiscard]] double displacement_of_others(std::size_t port, std::size_t side, const hydraulics::Circuit& circuit,
                                              const double* y, std::span<const double> s) const noexcept;

 private:
  struct Chamber {
    std::size_t port = 0;
    std::size_t side = 0;  // 0: A, 1: B
  };
  struct Pair {
    Chamber own, other;
  };
  bool is_joined_ = false;   // chambers of two ports, by passages
  std::vector<Pair> pairs_;  // of chambers of two ports on one volume, each in both orders
};

}  // namespace slew::hydraulics_node
