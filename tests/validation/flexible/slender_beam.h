// SPDX-License-Identifier: Apache-2.0
// Cantilever of Euler's theory with the loads of a limit case, by shooting: the reference of the extremes. Independent
// of the libraries.
//
//   (E I w'')'' - (T w')' - rho A omega^2 w = f,   T = -P + rho A Omega^2 (L^2 - x^2)/2 + m Omega^2 L        (1)
//   w = w' = 0 at the root;  M = E I w'' = 0,  S = M' - T w' = -m omega^2 w at the tip                       (2)
// P: compression by a load that keeps its direction; Omega: spin about an axis across the root, w along that axis;
// m: mass at the tip, f: load by length.
#pragma once

#include <array>

namespace slew::testing {

struct SlenderBeam {
  double length = 1, EI = 1, rho_A = 1;            // m, N m2, kg/m
  double compression = 0, spin = 0, tip_mass = 0;  // N, rad/s, kg

  [[nodiscard]] double euler_load() const;  // pi^2 E I/(4 L^2) [N]
  // omega^2 of the lowest mode, negative beyond buckling [1/s2]
  [[nodiscard]] double lowest_square() const;
  [[nodiscard]] double tip_under(double load) const;  // w at the tip under f = load [m]

 private:
  struct End {
    double w = 0, M = 0, S = 0;  // at the tip
  };
  [[nodiscard]] End shoot(double square, double load, double M_root, double S_root) const;
  [[nodiscard]] double determinant(double square) const;
};

// Euler's elastica: tip deflection over length of a cantilever under `ratio` of its buckling load, > 1.
//   sqrt(ratio) = 2 K(p)/pi,  w/L = 2 p/K(p)                                                              (3)
[[nodiscard]] double elastica_tip(double ratio);

}  // namespace slew::testing
