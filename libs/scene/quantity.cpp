// SPDX-License-Identifier: Apache-2.0
#include "scene/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

namespace slew::scene {
namespace {

constexpr int kMostPower = 12;     // exponent of a quantity with a unit
constexpr int kMostExponent = 60;  // power of a base unit; fits its type after one more product
constexpr Exponents kAngle = {0, 0, 0, 0, 1};

std::string name_of_value(const Quantity& quantity) {
  return name_of(quantity.exponent);
}

bool has_unit(const Quantity& quantity) {
  return quantity.exponent != Exponents{};
}

Quantity number_like(double value, const Quantity& from) {
  return {value, {}, from.is_bare};
}

Quantity checked(std::size_t at, Quantity result) {
  if (!result.is_variable && !std::isfinite(result.value))
    refuse(at, "the result is not a finite number", "a finite number");
  for (const std::int8_t power : result.exponent) {
    if (std::abs(power) > kMostExponent) refuse(at, "the unit has too large a power");
  }
  if (has_unit(result)) result.is_bare = false;
  return result;
}

void require_same(std::size_t at, std::string_view operation, const Quantity& a, const Quantity& b) {
  if (a.exponent == b.exponent) return;
  std::string expected = a.exponent == Exponents{} ? "a number" : name_of_value(a) + ", as on the left";
  refuse(at, fmt::format("'{}' between {} and {}", operation, name_of_value(a), name_of_value(b)), std::move(expected));
}

// ---- functions

// angle, or a number taken as radians
double angle_argument(const FunctionCall& call) {
  const Quantity& x = call.arguments[0];
  if (has_unit(x) && x.exponent != kAngle) {
    refuse(call.places[0], fmt::format("{}() of {}", call.name, name_of_value(x)), "an angle, or a number in rad");
  }
  return x.value;
}

double number_argument(const FunctionCall& call) {
  const Quantity& x = call.arguments[0];
  if (has_unit(x)) refuse(call.places[0], fmt::format("{}() of {}", call.name, name_of_value(x)), "a number");
  return x.value;
}

double sine_argument(const FunctionCall& call) {
  const double x = number_argument(call);
  if (std::abs(x) > 1) refuse(call.places[0], fmt::format("{}() of {}", call.name, x), "a number of -1 to 1");
  return x;
}

Quantity ratio_of(double value) {
  return {value, {}, false};
}
Quantity angle_of(double value) {
  return {value, kAngle, false};
}

Quantity square_root(const FunctionCall& call) {
  const Quantity& x = call.arguments[0];
  if (x.value < 0) refuse(call.places[0], fmt::format("sqrt() of {}", x.value), "a value of at least 0");
  Quantity result = number_like(std::sqrt(x.value), x);
  for (std::size_t i = 0; i < x.exponent.size(); ++i) {
    if (x.exponent[i] % 2 != 0) {
      refuse(call.places[0], "sqrt() of " + name_of_value(x), "a quantity in even powers of its units, such as m2");
    }
    result.exponent[i] = static_cast<std::int8_t>(x.exponent[i] / 2);
  }
  return result;
}

Quantity extreme(const FunctionCall& call, bool is_largest) {
  Quantity result = call.arguments[0];
  for (std::size_t i = 1; i < call.arguments.size(); ++i) {
    const Quantity& next = call.arguments[i];
    require_same(call.places[i], call.name, result, next);
    const bool is_bare = result.is_bare && next.is_bare;
    if (is_largest ? next.value > result.value : next.value < result.value) result = next;
    result.is_bare = is_bare;
  }
  return result;
}

using Values = std::span<const double>;

constexpr ExpressionFunction kFunctions[] = {
    {"sin", 1, [](const FunctionCall& call) { return ratio_of(std::sin(angle_argument(call))); },
     [](Values x) { return std::sin(x[0]); }},
    {"cos", 1, [](const FunctionCall& call) { return ratio_of(std::cos(angle_argument(call))); },
     [](Values x) { return std::cos(x[0]); }},
    {"tan", 1, [](const FunctionCall& call) { return ratio_of(std::tan(angle_argument(call))); },
     [](Values x) { return std::tan(x[0]); }},
    {"asin", 1, [](const FunctionCall& call) { return angle_of(std::asin(sine_argument(call))); },
     [](Values x) { return std::asin(x[0]); }},
    {"acos", 1, [](const FunctionCall& call) { return angle_of(std::acos(sine_argument(call))); },
     [](Values x) { return std::acos(x[0]); }},
    {"atan", 1, [](const FunctionCall& call) { return angle_of(std::atan(number_argument(call))); },
     [](Values x) { return std::atan(x[0]); }},
    {"atan2", 2,
     [](const FunctionCall& call) {
       require_same(call.places[1], "atan2", call.arguments[0], call.arguments[1]);
       return angle_of(std::atan2(call.arguments[0].value, call.arguments[1].value));
     },
     [](Values x) { return std::atan2(x[0], x[1]); }},
    {"sqrt", 1, square_root, [](Values x) { return std::sqrt(x[0]); }},
    {"abs", 1,
     [](const FunctionCall& call) {
       Quantity x = call.arguments[0];
       x.value = std::abs(x.value);
       return x;
     },
     [](Values x) { return std::abs(x[0]); }},
    {"min", 0, [](const FunctionCall& call) { return extreme(call, false); },
     [](Values x) { return *std::min_element(x.begin(), x.end()); }},
    {"max", 0, [](const FunctionCall& call) { return extreme(call, true); },
     [](Values x) { return *std::max_element(x.begin(), x.end()); }},
};

}  // namespace

void refuse(std::size_t at, std::string what, std::string expected, std::string suggestion) {
  throw ExpressionFault{{at, {std::move(what), std::move(expected), std::move(suggestion)}}};
}

Quantity sum_of(std::size_t at, char sign, const Quantity& a, const Quantity& b) {
  require_same(at, std::string_view(&sign, 1), a, b);
  return checked(at, {sign == '+' ? a.value + b.value : a.value - b.value, a.exponent, a.is_bare && b.is_bare,
                      a.is_variable || b.is_variable});
}

Quantity product_of(std::size_t at, const Quantity& a, const Quantity& b, int sign) {
  if (sign < 0 && b.value == 0) refuse(at, "division by zero", "a divisor other than 0");
  Quantity result{sign > 0 ? a.value * b.value : a.value / b.value, a.exponent, a.is_bare && b.is_bare,
                  a.is_variable || b.is_variable};
  for (std::size_t i = 0; i < result.exponent.size(); ++i) {
    result.exponent[i] = static_cast<std::int8_t>(result.exponent[i] + sign * b.exponent[i]);
  }
  return checked(at, result);
}

Quantity power_of(std::size_t at, const Quantity& base, const Quantity& exponent) {
  if (has_unit(exponent)) refuse(at, "the exponent is " + name_of_value(exponent), "a number");
  if (base.value == 0 && exponent.value < 0) refuse(at, "division by zero: a negative power of 0", "another base");
  Quantity result{std::pow(base.value, exponent.value),
                  {},
                  base.is_bare && exponent.is_bare,
                  base.is_variable || exponent.is_variable};
  if (has_unit(base)) {
    if (exponent.is_variable) {
      refuse(at, name_of_value(base) + " to a power that changes during the run", "a constant exponent");
    }
    if (exponent.value != std::round(exponent.value) || std::abs(exponent.value) > kMostPower) {
      refuse(at, fmt::format("{} to the power {}", name_of_value(base), exponent.value),
             fmt::format("a whole exponent of at most {}, or sqrt()", kMostPower));
    }
    for (std::size_t i = 0; i < result.exponent.size(); ++i) {
      const int raised = base.exponent[i] * static_cast<int>(exponent.value);
      if (std::abs(raised) > kMostExponent) refuse(at, "the unit has too large a power");
      result.exponent[i] = static_cast<std::int8_t>(raised);
    }
  }
  return checked(at, result);
}

std::span<const ExpressionFunction> expression_functions() noexcept {
  return kFunctions;
}

const ExpressionFunction* find_function(std::string_view name) noexcept {
  const auto* found = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                   [&](const ExpressionFunction& function) { return function.name == name; });
  return found == std::end(kFunctions) ? nullptr : found;
}

Quantity apply(const ExpressionFunction& function, const FunctionCall& call) {
  const std::size_t count = call.arguments.size();
  if (function.arguments == 0 ? count == 0 : count != function.arguments) {
    refuse(call.at, fmt::format("{}() has {} arguments", function.name, count),
           function.arguments == 0 ? "one or more" : std::to_string(function.arguments));
  }
  Quantity result = function.apply(call);
  if (std::any_of(call.arguments.begin(), call.arguments.end(), [](const Quantity& x) { return x.is_variable; })) {
    result.is_variable = true;
    result.value = std::numeric_limits<double>::quiet_NaN();
  }
  return checked(call.at, result);
}

}  // namespace slew::scene
