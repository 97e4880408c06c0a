// SPDX-License-Identifier: Apache-2.0
// `slewring describe SCENE --liftable`: the largest payload that the machine can lift at a pose, and its limiting part.
//
//   F_i(m) = F_i(m_0) + s_i (m - m_0)                line force that holds port i with the payload m             (1)
//   F_i,max = F_stall - F_mu(F_stall)                line force when the valves press with all they have         (2)
//   m_i by port_limits.h,   answer: the smallest m_i                                                           (3)
// (1): mechanics_node/payload.h. (2): largest_force.h. A limiting setting is found by lowering each pressure of each
// component by 1 % and stalling again: what lowers the pressure in the loaded chamber by kOfSetting of its own change
// or more is named.
//
// Not covered: friction of joints, speeds (the load hangs at rest), tipping of the carrier, strength, buckling.
#pragma once

#include <string>
#include <vector>

#include "core/json.h"
#include "multibody/model/state.h"
#include "scene/scene.h"

namespace slew::analysis {

// A pressure of a component that the limit depends on.
struct LimitingSetting {
  std::string path{};  // "L90Lift.maximum_ls_pressure_a"
  double value = 0;    // Pa
  double effect = 0;   // Pa of the chamber per Pa of the setting
};

struct LiftingPort {
  std::string name{};                       // name of the cylinder
  coupling::PortUnit unit{};                // of the stroke; the forces are torques where it is the radian
  double stroke = 0;                        // m
  double static_force = 0;                  // N, with the scene's payload
  double force_per_kg = 0;                  // m/s2; 0: it does not carry the payload
  double largest_force = 0;                 // N, (2), in the direction in which it carries
  double pressure = 0;                      // Pa absolute, in the loaded chamber at (2)
  std::string chamber{};                    // volume
  std::string input{};                      // input that loads it; empty: none needed
  double stick = 0;                         // +1 or -1: its direction, at full stick
  double load = 0;                          // kg, (3); below 0: it does not hold the machine
  std::vector<std::string> with{};          // cylinders on the same volumes that lift together with it
  bool is_at_end = false;                   // the piston stands in the end stop that it would have to leave
  bool is_steady = true;                    // false: the pressure still rose after 30 s
  std::vector<LimitingSetting> settings{};  // largest effect first; only for the limiting port

  [[nodiscard]] bool carries() const noexcept { return force_per_kg != 0; }
};

struct LiftableLoad {
  double at = 0;        // s
  std::string pose;     // as the user wrote it
  std::string payload;  // body
  double mass = 0;      // kg, in the scene at that time
  std::string refusal;  // why there is no answer where a payload hangs on cylinders; empty: there may be one
  std::vector<LiftingPort> ports;
  int limiting = -1;                     // port with the smallest load; -1: none carries the payload
  std::vector<std::string> uncommanded;  // valves that take a signal and have no input, if limit() has no force

  [[nodiscard]] bool has_answer() const noexcept { return limiting >= 0; }
  [[nodiscard]] const LiftingPort& limit() const { return ports[static_cast<std::size_t>(limiting)]; }
};

struct LiftingPose {
  double at = 0;                    // s of the scene's run
  std::vector<std::string> joints;  // "Joint=20 deg": set afterwards; revolute and prismatic joints of the tree
};

enum class ListedSettings { named, left_out };

// scene is left as it was; its pressures are changed meanwhile. Throws Failure. A scene without payload, ports or
// hydraulics has no answer.
[[nodiscard]] LiftableLoad find_liftable(scene::Scene& scene, const LiftingPose& pose, ListedSettings settings);

// The same for each body that the scene's `payload` names, at least for the one of find_liftable().
[[nodiscard]] std::vector<LiftableLoad> find_liftable_of_each(scene::Scene& scene, const LiftingPose& pose,
                                                              ListedSettings settings);

// "Cyl_Lift lifts 2.96 t of Bag at most (...)": one line; the table for people adds the other cylinders.
[[nodiscard]] std::string limit_text(const LiftableLoad& load);
// width [characters]: of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const LiftableLoad& load, std::size_t width = 0);
[[nodiscard]] Json report_json(const LiftableLoad& load);

}  // namespace slew::analysis
