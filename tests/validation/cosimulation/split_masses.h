// SPDX-License-Identifier: Apache-2.0
// Two masses with an oil column between them, in the place of the coupling spring of explicit_schemes.h: the mechanics
// with PortDynamics and sub-steps as the node has them, the oil exact, coupled by levels.
//
//   port x = x1 - x2, F' = -kc x' - lambda F, pushes m1 forward and m2 back
#pragma once

#include <array>

#include "coupling/level.h"
#include "coupling/port_dynamics.h"
#include "tests/validation/cosimulation/explicit_schemes.h"

namespace slew::cosimulation {

// The model of the masses in the oil's step.
enum class Known { speed_held, mobility_of_the_instant, mobility_of_the_step };
enum class Force { held, linear };

struct Scheme {
  Force mechanics = Force::linear;
  Known oil = Known::mobility_of_the_instant;
};
inline constexpr Scheme kHold{Force::held, Known::speed_held}, kLinear{Force::linear, Known::speed_held},
    kTwo{Force::linear, Known::mobility_of_the_instant}, kTwoOverStep{Force::linear, Known::mobility_of_the_step};

class SplitMasses {
 public:
  SplitMasses(const TwoMasses& of, double lambda, Scheme scheme, double H, double max_substep);

  void step();
  [[nodiscard]] const State& state() const { return y_; }
  [[nodiscard]] double force() const { return oil_[0]; }  // N, at the oil's own place

 private:
  struct Reduced {
    double a_free, W;
  };
  [[nodiscard]] Reduced reduced(double over) const;
  [[nodiscard]] State rate(const State& y, double F) const;
  void move_masses();
  void move_oil(double x, double v, const Reduced& known);

  TwoMasses of_;
  double lambda_, H_;
  Scheme scheme_;
  int substeps_;
  State y_ = kStart;
  std::array<double, 3> oil_;  // F [N], x [m], v [m/s]
  double F_ = 0;               // N, the mechanics' copy
  coupling::PortDynamics port_{1};
};

// The same without a split: x1, v1, x2, v2 after a time.
[[nodiscard]] State exact_with_oil(const TwoMasses& of, double lambda, double time);

}  // namespace slew::cosimulation
