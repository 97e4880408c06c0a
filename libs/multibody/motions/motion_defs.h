// SPDX-License-Identifier: Apache-2.0
// Definition of prescribed motion: a joint's coordinate as a given function of time.
//
// `rotation_*` types drive an angle (revolute, cylindrical, universal), `translation_*` types a displacement
// (prismatic, cylindrical). Laws: motion_law.h. Card: docs/models/multibody_prescribed_motion.md.
#pragma once

#include <cstdint>
#include <string>

#include "core/field.h"
#include "multibody/model/not_given.h"

namespace slew::multibody {

enum class MotionKind : int { rotation, translation };
enum class MotionShape : int { table, harmonic, ramp, speed };

// Continuation of a table outside of its times.
enum class TableEnds : int {
  hold,       // the value is held, with slope 0 at both ends; a speed is held
  continued,  // continued with the speed (a speed: with the acceleration) of its end, without a jump
  refused,    // not allowed: a step beyond is reported as not converged
};

// One struct for every type; each type's field table lists the members that it has, in its own dimensions.
struct MotionDef {
  std::string name{};
  MotionKind kind = MotionKind::rotation;
  MotionShape shape = MotionShape::table;
  std::string joint{};
  std::int64_t axis = 1;             // universal joint: 1 about z of frame 1, 2 about z of frame 2
  Table points{};                    // s, rad or m (table); s, rad/s or m/s (speed)
  TableEnds ends = TableEnds::hold;  // ends of the table
  double offset = kNotGiven;         // rad or m (harmonic); not given: such that it fits the start position
  double amplitude = 0;              // rad or m (harmonic)
  double frequency = 0;              // Hz (harmonic)
  double phase = 0;                  // rad (harmonic)
  double from = kNotGiven;           // rad or m (ramp); not given: the start position
  double to = 0;                     // rad or m (ramp)
  double start = 0;                  // s (ramp)
  double duration = 1;               // s (ramp)
  double speed = 0;                  // rad/s or m/s (speed), added to its table
};

}  // namespace slew::multibody
