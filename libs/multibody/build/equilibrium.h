// SPDX-License-Identifier: Apache-2.0
// Static equilibrium of the joints that nothing holds, with actuators and stated coordinates where they are.
//
// C u = 0 are the speeds that keep all closing rows, prescribed motions, held rows and held coordinates. T is a basis
// of these speeds, scaled by the size of the mechanism, and x the displacement along it, after which the rows are
// closed again. With u'_free the accelerations of the mechanism at rest without row forces, M its mass matrix:
//   f = T^T M u'_free                 generalised force along x; forces of C do no work there                  (1)
//   (K + mu G) dx = f,  K = -df/dx,  G = T^T M T                                                               (2)
// mu >= 0 is the smallest of its steps for which (2) is positive definite, dx is at most kMostDisplacement, and the
// work (f_before + f_after) dx / 2 is positive: the potential falls until f = 0. The result is stable if K is positive
// (semi)definite; from an unstable equilibrium the search goes on beside it. M comes from the kinetic energy,
// v^T M w = (E(v + w) - E(v - w)) / 2; K from central differences.
// Source: Nocedal and Wright 2006, sections 3.4 and 18.4 (modified Newton on the null space of the constraints).
// A joint without force along it (a wheel, a slewing ring about the vertical, a ball about its rope) stays.
// Not covered: friction of joints, limits of joints, memory of contacts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "multibody/model/state.h"

namespace slew::multibody {

// A coordinate of a joint, as joint_axes.h counts them.
struct HeldCoordinate {
  int joint = 0;  // Model::joints
  int number = 0;
};

struct RestOptions {
  int held_rows = 0;                          // the first rows of the model, forces (lengths and angles)
  std::vector<HeldCoordinate> coordinates{};  // of revolute, prismatic, universal and cylindrical joints
  bool holds_floating_joints = false;
  // Modal coordinates without a given start move, and the joints that follow from them by the rows; joints that no row
  // moves stay. Not stable if the rows leave other joints free, or beyond a buckling load.
  bool moves_modes_alone = false;
};

struct RestSearch {
  bool is_stable = false;
  std::string joint{};      // otherwise: joint with the largest acceleration there, empty if the rows do not close
  double acceleration = 0;  // rad/s2 or m/s2, its own
  bool turns = false;       // the unit
};

// Moves state.q to the equilibrium near it; speeds are zero afterwards. Loops that are nearly closed at state.q
// are closed first; held lengths and angles keep the values that they have then.
// Allocates: not for a step.
[[nodiscard]] RestSearch find_rest(const Model& model, const RestOptions& options, State& state);

}  // namespace slew::multibody
