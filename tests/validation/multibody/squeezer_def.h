// SPDX-License-Identifier: Apache-2.0
// Case A03: Andrews' squeezer.
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "multibody/model/defs.h"

namespace slew::multibody::testing {

// angles [rad] after 30 ms, by joint: Bari IVP test set
inline constexpr std::pair<const char*, double> kSqueezerAngles[] = {
    {"Crank", 15.81077119629904},     {"Pin", -15.75637105984298},      {"Pivot_B", 0.0408222401307310},
    {"Hinge_G", -0.5347301163226948}, {"Pivot_A5", 0.5244099658805304}, {"Hinge_H", 0.5347301163226948},
    {"Pivot_A7", 1.048080741042263}};

// Seven bodies, ten hinges: the reference's numbering of bodies, points and angles.
inline MechanicsDef squeezer() {
  constexpr double kBeta = -0.0617138900142764496, kTheta = 0, kGamma = 0.455279819163070380,
                   kPhi = 0.222668390165885885, kDelta = 0.487364979543842550, kOmega = -0.222668390165885885,
                   kEps = 1.23054744454982119;
  constexpr double d = .028, da = .0115, e = .02, ea = .01421, rr = .007, ra = .00092, ss = .035, sa = .01874,
                   sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04, ua = .01228, ub = .00449,
                   zf = .02, zt = .04, fa = .01421;
  const Triple A{-.06934, -.00227, 0}, B{-.03635, .03273, 0}, C{.014, .072, 0};
  const double m[] = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
  const double I[] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
  const auto turned = [](double angle, double x, double y) {
    return Triple{std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y, 0};
  };
  const auto plus = [](const Triple& a, const Triple& b) { return Triple{a[0] + b[0], a[1] + b[1], 0}; };
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  const auto add = [&](std::size_t i, const Triple& origin, double angle, double cx, double cy) {
    def.bodies.push_back({.name = "K" + std::to_string(i + 1),
                          .position = origin,
                          .orientation = {angle, 0, 0},
                          .mass = m[i],
                          .center_of_mass = {cx, cy, 0},
                          .inertia = {0.5 * I[i], 0.5 * I[i], I[i]}});
  };
  // body axes: K1 x along the crank; K2 and the others as the angle of each turns them
  const Triple F = turned(kBeta, rr, 0), G = plus(A, turned(kDelta, zt, 0));
  const Triple H = plus(A, turned(kEps, 0, -u));
  add(0, {0, 0, 0}, kBeta, ra, 0);
  add(1, F, kBeta + kTheta, -da, 0);
  add(2, B, kGamma, sb, -sa);
  // of the thesis of the reference: sa(sin, -cos) + sb(cos, sin)
  def.bodies.back().center_of_mass = {sb, -sa, 0};
  add(3, G, kPhi + kDelta, 0, -(e - ea));
  add(4, A, kDelta, ta, tb);
  add(5, H, kOmega + kEps, zf - fa, 0);
  add(6, A, kEps, -ub, -ua);
  const auto hinge = [&](const char* name, const std::string& body1, Triple p1, const std::string& body2, Triple p2) {
    def.joints.push_back({.name = name, .body1 = body1, .point1 = p1, .body2 = body2, .point2 = p2});
  };
  hinge("Crank", "Ground", {}, "K1", {});
  hinge("Pin", "K1", {rr, 0, 0}, "K2", {});
  hinge("Pivot_B", "Ground", B, "K3", {});
  hinge("Pivot_A5", "Ground", A, "K5", {});
  hinge("Pivot_A7", "Ground", A, "K7", {});
  hinge("Hinge_G", "K5", {zt, 0, 0}, "K4", {});
  hinge("Hinge_H", "K7", {0, -u, 0}, "K6", {});
  hinge("Hinge_E3", "K2", {-d, 0, 0}, "K3", {0, -ss, 0});
  hinge("Hinge_E4", "K2", {-d, 0, 0}, "K4", {0, -e, 0});
  hinge("Hinge_E6", "K2", {-d, 0, 0}, "K6", {zf, 0, 0});
  def.translational_forces.push_back({.name = "Spring",
                                      .body1 = "Ground",
                                      .point1 = C,
                                      .body2 = "K3",
                                      .point2 = {sd, -sc, 0},
                                      .spring_constant = 4530,
                                      .free_length = 0.07785});
  return def;
}

}  // namespace slew::multibody::testing
