// SPDX-License-Identifier: Apache-2.0
// The truck crane with its slewing locked, linearised about its start pose: rigid bodies and a jib boom of Timoshenko
// beam elements with all their freedoms, cylinders as springs. Assembled from positions alone, by differences: it
// shares no code with the models that it judges, not even the elements. Numbers: scenes/truck_crane.yaml, scenes/beams.
#pragma once

#include <vector>

namespace slew::testing {

// Timoshenko beam: the jib boom's box of 300 mm with a wall of 2.139 mm.
struct BoxBeam {
  double youngs_modulus = 2e11, length = 6.5;  // Pa, m
  [[nodiscard]] double EI() const;
  [[nodiscard]] double EA() const;
  [[nodiscard]] double kGA() const;
  [[nodiscard]] double GJ() const;
  [[nodiscard]] double rho_A() const;  // kg/m
  [[nodiscard]] double rho_I() const;  // kg m
};

struct LinearCraneDef {
  double lift_stiffness = 0, jib_stiffness = 0;  // N/m, of the cylinders
  double payload = 500;                          // kg; the bag's inertia goes with it
  BoxBeam boom{};
  int elements = 24;
};

// Frequencies [Hz], ascending, without the bag's turning about the plumb line, which nothing holds.
[[nodiscard]] std::vector<double> linear_crane_frequencies(const LinearCraneDef& def);

// Frequencies [Hz] of a beam clamped at one end with a mass [kg] of a rotary inertia [kg m2] at the other, in one
// plane: roots of the exact transfer matrix.
[[nodiscard]] std::vector<double> loaded_beam_frequencies(const BoxBeam& beam, double mass, double rotary_inertia,
                                                          int count);

}  // namespace slew::testing
