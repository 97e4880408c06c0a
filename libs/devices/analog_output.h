// SPDX-License-Identifier: Apache-2.0
// A variable as an analog signal: gauges, currents, voltages.
//
//   target = low_output + (x - low)/(high - low) (high_output - low_output), held between both outputs
//   T y' + y = target, exact for a target that is constant over the step
//
// A value that is not finite holds the output and is flagged. Card: docs/models/devices_axes.md.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/field.h"
#include "core/problem.h"

namespace slew::devices {

struct AnalogOutputDef {
  std::string name;
  std::string variable{};
  double low = 0;          // value of the variable, SI, at low_output
  double high = 1;         // value of the variable, SI, at high_output
  double low_output = 0;   // in the device's unit
  double high_output = 1;  // in the device's unit
  double smoothing = 0;    // T, s; 0: none
};

[[nodiscard]] std::span<const Field> analog_output_fields() noexcept;  // without low and high
void validate(const AnalogOutputDef& def, Problems& problems);

struct AnalogOutputState {
  double output = 0;
  bool has_output = false;  // false: low_output is to be sent
  bool is_known = false;    // the last value was finite
  std::uint64_t held = 0;   // steps at a bound
};

// One step of dt [s]; 0 at the first value. Result: the output to send. Pre-condition: dt >= 0.
double step(const AnalogOutputDef& def, double value, double dt, AnalogOutputState& state) noexcept;

}  // namespace slew::devices
