// SPDX-License-Identifier: Apache-2.0
// The scene's equations about one state: A = df/dy of scene_equations.h (2) to (5), and its eigenvalues.
//
// A by central differences of 1e-5 of each state's scale. At a corner of a law (a check valve about to open, a piston
// at rest in its friction) the two sides count half each. States that are not free are left out: fixed pressures,
// prescribed coordinates, work and impulse of ports. Coordinates that loops make dependent stay in: they add
// eigenvalues of zero, which are counted as at rest.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "monolith/eigenmodes.h"
#include "monolith/scene_equations.h"

namespace slew::monolith {

struct OwnerShare {
  StateOwner owner;
  double share = 0;  // 0 to 1
};

struct SceneMode {
  std::complex<double> value;      // 1/s
  int count = 1;                   // multiplicity
  std::vector<OwnerShare> owners;  // largest share first
};

struct SceneModes {
  std::vector<SceneMode> modes;  // fastest first
  int at_rest = 0;               // eigenvalues slower than kSlowestRate
  int states = 0;                // number of free states
};

enum class Part : unsigned char { all, mechanics_with_held_rows };

// Linearises at the state y and time t. mechanics_with_held_rows: coordinates and speeds alone, with the forces of
// cylinders, joint friction and limits held: the problem of the mechanics' integrator, since the port problem solves
// those implicitly. Error: the eigenvalue iteration failed, or y is not finite.
Status find_modes(SceneEquations& equations, double t, std::span<const double> y, Part part, SceneModes& result);

}  // namespace slew::monolith
