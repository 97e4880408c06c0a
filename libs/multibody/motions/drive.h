// SPDX-License-Identifier: Apache-2.0
// A joint coordinate that follows a law over time, in the model and in its passes.
//
// If the joint has coordinates of its own, the recursion takes q, u and u' from the law; the joint has no free
// direction (D^-1 = 0) and passes its whole inertia on, at the cost of a free joint. The motion of links "with u' = 0"
// then holds the prescribed u'' of these joints, so that biases of rows and loops include it. In body coordinates, and
// if the joint closes a loop, the law is an additional row of the joint:
//   g = x(q) - p(t) = 0,   g' = G v - p',   g'' = G a + b - p''                                          (1)
// Source: Featherstone 2008, section 9.2 (hybrid dynamics); Haug 1989, chapter 9 (driving constraints).
#pragma once

#include <span>
#include <string>

#include "multibody/motions/motion_law.h"

namespace slew::multibody {

struct Model;
struct Workspace;

struct Drive {
  std::string name;
  int joint = 0;   // Model::joints
  int number = 0;  // number of the joint's coordinate: 0 or 1, as in variables
  bool is_angle = true;
  int link = 0;        // link that the joint moves; 0: the joint is cut
  int place = 0;       // place of the coordinate among the link's: 0 or 1
  int q = -1, u = -1;  // entries of State::q and State::u; -1: the joint is cut
  MotionLaw law;
};

// Sets ws.time, and the laws' values there.
void set_time(const Model& model, double time, Workspace& ws) noexcept;

// Writes the laws' values at ws.time into coordinates and speeds, or into the rates of speeds.
void impose_positions(const Model& model, const Workspace& ws, std::span<double> q) noexcept;
void impose_speeds(const Model& model, const Workspace& ws, std::span<double> u) noexcept;
void impose_accelerations(const Model& model, const Workspace& ws, std::span<double> udot) noexcept;

// Sets prescribed entries to zero, by u.
void clear_prescribed(const Model& model, std::span<double> by_u) noexcept;

// True if every law is defined at this time: a table may have ends: refuse.
[[nodiscard]] bool are_drives_defined(const Model& model, double time) noexcept;

}  // namespace slew::multibody
