// SPDX-License-Identifier: Apache-2.0
// Expressions of scene files: `${L/2 * cos(a)}`, arithmetic of quantities whose units are carried and checked.
//
//   sum     = product { ("+" | "-") product }
//   product = sign { ("*" | "/") sign }
//   sign    = ("-" | "+") sign | power
//   power   = atom [ "^" sign ]                   -2^2 is -4; 2^3^2 is 2^9
//   atom    = number [ unit ] | name | function "(" sum { "," sum } ")" | "(" sum ")"
//
// A word behind a number is its unit: `2 m`, `5 kg m2`, `3 m/s` (no spaces around this slash), `4 1/Pa`. `pi` and the
// functions sin cos tan asin acos atan atan2 sqrt abs min max are reserved. Sums, min, max and atan2 need one
// dimension; an exponent is a number, a whole one of -12 to 12 where its base has a unit; sqrt needs even powers. asin,
// acos, atan and atan2 give angles. Every value is a double in SI, every operation rounds once.
//
// A number without unit is bare as long as only bare numbers made it: it may stand for any SI quantity, as in a scene
// without expressions. A number of which the units cancelled, or that a function gave, is a ratio and stays a number.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "scene/diagnostic.h"
#include "scene/units.h"

namespace slew::scene {

inline constexpr std::size_t kMaxExpressionBytes = 500;
inline constexpr int kMaxExpressionDepth = 32;  // nested brackets, signs and powers

struct Quantity {
  double value = 0;  // SI
  Exponents exponent{};
  bool is_bare = true;       // a number without unit, from such numbers alone
  bool is_variable = false;  // its value changes during a run, and is NaN here
};

struct ExpressionProblem {
  std::size_t at = 0;  // byte of the expression
  ValueProblem problem;
};

// The value of a name, or its problem. Nothing of both: there is no such name.
struct NamedQuantity {
  std::optional<Quantity> quantity;
  std::optional<ValueProblem> problem;
  std::size_t variable = 0;  // index of a quantity that is a variable
};

class ExpressionNames {
 public:
  virtual ~ExpressionNames() = default;
  [[nodiscard]] virtual bool has(std::string_view name) const = 0;
  [[nodiscard]] virtual NamedQuantity value(std::string_view name) = 0;
  // Entry of a name that is a list, counted from 0; no name is one by default.
  [[nodiscard]] virtual NamedQuantity entry(std::string_view name, std::size_t number);
  [[nodiscard]] virtual std::string closest_of(std::string_view name) const = 0;
  // Names such as "Bag.position.x".
  [[nodiscard]] virtual bool have_dots() const { return false; }
};

struct ExpressionResult {
  std::optional<Quantity> quantity;  // finite
  ExpressionProblem fault;           // without a quantity
};

// Value of the text between `${` and `}`.
[[nodiscard]] ExpressionResult evaluate(std::string_view text, ExpressionNames& names, UnitSystem& units);

// "2.6 m", "500 kg", "3": a quantity as a value of a scene states it; a problem for texts.
[[nodiscard]] NamedQuantity quantity_of(std::string_view text, UnitSystem& units);

// The quantity as a value of a scene states it, which reads back to the same bits: "1.3 m", "3".
[[nodiscard]] std::string text_of(const Quantity& quantity);

// True for pi and the names of functions.
[[nodiscard]] bool is_reserved_in_expressions(std::string_view name);

}  // namespace slew::scene
