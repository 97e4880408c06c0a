// SPDX-License-Identifier: Apache-2.0
// Masses, force elements and rows of a MechanicsDef, written from docs/models for bodies whose motion another program
// computes. Shares no code with the library but the Def.
#pragma once

#include <string>

#include "multibody/model/defs.h"
#include "tests/peers/multibody/body_motion.h"

namespace slew::multibody::testing {

// Number of a body by name, 0 for Ground.
[[nodiscard]] std::size_t body_number(const MechanicsDef& def, const std::string& name);

// kg m2, about the centre of mass, body axes.
[[nodiscard]] math::Mat3 central_inertia(const BodyDef& body);

// A joint's frame in its body 1 or 2.
struct Frame {
  math::Mat3 R;
  math::Vec3 p;  // m
};
[[nodiscard]] Frame frame1(const JointDef& joint);
[[nodiscard]] Frame frame2(const JointDef& joint);

// Line of a translational force: from P2 towards P1.
struct Line {
  math::Vec3 P1, P2;           // m
  math::Vec3 e, e_dot;         // unit(P1 - P2) [1, 1/s]
  double x = 0, v = 0, a = 0;  // length, its rate and acceleration [m, m/s, m/s2]
};
[[nodiscard]] Line line_of(const MechanicsDef& def, const TranslationalForceDef& force, const Motions& motions);

// Adds what springs, dampers and end dampers of all force elements put on the bodies; needs poses and velocities.
void add_element_forces(const MechanicsDef& def, const Motions& motions, Wrenches& wrenches);

// Energy in all springs [J].
[[nodiscard]] double spring_energy(const MechanicsDef& def, const Motions& motions);

// Adds a force along the coordinate of a row: a force element, or a joint with one coordinate.
void add_row_force(const MechanicsDef& def, const std::string& row, double force, const Motions& motions,
                   Wrenches& wrenches);

// A row's coordinate with its rate and acceleration; an angle is in (-pi, pi].
struct RowMotion {
  double x = 0, v = 0, a = 0;
  bool is_angle = false;
};
[[nodiscard]] RowMotion row_motion(const MechanicsDef& def, const std::string& row, const Motions& motions);

}  // namespace slew::multibody::testing
