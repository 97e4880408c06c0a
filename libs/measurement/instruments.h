// SPDX-License-Identifier: Apache-2.0
// Measuring instruments of a scene: transducers of one variable, and inertial measurement units on bodies
// (docs/models/measurement.md).
//
// An inertial measurement unit at the point P of a body B, axes of the frame of B:
//   v_P = v_B + w_B x r,  r = R_B p                                                                              (1)
//   specific force f = R_B^T ((v_P(t) - v_P(t - H)) / H - g)                                                     (2)
//   rates          w = R_B^T w_B                                                                                 (3)
// p the point in axes of B, v_B and w_B velocity of the origin and angular velocity, g gravity, H the session's step.
// (2) is the mean acceleration over the last step, as of an instrument that counts its velocity; at the start, where
// there is no step before, the body counts as unaccelerated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/field.h"
#include "core/problem.h"
#include "core/time.h"
#include "measurement/channel.h"

namespace slew::measurement {

enum class InstrumentType : int {
  pressure,
  flow,
  position,
  angle,
  speed,
  angular_speed,
  force,
  torque,
  temperature,
  imu
};

// One struct for every type; each type's field table lists the members that it has.
struct InstrumentDef {
  std::string name{};
  InstrumentType type = InstrumentType::pressure;
  std::string variable{};        // of the session, "Vol_MainPump.pressure"; not of an imu
  std::string body{};            // imu
  Triple point{};                // imu: m, in the body's frame
  ChannelParameters value{};     // of the variable; imu: of each component of the specific force, m/s2
  ChannelParameters rate{};      // imu: of each component of the angular velocity, rad/s
  Triple acceleration_offset{};  // imu: m/s2
  Triple rate_offset{};          // imu: rad/s
  SamplingParameters sampling{};
  std::string place{};  // of its variable in the scene's files, "crane.yaml:12:5"; empty: not known
};

struct InstrumentTypeRow {
  std::string_view name;
  std::string_view doc;
  std::span<const Field> fields;
  Dimension dimension = Dimension::none;  // of the variable; imu: none
};
// In the order of InstrumentType.
[[nodiscard]] std::span<const InstrumentTypeRow> instrument_types() noexcept;

// Appends all problems: a range without an inside, a sample time or delay that is no whole number of steps. Paths are
// "Sensor.key".
void validate(std::span<const InstrumentDef> instruments, SimDuration step, Problems& problems);

// Variables of an instrument.
[[nodiscard]] std::vector<ElementVariable> variables_of(const InstrumentDef& def);

}  // namespace slew::measurement
