// SPDX-License-Identifier: Apache-2.0
// What an actuator is to the mechanics, and to whatever reports on it: the facts of its Def that do not depend on its
// type. Every ComponentDef that drives a force element through a power port returns them from actuator().
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "core/field.h"

namespace slew::hydraulics {

// Friction that follows the pressure force where friction_curve names no curve: none, or f = 1 from seal_speed on.
enum class FrictionWithoutCurve { none, constant };

// Cushion at one end of the stroke (math/cushion.h).
struct EndCushion {
  double length = 0;        // m, from the end of the stroke; 0: none
  double entry_length = 0;  // m, way on which the plunger shuts the port
  double area = 0;          // m2, of the enclosed oil
  Table throttle = {};      // remaining stroke [m], discharge coefficient times area [m2]
  bool has_check_valve = true;
};

// Parameters of the line force, evaluated in port space by both sides of the coupling:
//   F_line = F - F_mu + F_stop + F_c,  F = p_A A_A - p_B A_B;  F_c: brake of the end cushions
//   F_mu   = (|F| (1 - cylinder_coefficient) f(|v|) + (seal_friction + F_brk exp(-(v/v_s)^2)) f_0(v)) sgn v +
//   viscous_friction v F_stop = max(0, end_stiffness d + end_damping d') at either end, pushing only
struct LineForceParameters {
  std::string friction_curve;       // coefficient f over piston speed, m/s
  double cylinder_coefficient = 1;  // eta
  double seal_friction = 0;         // N
  double viscous_friction = 0;      // N s/m
  double end_stiffness = 0;         // N/m
  double end_damping = 0;           // N s/m
  double minimum_stroke = 0;        // m
  double maximum_stroke = 0;        // m
  double seal_speed = 1e-4;         // m/s, speed from which on the seal friction is fully there
  FrictionWithoutCurve friction_without_curve = FrictionWithoutCurve::none;
  double breakaway_friction = 0;                          // F_brk [N]
  double stribeck_speed = 0.01;                           // v_s [m/s]
  EndCushion minimum_cushion = {}, maximum_cushion = {};  // of chambers A and B
};

// Coupling level of the actuator's power port: a level of its own or the session's. coupling/level.h defines the
// levels.
enum class PortCoupling : int { session, hold, linear, two, tlm };

// Unit of a port's coordinate x. Where it is the radian, m, m/s, N and m2 of the port's quantities stand for rad,
// rad/s, Nm and m3/rad.
enum class PortUnit { metre, radian };

// x = offset + ratio * (coordinate of the force element): distance of its points [m] or angle [rad].
struct PortCoordinate {
  double offset = 0;  // m
  double ratio = 1;   // 1, or m/rad
  PortUnit unit = PortUnit::metre;
};

// Kind of the force element: translational, or rotational, where coordinate.ratio turns the line force into a torque.
enum class Motion { linear, rotary };

// How an actuator shares the static load between its chambers at an equilibrium start.
enum class StartRule { return_pressure, mean_pressure };

// Way of a piston in its barrel [m]; a motor's shaft has no end.
struct Barrel {
  double begin = -std::numeric_limits<double>::infinity(), end = std::numeric_limits<double>::infinity();

  // How far the piston at x is beyond an end [m]; 0: it is in the barrel.
  [[nodiscard]] double beyond(double x) const noexcept { return std::max({0.0, begin - x, x - end}); }
};

struct ActuatorDef {
  std::string force;              // force element that it drives
  std::string port_a, port_b;     // volumes
  double area_a = 0, area_b = 0;  // m2; F = p_A area_a - p_B area_b
  Motion motion = Motion::linear;
  PortCoordinate coordinate = {};
  LineForceParameters line_force = {};
  PortCoupling coupling = PortCoupling::session;
  Barrel barrel = {};
  StartRule start = StartRule::return_pressure;
  bool has_stages = false;  // the areas are the largest, and fall with the stroke (staged_area.h)
  // typical sizes, for the error measure
  double position_scale = 1e-3;  // m: at rtol 1e-4 an error of 0.1 um, a few newtons of oil spring
  double speed_scale = 0.1;      // m/s
};

}  // namespace slew::hydraulics
