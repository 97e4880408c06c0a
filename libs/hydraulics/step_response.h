// SPDX-License-Identifier: Apache-2.0
// Springs of the actuators over an interval, with the circuit around their chambers.
//
// At an instant a chamber is a spring that relaxes with -(dQ/dp)/C, all else held (circuit_integrator.h, (2)). Over an
// interval H a volume with little room behind a passage fills, and an accumulator its gas: the oil that left the
// chamber is still there. Under speeds that differ from v_ref by u_j the pressures and the states of components change
// by
//   C_i dy_i' = -sum_k G_ik dy_k - sum_j s_ij u_j,   G = -dQ/dy                                                   (1)
// with the area s_ij of actuator j at volume i, negative at B; C = 1 and Q = y' of a component's state. What the
// circuit around a chamber changes of its response is (1) with all of G less (1) with its diagonal, both by one step of
// sdirk2, whose error is common to them,
//   (I + g X) k_1 = b,  (I + g X) k_2 = b - (1 - g) X k_1,   X = H C^-1 G,  g = 1 - 1/sqrt 2
//   dy(H) = H ((1 - g) k_1 + g k_2),   int dy dt = H^2 (2 g (1 - g) k_1 + g^2 k_2)                                 (2)
// with b = -s_j/C for a motion and b = y' at v_ref for F_dot. It is added to the exact response of the chamber alone
// (math/relaxing_spring.h, (1)). Volumes in vapour are held.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "hydraulics/circuit.h"
#include "math/pattern_lu.h"
#include "math/relaxing_spring.h"

namespace slew::hydraulics {

// chamber A, chamber B, brake or stop between two stages
using ActuatorSprings = std::array<math::RelaxingSpring, 3>;

class StepResponse {
 public:
  // circuit outlives this. Allocates; nothing else does.
  explicit StepResponse(const Circuit& circuit);

  // Changes the springs of chambers at the instant of y to those over H seconds. outflow, C, f: -dQ/dp, capacities and
  // rates at y, the flow slopes of the circuit too. False: the circuit around matters to no chamber within H, and
  // nothing was changed.
  [[nodiscard]] bool take_part(const double* y, std::span<const double> outflow, std::span<const double> C,
                               std::span<const double> f, double H, std::span<ActuatorSprings> springs) noexcept;
  // After take_part() was true: change of the pressure in chamber A (0) or B (1) at the end of H by a motion of another
  // actuator, over that by the same motion of its own.
  [[nodiscard]] double share_of(std::size_t actuator, std::size_t side, std::size_t other) const noexcept;

 private:
  struct Response {
    std::vector<double> end, integral;  // by state, over H and H^2
  };
  struct Chamber {
    std::size_t volume;
    std::vector<std::size_t> neighbours;  // states that move its flow and that its pressure moves
  };
  [[nodiscard]] bool is_held(std::size_t state, const double* y, std::span<const double> C) const noexcept;
  [[nodiscard]] double capacity(std::size_t state, std::span<const double> C) const noexcept {
    return state < C.size() ? C[state] : 1;
  }
  [[nodiscard]] bool is_significant(const double* y, std::span<const double> outflow, std::span<const double> C,
                                    double H) const noexcept;
  void respond(Response& response) noexcept;

  const Circuit& circuit_;
  std::size_t n_;                                          // states
  std::vector<std::pair<std::size_t, std::size_t>> ways_;  // state and another that moves it
  std::vector<Chamber> chambers_;
  std::vector<char> is_held_;
  std::vector<double> matrix_;  // -g X
  math::PatternLu lu_;
  std::vector<double> b_, k_1_, k_2_;
  std::vector<Response> by_actuator_;
  Response at_reference_;  // to y'
};

}  // namespace slew::hydraulics
