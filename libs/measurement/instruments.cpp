// SPDX-License-Identifier: Apache-2.0
#include "measurement/instruments.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace slew::measurement {
namespace {

constexpr double kWholeTolerance = 1e-6;  // of a step: rounding of a time given in decimals

void check_whole(const std::string& path, double time, double step, Problems& problems) {
  const double steps = time / step;
  if (std::fabs(steps - std::round(steps)) <= kWholeTolerance) return;
  problems.push_back({path, fmt::format("{} s is no whole number of steps of {} s", time, step),
                      fmt::format("{} s or {} s, for instance", std::floor(steps) * step, std::ceil(steps) * step),
                      ""});
}

// A zero of degC in an expression, ${2 * 0.1 degC}, gives an error of hundreds of kelvin.
void check_differences(const InstrumentDef& def, Problems& problems) {
  const double span = def.value.highest - def.value.lowest;
  const std::pair<const char*, double> errors[] = {{"offset", def.value.offset},
                                                   {"noise", def.value.noise},
                                                   {"drift", def.value.drift},
                                                   {"resolution", def.value.resolution}};
  for (const auto& [key, value] : errors) {
    if (std::abs(value) <= span) continue;
    problems.push_back({fmt::format("{}.{}", def.name, key), fmt::format("{:g} K is more than the range", value),
                        fmt::format("a difference of temperatures up to {:g} K, without degC", span), ""});
  }
}

}  // namespace

void validate(std::span<const InstrumentDef> instruments, SimDuration step, Problems& problems) {
  for (const InstrumentDef& def : instruments) {
    check_whole(def.name + ".sample_time", def.sampling.sample_time, step.seconds(), problems);
    check_whole(def.name + ".delay", def.sampling.delay, step.seconds(), problems);
    if (def.type == InstrumentType::temperature) check_differences(def, problems);
    if (def.type == InstrumentType::imu || def.value.lowest < def.value.highest) continue;
    problems.push_back({def.name + ".highest", "the range ends below its beginning", "a value above lowest", ""});
  }
}

std::vector<ElementVariable> variables_of(const InstrumentDef& def) {
  std::vector<ElementVariable> variables;
  if (def.type == InstrumentType::imu) {
    for (const char* axis : {".x", ".y", ".z"}) {
      variables.push_back({def.name + ".specific_force" + axis, Dimension::acceleration});
    }
    for (const char* axis : {".x", ".y", ".z"}) {
      variables.push_back({def.name + ".rate" + axis, Dimension::angular_velocity});
    }
  } else {
    variables.push_back({def.name + ".value", instrument_types()[static_cast<std::size_t>(def.type)].dimension});
  }
  variables.push_back({def.name + ".is_valid", Dimension::none});
  return variables;
}

}  // namespace slew::measurement
