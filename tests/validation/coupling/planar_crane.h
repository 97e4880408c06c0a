// SPDX-License-Identifier: Apache-2.0
// The truck crane in the plane of its booms, written from the machine's published numbers alone: no code, no table and
// no integrator of the libraries, so that agreement supports both.
//
//   mechanics   lift boom, jib boom with attachment and hook, bag as a pendulum; absolute angles theta_k about +z.
//               A body's centre is H + sum_k R(theta_k) r_k;  M theta'' = sum J^T m (g - J' theta') + torques + F
//               dL/dtheta
//   cylinders   F = p_A A_A - p_B A_B less friction, as in the cylinders' card
//   chambers    C p' = Q,  C = V_cyl (kappa(p) + 1/B_cyl) + V_hose (kappa(p) + 1/B_hose)
//   valves      closed: leaks to tank and across the piston, anti-cavitation
//
// Fourth-order Runge-Kutta at 20 us, where halving moves the bag by less than 1 um. Not covered: slewing, dummies, end
// stops, pump and spools, shock valves, pressures below the cavitation floor.
#pragma once

#include <array>

namespace slew::coupling::test {

class PlanarCrane {
 public:
  // Both booms at their start pose, at rest, all chambers at the absolute pressure p [Pa]; air: share at 1 bar.
  PlanarCrane(double p, double air);

  void advance(double seconds);

  [[nodiscard]] double bag_height() const;                        // m, centre of mass above ground
  [[nodiscard]] double lift_pressure_a() const { return y_[6]; }  // Pa absolute
  [[nodiscard]] double lift_pressure_b() const { return y_[7]; }
  [[nodiscard]] double jib_pressure_a() const { return y_[8]; }
  [[nodiscard]] double jib_pressure_b() const { return y_[9]; }

 private:
  // theta of lift boom, jib, bag; their rates; p of lift A, lift B, jib A, jib B
  using State = std::array<double, 10>;

  [[nodiscard]] State rates(const State& y) const;
  [[nodiscard]] std::array<double, 3> accelerations(const State& y, const std::array<double, 3>& torque) const;
  [[nodiscard]] double kappa(double p) const;

  double air_;
  State y_;
};

}  // namespace slew::coupling::test
