// SPDX-License-Identifier: Apache-2.0
// An expression (expression.h) of variables that change during a run: its unit is checked once, its value is then
// computed from the variables' values without reading the text again.
//
// The steps are in postfix order: operands first, then their operation. Each operation rounds once, as in evaluate().
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/expression.h"

namespace slew::scene {

struct ExpressionFunction;

struct ExpressionStep {
  enum class Kind : std::uint8_t { number, variable, negation, sum, difference, product, quotient, power, function };
  Kind kind = Kind::number;
  double number = 0;                             // SI
  std::size_t index = 0;                         // of a variable; of a function the number of its arguments
  const ExpressionFunction* function = nullptr;  // of a function
};

class CompiledExpression {
 public:
  CompiledExpression(std::vector<ExpressionStep> steps, const Exponents& exponent);

  // Value in SI. NaN or infinite where there is none, as for sqrt(-1) or 1/0. variables: values by index.
  [[nodiscard]] double value(std::span<const double> variables) const noexcept;
  [[nodiscard]] const Exponents& exponent() const noexcept { return exponent_; }
  // Index of the variable that the expression is; none: it is more than one name.
  [[nodiscard]] std::optional<std::size_t> only_variable() const noexcept;

 private:
  std::vector<ExpressionStep> steps_;
  Exponents exponent_;
};

struct CompiledResult {
  std::optional<CompiledExpression> expression;
  ExpressionProblem fault;  // without an expression
};

// names: variables are quantities with is_variable and an index.
[[nodiscard]] CompiledResult compile(std::string_view text, ExpressionNames& names, UnitSystem& units);

}  // namespace slew::scene
