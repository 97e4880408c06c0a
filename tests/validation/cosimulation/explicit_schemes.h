// SPDX-License-Identifier: Apache-2.0
// The classic explicit co-simulation schemes on two masses and three springs, which levels are judged beside: held
// values, each half exact within the step (Gonzalez et al., benchmark of two oscillators; cases E01 and E02).
//
//   wall -- k1, c1 -- m1 -- kc, cc -- m2 -- k2, c2 -- wall
#pragma once

#include <Eigen/Core>

namespace slew::cosimulation {

struct TwoMasses {
  double m1 = 1, m2 = 1;                // kg
  double k1 = 10, kc = 100, k2 = 1000;  // N/m
  double c1 = 0, cc = 0, c2 = 0;        // N s/m
};

using State = Eigen::Vector4d;  // x1, v1, x2, v2
using Map = Eigen::Matrix4d;

inline const State kStart(0, 100, 0, -100);

// Values held over a step. force_displacement: the half of m1 has the coupling and holds (x2, v2), that of m2 holds its
// force; displacement_displacement: both have it, and hold the other's place and speed.
enum class Coupling { force_displacement, displacement_displacement };
// Order of the two sides: the first steps with the values at the start of the step, the second with those at its end.
enum class Order { jacobi, first_2_then_1, first_1_then_2 };

[[nodiscard]] Map exact_map(const TwoMasses& of, double H);
[[nodiscard]] Map step_map(const TwoMasses& of, Coupling coupling, Order order, double H);

[[nodiscard]] double spectral_radius(const Map& map);
[[nodiscard]] double energy(const TwoMasses& of, const State& state);  // J
[[nodiscard]] State after(const Map& map, int steps, State state = kStart);

}  // namespace slew::cosimulation
