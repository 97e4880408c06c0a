// SPDX-License-Identifier: Apache-2.0
// The setting of a pressure valve by a proportional solenoid.
//
//   tau e' = clip(signal / maximum_control_signal, 0, 1) - e,   tau = solenoid_response / 3                     (1)
//   p_s = p_m + e (setting - p_m)                                                                               (2)
// e force of the solenoid, 0 at the start; p_m minimum_pressure, at which the valve opens without a signal; p_s the
// pressure at which it opens, its full setting from maximum_control_signal on. Without `proportional` p_s = setting,
// and there is no state.
// Not covered: hysteresis and dither, a solenoid that lowers the setting.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"
#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"
#include "hydraulics/smooth.h"

namespace slew::hydraulics {

struct ProportionalParameters {
  double minimum_pressure = 0;        // Pa above the outlet
  double maximum_control_signal = 1;  // signal of the full setting, as the maker states it
  double solenoid_response = 0.05;    // s, three time constants
};

template <typename Def>
struct ReadByProportional {
  static constexpr ReadBy kRows[] = {read_by<&Def::is_proportional, true>("proportional", "proportional: true")};
};

// A valve's own rows and those of its members is_proportional and solenoid.
template <typename Def, std::size_t N>
constexpr auto with_proportional(const std::array<Field, N>& own) {
  using P = ProportionalParameters;
  constexpr std::span<const ReadBy> kReadBy = ReadByProportional<Def>::kRows;
  const std::array rows = {
      field<&Def::is_proportional>(
          "proportional", {.doc = "opening pressure that follows the control signal; false: the full setting"}),
      field<&Def::solenoid, &P::minimum_pressure>(
          "minimum_pressure", {.dimension = Dimension::pressure,
                               .range = kNotNegative,
                               .change = Change::live,
                               .read_by = kReadBy,
                               .doc = "opening pressure above the outlet without a control signal"}),
      field<&Def::solenoid, &P::maximum_control_signal>("maximum_control_signal",
                                                        {.dimension = Dimension::electric_signal,
                                                         .range = kPositive,
                                                         .read_by = kReadBy,
                                                         .doc = "control signal of the full setting"}),
      field<&Def::solenoid, &P::solenoid_response>("solenoid_response",
                                                   {.dimension = Dimension::time,
                                                    .range = kPositive,
                                                    .change = Change::live,
                                                    .read_by = kReadBy,
                                                    .doc = "three time constants of the solenoid"}),
  };
  std::array<Field, N + rows.size()> table;
  std::copy(rows.begin(), rows.end(), std::copy(own.begin(), own.end(), table.begin()));
  return table;
}

class ProportionalSetting {
 public:
  template <typename Def>
  ProportionalSetting(const Def& def, CircuitBuilder& builder)
      : force_(def.is_proportional ? builder.add_state({.initial = 0, .scale = 1}) : -1),
        control_(def.is_proportional ? builder.add_control(def.name, SignalMoves::a_state) : -1) {}

  [[nodiscard]] bool is_used() const noexcept { return force_ >= 0; }
  [[nodiscard]] StateIndex state() const noexcept { return force_; }
  void declare(DependencyList& dependencies) const {
    if (is_used()) dependencies.add(force_, force_);
  }
  // (1); a signal that is not a number gives no force
  void add_rate(const CircuitView& view, const ProportionalParameters& def, Rates& rates) const noexcept {
    if (!is_used()) return;
    const double share = std::fmin(std::fmax(view.control[control_] / def.maximum_control_signal, 0), 1);
    rates.set_rate(force_, kTimeConstants / def.solenoid_response * (share - view[force_]));
  }
  void stamp_rate(const ProportionalParameters& def, JacobianStamp& jacobian) const noexcept {
    if (is_used()) jacobian.add(force_, force_, -kTimeConstants / def.solenoid_response);
  }
  // (2), with its slope over e
  [[nodiscard]] ValueSlope pressure(const CircuitView& view, const ProportionalParameters& def,
                                    double setting) const noexcept {
    if (!is_used()) return {setting, 0};
    const double range = std::fmax(setting - def.minimum_pressure, 0);
    return {def.minimum_pressure + view[force_] * range, range};
  }

 private:
  static constexpr double kTimeConstants = 3;  // in a step response, to 95 % of the change

  StateIndex force_;  // -1: not proportional
  int control_;
};

// A rule: the valve opens at a higher pressure with the signal than without. key: of the field of its setting.
template <typename Def>
void check_minimum_pressure(const Def& def, double setting, std::string_view key, Problems& errors) {
  if (!def.is_proportional || def.solenoid.minimum_pressure < setting) return;
  errors.push_back({def.name + ".minimum_pressure", "the pressure without a signal is not below that with the full one",
                    "less than " + std::string(key), ""});
}

}  // namespace slew::hydraulics
