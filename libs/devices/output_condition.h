// SPDX-License-Identifier: Apache-2.0
// Conditions on variables, and lamps, buzzers and contacts that they switch, by steps of time.
//
//   x > s: on when x > s for `delay`, off when x < s - hysteresis, at least `least_on` after it went on
//   x < s: mirrored. >= and <= are on at the threshold too
//
// A value that is not finite (a variable that is not published) changes nothing and is flagged. A switched output may
// pulse while its condition is on.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"

namespace slew::devices {

enum class Comparison : int { above, at_least, below, at_most };  // > >= < <=

// False for a value that is NaN.
[[nodiscard]] bool is_met(Comparison comparison, double value, double threshold) noexcept;

// "Vol_MainPump.pressure > 250 bar" in its three parts; the quantity is for the caller's table of units.
struct ConditionText {
  std::string variable;
  Comparison comparison{};
  std::string quantity;
};
// No value and a problem with the path for a text of another form.
[[nodiscard]] std::optional<ConditionText> parse_condition(std::string_view path, std::string_view text,
                                                           Problems& problems);

struct SwitchedOutputDef {
  std::string name;
  std::string variable{};
  Comparison comparison = Comparison::above;
  double threshold = 0;   // in the variable's SI unit
  double hysteresis = 0;  // in the variable's SI unit
  double delay = 0;       // s from the first value that meets the condition until the output goes on
  double least_on = 0;    // s
  double pulse_on = 0;    // s; 0: steady
  double pulse_off = 0;   // s
};

[[nodiscard]] std::span<const Field> switched_output_fields() noexcept;  // without the condition's own parts
void validate(const SwitchedOutputDef& def, Problems& problems);

struct SwitchedOutputState {
  bool is_on = false;     // condition: a change is an event
  bool is_lit = false;    // what is sent, with pulses
  bool is_known = false;  // the last value was finite
  bool is_met = false;    // while off: by the last finite value
  double time = 0;        // s: on since, or met since while off
  std::uint64_t changes = 0;
};

// One step of dt [s] with the variable's value at its end. 0 at the first value, at
// which an output without delay is on already. Result: whether is_on changed. Pre-condition: dt >= 0.
bool step(const SwitchedOutputDef& def, double value, double dt, SwitchedOutputState& state) noexcept;

}  // namespace slew::devices
