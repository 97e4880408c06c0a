// SPDX-License-Identifier: Apache-2.0
// Chambers that empty before the next exchange.
//
// The mechanics continues the force of a port by its springs (hydraulics/circuit_integrator.h, (2)), which have no
// vacuum: a chamber of 20 bar that empties within a fifth of a step would pull with 100 bar at its end. Where F_dot
// alone takes a chamber below the pressure floor within H, the ports' motion is foreseen by the reduced mechanics,
//   s'' = a + W dF,   dF_i = sum_c (F_dot_c t - k_c (s_i + sum_d s_d/s_c s_j))                       (1)
// with the displacements s beyond that of the present speeds, the chambers c of port i and those d of other ports on
// the same volume (shared_volumes.h), the leakage of the springs left out. A chamber whose change of force reaches that
// of the floor at t_0 < H gets the spring that ends there (math/relaxing_spring.h, (2)) after the foreseen motion.
#pragma once

#include <span>
#include <vector>

#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics_node/reduced_mechanics.h"
#include "hydraulics_node/shared_volumes.h"

namespace slew::hydraulics_node {

class EmptyingChambers {
 public:
  explicit EmptyingChambers(std::size_t ports) : ports_(ports) {}

  // Ends the springs of all ports, over H seconds from the integrator's state on, where their chambers empty. No
  // allocation.
  void end_springs(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                   const SharedVolumes& shared, const ReducedMechanics& mechanics, double H,
                   std::span<hydraulics::ActuatorSprings> springs) noexcept;

 private:
  struct Port {
    double a = 0;              // m/s2, at the begin
    double u = 0, s = 0;       // beyond the present speed
    double dF[3] = {0, 0, 0};  // N, of its springs
    double way[2] = {0, 0};    // m, s of chamber A or B with those of the others on its volume
    double t_0[2] = {0, 0};    // s, when it has emptied; 0: not yet
  };
  void foresee(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
               const SharedVolumes& shared, const ReducedMechanics& mechanics, double H,
               std::span<const hydraulics::ActuatorSprings> springs) noexcept;

  std::vector<Port> ports_;
};

}  // namespace slew::hydraulics_node
