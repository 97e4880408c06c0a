// SPDX-License-Identifier: Apache-2.0
// Mechanisms with loops: the N four-bars of case A02, the spatial slider-crank of case A08.
#pragma once

#include <cmath>
#include <string>

#include "math/vector3.h"
#include "multibody/model/defs.h"

namespace slew::multibody::testing {

// n + 1 vertical rods on pins at x = 0 .. n, and n horizontal couplers; all upright, the first with 1 m/s at its tip.
inline MechanicsDef four_bars(int n) {
  MechanicsDef def;
  const double inertia = 1.0 / 12;
  const auto name = [](const char* kind, int i) { return kind + std::to_string(i); };
  for (int i = 0; i <= n; ++i) {
    def.bodies.push_back({.name = name("Rod", i),
                          .position = {static_cast<double>(i), 0, 0},
                          .mass = 1,
                          .center_of_mass = {0, 0.5, 0},
                          .inertia = {inertia, 0, inertia}});
    def.joints.push_back({.name = name("Pin", i),
                          .body1 = "Ground",
                          .point1 = {static_cast<double>(i), 0, 0},
                          .body2 = name("Rod", i),
                          .initial_velocity = i == 0 ? -1.0 : kNotGiven});
  }
  for (int i = 0; i < n; ++i) {
    def.bodies.push_back({.name = name("Coupler", i),
                          .position = {static_cast<double>(i), 1, 0},
                          .mass = 1,
                          .center_of_mass = {0.5, 0, 0},
                          .inertia = {0, inertia, inertia}});
    def.joints.push_back(
        {.name = name("Left", i), .body1 = name("Rod", i), .point1 = {0, 1, 0}, .body2 = name("Coupler", i)});
    def.joints.push_back({.name = name("Right", i),
                          .body1 = name("Coupler", i),
                          .point1 = {1, 0, 0},
                          .body2 = name("Rod", i + 1),
                          .point2 = {0, 1, 0}});
  }
  return def;
}

// Parallelogram with cranks of 0.3 m, coupler and base of 1 m, base at `base` to x, cranks at `crank` to the base
// [rad]. The pins at Ground have speeds where these are given; weight acts along -y.
inline MechanicsDef parallelogram(double base, double crank, double first_speed, double second_speed) {
  const auto along = [](double angle, double length) {
    return Triple{length * std::cos(angle), length * std::sin(angle), 0};
  };
  const double cranks = base + crank;
  const Triple inertia = {0.01, 0.01, 0.01}, end = {0.3, 0, 0};
  MechanicsDef def;
  def.bodies = {{.name = "A", .orientation = {cranks, 0, 0}, .mass = 1, .center_of_mass = {0.15, 0, 0}},
                {.name = "B", .position = along(cranks, 0.3), .orientation = {base, 0, 0}, .mass = 2},
                {.name = "C", .position = along(base, 1), .orientation = {cranks, 0, 0}, .mass = 1}};
  def.bodies[1].center_of_mass = {0.5, 0, 0};
  def.bodies[2].center_of_mass = {0.15, 0, 0};
  def.bodies[0].inertia = def.bodies[2].inertia = inertia;
  def.bodies[1].inertia = {0.01, 0.2, 0.2};
  def.joints = {{.name = "J1", .body2 = "A", .initial_velocity = first_speed},
                {.name = "J2", .body1 = "A", .point1 = end, .body2 = "B"},
                {.name = "J3", .point1 = along(base, 1), .body2 = "C", .initial_velocity = second_speed},
                {.name = "J4", .body1 = "B", .point1 = {1, 0, 0}, .body2 = "C", .point2 = end}};
  return def;
}

inline MechanicsDef slider_crank() {
  MechanicsDef def;
  def.gravity = {0, 0, -9.81};
  const double root5 = std::sqrt(5.0);
  // crank with its frame at A; conrod from B to C: x along it, y along (0, 2, -1) turned to a right angle
  const math::Vec3 B(0, 0.1, 0.2), C(0.2, 0, 0), x = (C - B) * (1 / 0.3);
  const math::Vec3 y = cross(math::Vec3(0, 0, 1), x) * (1 / norm(cross(math::Vec3(0, 0, 1), x)));
  const math::Vec3 z = cross(x, y);
  def.bodies = {{.name = "Crank",
                 .position = {0, 0.1, 0.12},
                 .mass = 0.12,
                 .center_of_mass = {0, 0, 0.04},
                 .inertia = {1e-4, 1e-4, 1e-5}},
                {.name = "Slider", .position = C.array(), .mass = 2, .inertia = {1e-4, 1e-4, 1e-4}}};
  // z-x'-z'' angles of the conrod's axes
  const double theta = std::acos(z[2]), phi = std::atan2(z[0], -z[1]), psi = std::atan2(x[2], y[2]);
  def.bodies.push_back({.name = "Conrod",
                        .position = B.array(),
                        .orientation = {phi, theta, psi},
                        .mass = 0.5,
                        .center_of_mass = {0.15, 0, 0},
                        .inertia = {4e-4, 4e-3, 4e-3}});
  const double quarter = M_PI / 2;
  def.joints = {
      {.name = "Pivot",
       .point1 = {0, 0.1, 0.12},
       .orientation1 = {0, quarter, 0},
       .body2 = "Crank",
       .orientation2 = {0, quarter, 0},
       .initial_velocity = 6},
      {.name = "Ball", .type = JointType::spherical, .body1 = "Crank", .point1 = {0, 0, 0.08}, .body2 = "Conrod"},
      {.name = "Slot",
       .type = JointType::prismatic,
       .orientation1 = {0, quarter, 0},
       .body2 = "Slider",
       .orientation2 = {0, quarter, 0}}};
  // cross with x of the slider and (0, -2, 1) / sqrt 5 in Ground at the start, fixed to the conrod
  const math::Vec3 cross2 = math::Vec3(0, -2, 1) * (1 / root5);
  const math::Vec3 cross2_body(dot(x, cross2), dot(y, cross2), dot(z, cross2));
  // successive x, y' that turn z onto it
  const double beta = std::asin(cross2_body[0]), alpha = std::atan2(-cross2_body[1], cross2_body[2]);
  def.joints.push_back({.name = "Cross",
                        .type = JointType::universal,
                        .body1 = "Slider",
                        .orientation1 = {0, quarter, 0},
                        .body2 = "Conrod",
                        .point2 = {0.3, 0, 0},
                        .orientation2 = {alpha, beta, 0}});
  return def;
}

}  // namespace slew::multibody::testing
