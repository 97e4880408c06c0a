// SPDX-License-Identifier: Apache-2.0
#include "scene/compiled_expression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "scene/quantity.h"

namespace slew::scene {

using Kind = ExpressionStep::Kind;

CompiledExpression::CompiledExpression(std::vector<ExpressionStep> steps, const Exponents& exponent)
    : steps_(std::move(steps)), exponent_(exponent) {}

double CompiledExpression::value(std::span<const double> variables) const noexcept {
  // each operand takes a character of the text
  std::array<double, kMaxExpressionBytes> stack;
  std::size_t size = 0;
  for (const ExpressionStep& step : steps_) {
    if (step.kind == Kind::number || step.kind == Kind::variable) {
      stack[size++] = step.kind == Kind::number ? step.number : variables[step.index];
      continue;
    }
    if (step.kind == Kind::negation) {
      stack[size - 1] = -stack[size - 1];
      continue;
    }
    const std::size_t operands = step.kind == Kind::function ? step.index : 2;
    size -= operands;
    double& a = stack[size++];
    const double b = operands > 1 ? (&a)[1] : 0;
    switch (step.kind) {
      case Kind::sum:
        a = a + b;
        break;
      case Kind::difference:
        a = a - b;
        break;
      case Kind::product:
        a = a * b;
        break;
      case Kind::quotient:
        a = a / b;
        break;
      case Kind::power:
        a = std::pow(a, b);
        break;
      default:
        a = step.function->value({&a, operands});
        break;
    }
  }
  return stack[0];
}

std::optional<std::size_t> CompiledExpression::only_variable() const noexcept {
  const bool is_one = steps_.size() == 1 && steps_.front().kind == Kind::variable;
  return is_one ? std::optional(steps_.front().index) : std::nullopt;
}

}  // namespace slew::scene
