// SPDX-License-Identifier: Apache-2.0
#include "devices/analog_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Field kAnalogOutputFields[] = {
    field<&AnalogOutputDef::low_output>("low_output", {.doc = "output at the variable's low value"}),
    field<&AnalogOutputDef::high_output>("high_output", {.doc = "output at the variable's high value"}),
    field<&AnalogOutputDef::smoothing>("smoothing",
                                       {.dimension = Dimension::time,
                                        .range = {.min = 0, .max = 60, .min_is_open = false, .max_is_open = false},
                                        .doc = "time constant of the output; 0: none"}),
};

}  // namespace

std::span<const Field> analog_output_fields() noexcept {
  return kAnalogOutputFields;
}

void validate(const AnalogOutputDef& def, Problems& problems) {
  check_fields(def.name, &def, kAnalogOutputFields, problems);
  if (!std::isfinite(def.low) || !std::isfinite(def.high) || def.low == def.high) {
    problems.push_back({def.name + ".high", fmt::format("low {:g} and high {:g} span no range", def.low, def.high),
                        "two finite values that differ", ""});
  }
}

double step(const AnalogOutputDef& def, double value, double dt, AnalogOutputState& state) noexcept {
  state.is_known = std::isfinite(value);
  if (!state.is_known) return state.has_output ? state.output : def.low_output;
  const double share = (value - def.low) / (def.high - def.low), allowed = std::clamp(share, 0.0, 1.0);
  if (share != allowed) ++state.held;
  const double target = def.low_output + allowed * (def.high_output - def.low_output);
  const bool is_smooth = def.smoothing > 0 && state.has_output;
  state.output = is_smooth ? state.output - std::expm1(-dt / def.smoothing) * (target - state.output) : target;
  state.has_output = true;
  return state.output;
}

}  // namespace slew::devices
