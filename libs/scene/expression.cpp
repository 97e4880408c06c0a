// SPDX-License-Identifier: Apache-2.0
#include "scene/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "scene/compiled_expression.h"
#include "scene/number.h"
#include "scene/quantity.h"

namespace slew::scene {
namespace {

bool begins_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit_of(char c) {
  return c >= '0' && c <= '9';
}
bool continues_word(char c) {
  return begins_word(c) || is_digit_of(c);
}
bool begins_unit(char c) {
  return begins_word(c) || c == '%' || static_cast<unsigned char>(c) >= 0x80;
}

// ---- reading

using Kind = ExpressionStep::Kind;

class Evaluator {
 public:
  // steps: receives what was evaluated, in postfix order.
  Evaluator(std::string_view text, ExpressionNames& names, UnitSystem& units, std::vector<ExpressionStep>& steps)
      : text_(text), names_(names), units_(units), steps_(steps) {}

  Quantity evaluate() {
    skip_spaces();
    if (at_ == text_.size()) refuse(at_, "the expression is empty", "a value such as ${L/2}");
    const Quantity result = read_sum();
    if (at_ < text_.size()) refuse_rest();
    return result;
  }

 private:
  [[nodiscard]] char next(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  void skip_spaces() {
    while (next() == ' ' || next() == '\t' || next() == '\n') ++at_;
  }
  bool take(char c) {
    if (next() != c) return false;
    ++at_;
    skip_spaces();
    return true;
  }
  [[noreturn]] void refuse_rest() const {
    if (next() == ')') refuse(at_, "this bracket was not opened", "an operator, or the end");
    if (next() == ',') refuse(at_, "a comma outside of a function's arguments", "a decimal point, or an operator");
    if (begins_word(next()) || is_digit_of(next()) || next() == '(') {
      refuse(at_, "an operator is missing here", "+ - * / or ^");
    }
    refuse(at_, fmt::format("'{}' cannot stand here", next()), "+ - * / ^ or the end");
  }

  struct Level {
    explicit Level(Evaluator& evaluator) : depth(evaluator.depth_) {
      if (++depth > kMaxExpressionDepth) {
        refuse(evaluator.at_, "the expression is nested too deeply",
               fmt::format("at most {} levels", kMaxExpressionDepth));
      }
    }
    ~Level() { --depth; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    int& depth;
  };

  Quantity read_sum() {
    Quantity left = read_product();
    while (next() == '+' || next() == '-') {
      const std::size_t at = at_;
      const char sign = next();
      take(sign);
      left = sum_of(at, sign, left, read_product());
      steps_.push_back({.kind = sign == '+' ? Kind::sum : Kind::difference});
    }
    return left;
  }

  Quantity read_product() {
    Quantity left = read_sign();
    while (next() == '*' || next() == '/') {
      const std::size_t at = at_;
      const int sign = next() == '*' ? 1 : -1;
      take(next());
      if (next() == '*') refuse(at, "'**' is no operator", "^ for a power");
      left = product_of(at, left, read_sign(), sign);
      steps_.push_back({.kind = sign > 0 ? Kind::product : Kind::quotient});
    }
    return left;
  }

  Quantity read_sign() {
    if (next() != '-' && next() != '+') return read_power();
    const Level level(*this);
    const bool is_minus = next() == '-';
    take(next());
    Quantity value = read_sign();
    if (!is_minus) return value;
    value.value = -value.value;
    steps_.push_back({.kind = Kind::negation});
    return value;
  }

  Quantity read_power() {
    const Quantity base = read_atom();
    const std::size_t at = at_;
    if (!take('^')) return base;
    const Level level(*this);
    const Quantity power = power_of(at, base, read_sign());
    steps_.push_back({.kind = Kind::power});
    return power;
  }

  Quantity read_atom() {
    if (is_digit_of(next()) || (next() == '.' && is_digit_of(next(1)))) return read_number();
    if (begins_word(next())) return read_name();
    const std::size_t opened = at_;
    if (!take('(')) {
      if (at_ == text_.size()) refuse(at_, "the expression ends here", "a value");
      refuse(at_, fmt::format("'{}' is no value", next()), "a number, a name or '('");
    }
    const Level level(*this);
    const Quantity inner = read_sum();
    if (!take(')')) refuse_unclosed(opened);
    return inner;
  }

  [[noreturn]] void refuse_unclosed(std::size_t opened) const {
    if (at_ < text_.size() && next() != ',') refuse_rest();
    refuse(opened, "this bracket is not closed", "')'");
  }

  // digits [. digits] [e [sign] digits] [unit]
  Quantity read_number() {
    const std::size_t begin = at_;
    const auto digits = [&] {
      while (is_digit_of(next())) ++at_;
    };
    digits();
    if (next() == '.') ++at_, digits();
    if (next() == 'e' || next() == 'E') {
      const std::size_t sign = next(1) == '-' || next(1) == '+' ? 1 : 0;
      if (is_digit_of(next(1 + sign))) at_ += 1 + sign, digits();
    }
    const std::size_t end = at_;
    skip_spaces();
    const bool has_unit_here = begins_unit(next()) || (next() == '1' && next(1) == '/' && begins_unit(next(2)));
    if (has_unit_here) read_unit();
    const NamedQuantity found = quantity_of(text_.substr(begin, (has_unit_here ? at_ : end) - begin), units_);
    if (!found.quantity) throw ExpressionFault{{begin, *found.problem}};
    skip_spaces();
    return constant(*found.quantity);
  }

  Quantity constant(const Quantity& quantity) {
    steps_.push_back({.kind = Kind::number, .number = quantity.value});
    return quantity;
  }

  // A parameter whose name is no unit. One that is named as a unit, such as m, does not hide the unit.
  [[nodiscard]] bool is_parameter_alone(std::string_view word) {
    return names_.has(word) && units_.find(word) == nullptr;
  }

  // moves behind the unit
  void read_unit() {
    if (next() == '1') at_ += 2;
    const std::string_view first = word_at(at_);
    if (is_parameter_alone(first)) {
      refuse(at_, fmt::format("'{}' is a parameter and is no unit", first),
             "an operator before it, or another name of the parameter");
    }
    read_unit_word();
    while (true) {
      std::size_t gap = 0;
      while (next(gap) == ' ') ++gap;
      const bool is_joined = gap == 0 && (next() == '/' || next() == '.') && begins_unit(next(1));
      if (!is_joined && (gap == 0 || !begins_unit(next(gap)))) break;
      const std::size_t place = at_ + (is_joined ? 1 : gap);
      const std::string_view word = word_at(place);
      if (is_parameter_alone(word)) {
        refuse(at_, fmt::format("'{}' is a parameter and is no unit", word),
               is_joined ? "spaces around '/'" : "an operator before it");
      }
      at_ = place;
      read_unit_word();
    }
    if (next() == '^') refuse(at_, "'^' behind a unit", "a power as in 'm2', or brackets around the quantity");
  }
  [[nodiscard]] std::string_view word_at(std::size_t place) const {
    std::size_t end = place;
    while (end < text_.size() && continues_word(text_[end])) ++end;
    return text_.substr(place, end - place);
  }
  void read_unit_word() {
    while (begins_unit(next())) ++at_;
    while (is_digit_of(next())) ++at_;
  }

  Quantity read_name() {
    const std::size_t begin = at_;
    while (continues_word(next()) || (names_.have_dots() && next() == '.' && begins_word(next(1)))) ++at_;
    const std::string_view name = text_.substr(begin, at_ - begin);
    skip_spaces();
    const ExpressionFunction* function = find_function(name);
    if (next() == '(') {
      if (function == nullptr) refuse_function(begin, name);
      return call(*function, begin);
    }
    if (function != nullptr) refuse(begin, fmt::format("'{}' is a function", name), fmt::format("{}(...)", name));
    if (name == "pi") return constant({std::numbers::pi, {}, true});
    NamedQuantity found = next() == '[' ? read_entry(name) : names_.value(name);
    if (found.problem) throw ExpressionFault{{begin, std::move(*found.problem)}};
    if (!found.quantity) {
      refuse(begin, fmt::format("there is no parameter '{}'", name), "", names_.closest_of(name));
    }
    if (!found.quantity->is_variable) return constant(*found.quantity);
    steps_.push_back({.kind = Kind::variable, .index = found.variable});
    return *found.quantity;
  }

  // edges[1]: an entry of a list, counted from 0
  NamedQuantity read_entry(std::string_view name) {
    const std::size_t opened = at_;
    take('[');
    constexpr std::size_t kLongest = 6;  // digits; no list of a scene is longer
    std::size_t number = 0, digits = 0;
    for (; is_digit_of(next()) && digits < kLongest; ++at_, ++digits) {
      number = 10 * number + static_cast<std::size_t>(next() - '0');
    }
    skip_spaces();
    if (digits == 0 || next() != ']') refuse(opened, "this is no entry of a list", "its number from 0, as in L[2]");
    take(']');
    return names_.entry(name, number);
  }

  [[noreturn]] static void refuse_function(std::size_t at, std::string_view name) {
    std::vector<std::string_view> known;
    for (const ExpressionFunction& function : expression_functions()) known.push_back(function.name);
    refuse(at, fmt::format("there is no function '{}'", name),
           "sin, cos, tan, asin, acos, atan, atan2, sqrt, abs, min or max", closest(name, known));
  }

  Quantity call(const ExpressionFunction& function, std::size_t at) {
    const Level level(*this);
    const std::size_t opened = at_;
    take('(');
    FunctionCall call{function.name, at, {}, {}};
    while (next() != ')') {
      call.places.push_back(at_);
      call.arguments.push_back(read_sum());
      if (!take(',')) break;
    }
    if (!take(')')) refuse_unclosed(opened);
    const Quantity result = apply(function, call);
    steps_.push_back({.kind = Kind::function, .index = call.arguments.size(), .function = &function});
    return result;
  }

  std::string_view text_;
  ExpressionNames& names_;
  UnitSystem& units_;
  std::vector<ExpressionStep>& steps_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

ExpressionResult read(std::string_view text, ExpressionNames& names, UnitSystem& units,
                      std::vector<ExpressionStep>& steps) {
  if (text.size() > kMaxExpressionBytes) {
    return {std::nullopt,
            {0,
             {fmt::format("the expression has {} characters", text.size()),
              fmt::format("at most {}; parameters hold its parts", kMaxExpressionBytes), ""}}};
  }
  try {
    return {Evaluator(text, names, units, steps).evaluate(), {}};
  } catch (ExpressionFault& fault) {
    return {std::nullopt, std::move(fault.problem)};
  }
}

}  // namespace

NamedQuantity ExpressionNames::entry(std::string_view name, std::size_t) {
  return {std::nullopt, ValueProblem{fmt::format("'{}' is no list", name), "a name without [...]", ""}};
}

ExpressionResult evaluate(std::string_view text, ExpressionNames& names, UnitSystem& units) {
  std::vector<ExpressionStep> steps;
  return read(text, names, units, steps);
}

CompiledResult compile(std::string_view text, ExpressionNames& names, UnitSystem& units) {
  std::vector<ExpressionStep> steps;
  ExpressionResult result = read(text, names, units, steps);
  if (!result.quantity) return {std::nullopt, std::move(result.fault)};
  return {CompiledExpression(std::move(steps), result.quantity->exponent), {}};
}

NamedQuantity quantity_of(std::string_view text, UnitSystem& units) {
  const NumberText number = split_number(text);
  if (!number.is_number) return {std::nullopt, number.problem};
  if (number.rest.empty()) return {Quantity{static_cast<double>(number.value), {}, true}, std::nullopt};
  const Unit* unit = units.find(number.rest);
  if (unit == nullptr) {
    return {std::nullopt,
            ValueProblem{fmt::format("unknown unit '{}'", number.rest), "a unit such as m, deg or bar", ""}};
  }
  if (unit->has_other_base) {
    return {std::nullopt,
            ValueProblem{fmt::format("'{}' is no mechanical quantity", text), "units of kg, m, s, K, rad", ""}};
  }
  const auto value = static_cast<double>(number.value * unit->scale + unit->offset);
  if (!std::isfinite(value)) {
    return {std::nullopt,
            ValueProblem{fmt::format("'{}' is beyond what a number can hold", text), "a finite number", ""}};
  }
  return {Quantity{value, unit->exponent, false}, std::nullopt};
}

std::string text_of(const Quantity& quantity) {
  const std::string unit = si_unit_of(quantity.exponent);
  return unit.empty() ? fmt::format("{}", quantity.value) : fmt::format("{} {}", quantity.value, unit);
}

bool is_reserved_in_expressions(std::string_view name) {
  return name == "pi" || find_function(name) != nullptr;
}

}  // namespace slew::scene
