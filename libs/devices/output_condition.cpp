// SPDX-License-Identifier: Apache-2.0
#include "devices/output_condition.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr Range kShortTime = {.min = 0, .max = 3600, .min_is_open = false, .max_is_open = false};

constexpr Field kSwitchedOutputFields[] = {
    field<&SwitchedOutputDef::hysteresis>(
        "hysteresis", {.range = kNotNegative,
                       .doc = "distance from the threshold at which the output goes off, in the variable's unit"}),
    field<&SwitchedOutputDef::delay>("delay", {.dimension = Dimension::time,
                                               .range = kShortTime,
                                               .doc = "time that the condition must hold before the output goes on"}),
    field<&SwitchedOutputDef::least_on>(
        "least_on", {.dimension = Dimension::time, .range = kShortTime, .doc = "shortest time that the output is on"}),
    field<&SwitchedOutputDef::pulse_on>(
        "pulse_on",
        {.dimension = Dimension::time, .range = kShortTime, .doc = "lit part of a pulse while on; 0: steady"}),
    field<&SwitchedOutputDef::pulse_off>(
        "pulse_off", {.dimension = Dimension::time, .range = kShortTime, .doc = "dark part of a pulse while on"}),
};

constexpr std::string_view kBlanks = " \t";
constexpr double kRounding = 1e-3;  // of a step

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

bool is_upward(Comparison comparison) {
  return comparison == Comparison::above || comparison == Comparison::at_least;
}

// Not met any more, and farther than the hysteresis from the threshold.
bool is_left(const SwitchedOutputDef& def, double value) {
  if (is_met(def.comparison, value, def.threshold)) return false;
  if (def.hysteresis == 0) return true;
  return is_upward(def.comparison) ? value < def.threshold - def.hysteresis : value > def.threshold + def.hysteresis;
}

}  // namespace

std::span<const Field> switched_output_fields() noexcept {
  return kSwitchedOutputFields;
}

bool is_met(Comparison comparison, double value, double threshold) noexcept {
  switch (comparison) {
    case Comparison::above:
      return value > threshold;
    case Comparison::at_least:
      return value >= threshold;
    case Comparison::below:
      return value < threshold;
    case Comparison::at_most:
      return value <= threshold;
  }
  return false;
}

std::optional<ConditionText> parse_condition(std::string_view path, std::string_view text, Problems& problems) {
  const std::size_t sign = text.find_first_of("<>=!");
  const std::string_view variable = trimmed(text.substr(0, sign));
  std::string_view rest = sign == std::string_view::npos ? std::string_view() : text.substr(sign);
  std::optional<Comparison> comparison;
  for (const auto& [name, kind] :
       {std::pair{std::string_view(">="), Comparison::at_least}, std::pair{std::string_view("<="), Comparison::at_most},
        std::pair{std::string_view(">"), Comparison::above}, std::pair{std::string_view("<"), Comparison::below}}) {
    if (comparison || !rest.starts_with(name)) continue;
    comparison = kind;
    rest.remove_prefix(name.size());
  }
  const std::string_view quantity = trimmed(rest);
  if (!comparison || variable.empty() || variable.find_first_of(kBlanks) != std::string_view::npos ||
      quantity.empty() || quantity.find_first_of("<>=!") != std::string_view::npos) {
    problems.push_back({std::string(path), fmt::format("'{}' is no condition", text),
                        "a variable, > >= < or <=, and a quantity, as 'Vol_MainPump.pressure > 250 bar'", ""});
    return std::nullopt;
  }
  return ConditionText{std::string(variable), *comparison, std::string(quantity)};
}

void validate(const SwitchedOutputDef& def, Problems& problems) {
  check_fields(def.name, &def, kSwitchedOutputFields, problems);
  if (!std::isfinite(def.threshold)) {
    problems.push_back({def.name + ".threshold", fmt::format("{:g} is no threshold", def.threshold), "finite", ""});
  }
  if ((def.pulse_on == 0) != (def.pulse_off == 0)) {
    problems.push_back(
        {def.name + ".pulse_on", "a pulse with one part only", "pulse_on and pulse_off, or neither", ""});
  }
}

bool step(const SwitchedOutputDef& def, double value, double dt, SwitchedOutputState& state) noexcept {
  state.is_known = std::isfinite(value);
  const bool was_on = state.is_on;
  // sums of dt miss a time by their rounding
  const auto elapsed = [&] { return state.time + kRounding * dt; };
  if (was_on) {
    state.time += dt;
    if (state.is_known && elapsed() >= def.least_on && is_left(def, value)) {
      state.is_on = state.is_met = false;
      state.time = 0;
    }
  } else if (state.is_known) {
    // from the first value that meets the condition: when between two values it did is unknown
    const bool was_met = std::exchange(state.is_met, is_met(def.comparison, value, def.threshold));
    state.time = was_met && state.is_met ? state.time + dt : 0;
    if (state.is_met && elapsed() >= def.delay) {
      state.is_on = true;
      state.time = 0;
    }
  }
  const double period = def.pulse_on + def.pulse_off;
  state.is_lit = state.is_on && (period == 0 || std::fmod(elapsed(), period) < def.pulse_on);
  if (state.is_on != was_on) ++state.changes;
  return state.is_on != was_on;
}

}  // namespace slew::devices
