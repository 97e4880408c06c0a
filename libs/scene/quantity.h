// SPDX-License-Identifier: Apache-2.0
// Arithmetic and functions of quantities (expression.h). Internal to the library.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/expression.h"

namespace slew::scene {

// Ends an evaluation; does not leave evaluate().
struct ExpressionFault {
  ExpressionProblem problem;
};
[[noreturn]] void refuse(std::size_t at, std::string what, std::string expected = "", std::string suggestion = "");

// at: byte of the operator, for problems. sign: '+' or '-'; 1: product, -1: quotient.
[[nodiscard]] Quantity sum_of(std::size_t at, char sign, const Quantity& a, const Quantity& b);
[[nodiscard]] Quantity product_of(std::size_t at, const Quantity& a, const Quantity& b, int sign);
[[nodiscard]] Quantity power_of(std::size_t at, const Quantity& base, const Quantity& exponent);

struct FunctionCall {
  std::string_view name;
  std::size_t at = 0;
  std::vector<Quantity> arguments;
  std::vector<std::size_t> places;
};

struct ExpressionFunction {
  std::string_view name;
  std::size_t arguments;  // 0: one or more
  Quantity (*apply)(const FunctionCall& call);
  // The same of values in SI; NaN where there is none.
  double (*value)(std::span<const double> arguments);
};

[[nodiscard]] std::span<const ExpressionFunction> expression_functions() noexcept;
// Null: there is none of this name.
[[nodiscard]] const ExpressionFunction* find_function(std::string_view name) noexcept;
// Checks the number of arguments and the result.
[[nodiscard]] Quantity apply(const ExpressionFunction& function, const FunctionCall& call);

}  // namespace slew::scene
