// SPDX-License-Identifier: Apache-2.0
// Forces over an interval in which the circuit does not stay what it is at its begin.
//
// The springs of a sample are those at its instant. Where a chamber comes into or out of its air or vapour within H,
// they are too stiff or too soft for the rest of it, and the mechanics gains or loses energy: a port of mobility W by
// about W H^2 dK / 6 of its speed. So a spring bends where, for a chamber that is about closed (lambda H < 0.1), of a
// port of a balanced level,
//   W H^2 s^2 |1/C' - 1/C| > 0.01,   |1/C' - 1/C| > 0.8 max(1/C', 1/C)                                 (1)
// with the capacity C' at the pressure farthest from the present one on u + u' t + u'' t^2/2, 0 < t <= H. Then, and for
// 0.2 s after it, but not within 0.2 s after a port had W H^2 K > 2 (omega_H 1.4), the circuit and the reduced
// mechanics are integrated over H once more before the sample is published. The springs of the chambers have their mean
// K over the interval, and the sample's F and F_dot are those of the straight line with which the foreseen motion has
// its impulse and its moment:
//   F H     + F_dot H^2 phi_2 - sum_j K_ij int r_ij dt         = int F* dt                            (2)
//   F H^2/2 + F_dot H^3 phi_3 - sum_j K_ij int r_ij (H - t) dt = int F* (H - t) dt                    (3)
// with F* of the foreseen interval, r_ij' = v_j - v_ref,j - lambda_i r_ij and phi_k(lambda_i H) of
// math/relaxing_spring.h. So a mechanism that is its reduced model ends the interval with the foreseen speed and
// position, whatever the force does within it. lambda is that of the sample, or where there is one, the larger one with
// which the line ends at
//   F + F_dot H phi_1 - sum_j K_ij r_ij(H) = F*(H)                                                    (4)
// as for a force that gets there early, of a chamber that empties. The end of a force that rises late is not followed,
// and the mechanics' copy is off by it until the next sample. A motion that differs from the foreseen one moves the
// force by K.
// Only if all ports are of level two, and in lockstep: the force of a late sample has no begin.
#pragma once

#include <span>
#include <vector>

#include "core/state_hash.h"
#include "coupling/port_levels.h"
#include "coupling/samples.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics_node/reduced_mechanics.h"

namespace slew::hydraulics_node {

class ForeseenForces {
 public:
  ForeseenForces(const hydraulics::Circuit& circuit, bool is_free_running);

  void reset() noexcept { bent_for_ = 0, fast_for_ = 0; }
  // Evaluates (1) for the H seconds from the integrator's state on. No allocation, as below.
  void follow(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
              const ReducedMechanics& mechanics, const coupling::PortLevels& levels, double H) noexcept;
  // (1) held in the last 0.2 s.
  [[nodiscard]] bool bends() const noexcept { return bent_for_ > 0; }
  // Integrates the H seconds where a spring bends. Springs, those of the instant before, take their means over H
  // seconds. False: nothing was changed, since no spring bends or the interval was not computed.
  [[nodiscard]] bool foresee(hydraulics::CircuitIntegrator& integrator, const ReducedMechanics& mechanics,
                             const coupling::PortLevels& levels, double H,
                             std::span<hydraulics::ActuatorSprings> springs) noexcept;
  // After foresee(): (2) to (4), from the sample's K, lambda and K_cross.
  void set_forces(double H, coupling::ActuatorSample& sample) const noexcept;

  // Nothing while no spring bends.
  void add_to(StateHash& hash) const noexcept {
    if (bends()) hash.add(bent_for_), hash.add(fast_for_);
  }
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes) {
    bytes.number(self.bent_for_);
    bytes.number(self.fast_for_);
  }

 private:
  [[nodiscard]] bool is_bent(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                             const ReducedMechanics& mechanics, const coupling::PortLevels& levels, double H) noexcept;

  struct Line {
    double F, F_dot, beyond;  // N, N/s; N, its end over the foreseen one
  };
  [[nodiscard]] static bool is_fast(const hydraulics::CircuitIntegrator& integrator, const ReducedMechanics& mechanics,
                                    double H) noexcept;
  [[nodiscard]] Line line(std::size_t port, double lambda, double H,
                          const coupling::ActuatorSample& sample) const noexcept;

  bool is_free_running_;
  double bent_for_ = 0, fast_for_ = 0;  // s, that are left
  hydraulics::ForeseenInterval ahead_;
  std::vector<double> y_;  // scratch
};

}  // namespace slew::hydraulics_node
