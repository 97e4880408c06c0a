// SPDX-License-Identifier: Apache-2.0
// Case A05: a flyball governor whose spring-dampers are a thousand times faster than its motion.
#pragma once

#include <cmath>
#include <string>

#include "math/vector3.h"
#include "multibody/model/defs.h"

namespace slew::multibody::testing {

// Shaft and rods 1 m long with a section of 1 cm squared, point masses at the rods' tips, a cube that slides on the
// shaft.
inline MechanicsDef governor_def() {
  constexpr double kRod = 0.3, kBall = 5, kSlider = 3;  // kg
  constexpr double kSide = 0.01;                        // m
  const double along = kRod * 2 * kSide * kSide / 12, across = kRod * (1 + kSide * kSide) / 12;
  MechanicsDef def;
  def.gravity = {0, 0, -9.81};
  def.bodies.push_back(
      {.name = "Shaft", .mass = kRod, .center_of_mass = {0, 0, 0.5}, .inertia = {across, across, along}});
  def.joints.push_back({.name = "Spin", .body2 = "Shaft", .initial_velocity = 2 * M_PI});
  const double drop = M_PI / 6;
  for (const int side : {1, -1}) {
    const std::string rod = side > 0 ? "Rod1" : "Rod2";
    // x of the rod outwards and down; Euler angles z-x'-z'' of its axes
    const math::Vec3 x(side * std::cos(drop), 0, -std::sin(drop)), y(0, side, 0), z = cross(x, y);
    const double theta = std::acos(z[2]), phi = std::atan2(z[0], -z[1]), psi = std::atan2(x[2], y[2]);
    const double mass = kRod + kBall, c = (0.5 * kRod + kBall) / mass;
    const double about_center = across + kRod * (c - 0.5) * (c - 0.5) + kBall * (1 - c) * (1 - c);
    def.bodies.push_back({.name = rod,
                          .position = {side * 0.05, 0, 1},
                          .orientation = {phi, theta, psi},
                          .mass = mass,
                          .center_of_mass = {c, 0, 0},
                          .inertia = {along, about_center, about_center}});
    def.joints.push_back({.name = "Pin" + rod,
                          .body1 = "Shaft",
                          .point1 = {side * 0.05, 0, 1},
                          .orientation1 = {-M_PI / 2, 0, 0},
                          .body2 = rod,
                          .orientation2 = {-side * M_PI / 2, 0, 0}});
  }
  const double cube = kSlider * 2 * 0.1 * 0.1 / 12;
  def.bodies.push_back({.name = "Slider", .position = {0, 0, 0.5}, .mass = kSlider, .inertia = {cube, cube, cube}});
  def.joints.push_back({.name = "Slot", .type = JointType::prismatic, .body1 = "Shaft", .body2 = "Slider"});
  for (const int side : {1, -1}) {
    def.translational_forces.push_back({.name = side > 0 ? "Strut1" : "Strut2",
                                        .body1 = side > 0 ? "Rod1" : "Rod2",
                                        .point1 = {0.5, 0, 0},
                                        .body2 = "Slider",
                                        .point2 = {side * 0.05, 0, 0},
                                        .spring_constant = 8e5,
                                        .damping_constant = 4e4,
                                        .free_length = 0.5});
  }
  return def;
}

}  // namespace slew::multibody::testing
