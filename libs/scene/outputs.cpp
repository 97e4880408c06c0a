// SPDX-License-Identifier: Apache-2.0
// Outputs of a scene, and the quantities and conditions of their texts.
#include <fmt/format.h>

#include <cmath>

#include "scene/device_readers.h"
#include "scene/number.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

std::vector<Field> make_switched_fields() {
  using devices::SwitchedOutputDef;
  const std::span<const Field> rows = devices::switched_output_fields();
  return {
      field<&SwitchedDef::condition>("condition",
                                     {.presence = Presence::required,
                                      .doc = "variable, > >= < or <=, quantity, as 'Vol_MainPump.pressure > 250 bar'"}),
      field<&SwitchedDef::hysteresis>(
          "hysteresis", {.doc = "distance from the threshold at which the output goes off, as '5 bar'; default 0"}),
      lent<&SwitchedDef::output, &SwitchedOutputDef::delay>(rows, "delay"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::least_on>(rows, "least_on"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::pulse_on>(rows, "pulse_on"),
      lent<&SwitchedDef::output, &SwitchedOutputDef::pulse_off>(rows, "pulse_off"),
  };
}

std::vector<Field> make_analog_fields() {
  using devices::AnalogOutputDef;
  const std::span<const Field> rows = devices::analog_output_fields();
  return {
      field<&AnalogDef::output, &AnalogOutputDef::variable>(
          "variable", {.presence = Presence::required, .doc = "variable of the session, as Vol_MainPump.pressure"}),
      field<&AnalogDef::low>("low", {.presence = Presence::required, .doc = "value at low_output, as '0 bar'"}),
      field<&AnalogDef::high>("high", {.presence = Presence::required, .doc = "value at high_output, as '300 bar'"}),
      lent<&AnalogDef::output, &AnalogOutputDef::low_output>(rows, "low_output"),
      lent<&AnalogDef::output, &AnalogOutputDef::high_output>(rows, "high_output"),
      lent<&AnalogDef::output, &AnalogOutputDef::smoothing>(rows, "smoothing"),
  };
}

const char* const kAnyQuantity = "a quantity with its unit such as '250 bar', or a bare number in SI";

// A difference of the variable: degC has an offset, which a difference has not.
std::optional<AnyQuantity> read_difference(const std::string& path, const std::string& text, Problems& problems) {
  std::optional<AnyQuantity> difference = read_any_quantity(path, text, problems);
  if (!difference) return std::nullopt;
  UnitSystem units;
  const Unit* const unit = difference->unit.empty() ? nullptr : units.find(difference->unit);
  if ((unit != nullptr && unit->offset != 0) || difference->value < 0) {
    problems.push_back({path, fmt::format("'{}' is no distance", text), "at least 0, in a unit as K or bar", ""});
    return std::nullopt;
  }
  return difference;
}

}  // namespace

std::span<const Field> switched_fields() {
  static const std::vector<Field> fields = make_switched_fields();
  return fields;
}
std::span<const Field> analog_fields() {
  static const std::vector<Field> fields = make_analog_fields();
  return fields;
}

std::optional<AnyQuantity> read_any_quantity(std::string_view path, std::string_view text, Problems& problems) {
  const NumberText number = split_number(text);
  if (!number.is_number) {
    problems.push_back({std::string(path),
                        number.problem.what.empty() ? fmt::format("'{}' is no quantity", text) : number.problem.what,
                        number.problem.expected.empty() ? kAnyQuantity : number.problem.expected, ""});
    return std::nullopt;
  }
  AnyQuantity quantity{static_cast<double>(number.value), std::string(number.rest)};
  if (!quantity.unit.empty()) {
    UnitSystem units;
    const Unit* const unit = units.find(quantity.unit);
    if (unit == nullptr) {
      problems.push_back({std::string(path), fmt::format("there is no unit '{}'", quantity.unit), kAnyQuantity, ""});
      return std::nullopt;
    }
    quantity.value = static_cast<double>(number.value * unit->scale + unit->offset);
  }
  if (std::isfinite(quantity.value)) return quantity;
  problems.push_back({std::string(path), fmt::format("'{}' is beyond what a number can hold", text), kAnyQuantity, ""});
  return std::nullopt;
}

std::optional<Condition> read_condition(std::string_view path, std::string_view text, Problems& problems) {
  const auto parts = devices::parse_condition(path, text, problems);
  if (!parts) return std::nullopt;
  const auto threshold = read_any_quantity(path, parts->quantity, problems);
  if (!threshold) return std::nullopt;
  return Condition{parts->variable, parts->comparison, *threshold};
}

bool is_same_dimension(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return true;
  UnitSystem units;
  // the nodes' "1" is no text of UDUNITS' own
  const auto find = [&](const std::string& text) { return text == "1" ? Unit() : *units.find(text); };
  for (const std::string& text : {a, b}) {
    if (text != "1" && units.find(text) == nullptr) return false;
  }
  const Unit of_a = find(a), of_b = find(b);
  return of_a.exponent == of_b.exponent && !of_a.has_other_base && !of_b.has_other_base;
}

void read_outputs(OutputsDef& outputs, Problems& problems) {
  for (SwitchedDef& def : outputs.switched) {
    def.output.name = def.name;
    if (const auto condition = read_condition(def.name + ".condition", def.condition, problems)) {
      def.output.variable = condition->variable;
      def.output.comparison = condition->comparison;
      def.output.threshold = condition->threshold.value;
      if (def.hysteresis.empty()) {
        def.output.hysteresis = 0;
      } else if (const auto distance = read_difference(def.name + ".hysteresis", def.hysteresis, problems)) {
        def.output.hysteresis = distance->value;
        if (!is_same_dimension(distance->unit, condition->threshold.unit)) {
          problems.push_back(
              {def.name + ".hysteresis",
               fmt::format("'{}' is no distance from a threshold in {}", def.hysteresis, condition->threshold.unit),
               "a quantity of the same dimension", ""});
        }
      }
    }
    validate(def.output, problems);
  }
  for (AnalogDef& def : outputs.analog) {
    def.output.name = def.name;
    const auto low = read_any_quantity(def.name + ".low", def.low, problems);
    const auto high = read_any_quantity(def.name + ".high", def.high, problems);
    if (!low || !high) continue;
    def.output.low = low->value;
    def.output.high = high->value;
    if (!is_same_dimension(low->unit, high->unit)) {
      problems.push_back({def.name + ".high", fmt::format("'{}' and '{}' differ in dimension", def.low, def.high),
                          "two quantities of the variable", ""});
    }
    validate(def.output, problems);
  }
}

}  // namespace slew::scene
