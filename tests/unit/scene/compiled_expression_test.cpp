// SPDX-License-Identifier: Apache-2.0
// Compiled expressions against evaluate() with the same numbers in place of the variables.
#include "scene/compiled_expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace slew::scene {
namespace compiled_expression_test {

// Three variables: a position [m], an angle [rad] and a number; as variables, or as constants with their values.
class Names final : public ExpressionNames {
 public:
  explicit Names(std::vector<double> constants = {}) : constants_(std::move(constants)) {}
  [[nodiscard]] bool has(std::string_view name) const override { return index_of(name).has_value(); }
  [[nodiscard]] bool have_dots() const override { return true; }
  [[nodiscard]] NamedQuantity value(std::string_view name) override {
    const auto index = index_of(name);
    if (!index) return {};
    constexpr Exponents kExponents[] = {{0, 1, 0, 0, 0}, {0, 0, 0, 0, 1}, {}};
    Quantity quantity{std::numeric_limits<double>::quiet_NaN(), kExponents[*index], false, true};
    if (!constants_.empty()) quantity = {constants_[*index], kExponents[*index], false};
    return {quantity, std::nullopt, *index};
  }
  [[nodiscard]] std::string closest_of(std::string_view) const override { return ""; }

 private:
  static std::optional<std::size_t> index_of(std::string_view name) {
    constexpr std::string_view kNames[] = {"Bag.position.x", "Hinge.angle", "u"};
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      if (kNames[i] == name) return i;
    }
    return std::nullopt;
  }
  std::vector<double> constants_;
};

std::string fault_of(const std::string& text) {
  UnitSystem units;
  Names names;
  const CompiledResult result = compile(text, names, units);
  return result.expression ? "accepted" : result.fault.problem.what;
}

TEST(CompiledExpression, HasTheValueAndUnitOfTheSameExpressionOfConstants) {
  UnitSystem units;
  const std::vector<double> values = {2.75, 0.5, -3};
  for (const char* text :
       {"Bag.position.x", "Bag.position.x - 2 m", "-Bag.position.x/3", "2^3^2 - -u", "Bag.position.x^3 / (4 m2)",
        "sin(Hinge.angle) * cos(Hinge.angle) + tan(0.1)", "atan2(Bag.position.x, 3 m) - Hinge.angle",
        "asin(u/7) + acos(u/7) + atan(u)", "sqrt(Bag.position.x^2 + (1 m)^2)", "abs(u)^1.5 * pi",
        "min(u, 3, -5) + max(u, 2, 1)", "1 / (1 m - Bag.position.x) * (u + 2 * (u - 4 * (u * u)))"}) {
    Names variables, constants(values);
    const CompiledResult result = compile(text, variables, units);
    ASSERT_TRUE(result.expression) << text << ": " << result.fault.problem.what;
    const ExpressionResult expected = evaluate(text, constants, units);
    ASSERT_TRUE(expected.quantity) << text;
    EXPECT_EQ(result.expression->value(values), expected.quantity->value) << text;
    EXPECT_EQ(result.expression->exponent(), expected.quantity->exponent) << text;
  }
}

TEST(CompiledExpression, ChecksUnitsWithoutValues) {
  EXPECT_EQ(fault_of("Bag.position.x + Hinge.angle"), "'+' between a length and an angle");
  EXPECT_EQ(fault_of("Bag.position.x ^ u"), "a length to a power that changes during the run");
  EXPECT_EQ(fault_of("sqrt(Bag.position.x)"), "sqrt() of a length");
  EXPECT_EQ(fault_of("1 / (1 - 1)"), "division by zero");
  EXPECT_EQ(fault_of("1 / max(0, u)"), "accepted");
  EXPECT_EQ(fault_of("Bag.position.z"), "there is no parameter 'Bag.position.z'");
}

TEST(CompiledExpression, HasNoValueWhereThereIsNone) {
  UnitSystem units;
  Names names;
  EXPECT_TRUE(std::isnan(compile("sqrt(u)", names, units).expression->value(std::vector<double>{0, 0, -1})));
  EXPECT_TRUE(std::isinf(compile("1 / u", names, units).expression->value(std::vector<double>{0, 0, 0})));
}

TEST(CompiledExpression, NamesItsOnlyVariable) {
  UnitSystem units;
  Names names;
  EXPECT_EQ(compile("Hinge.angle", names, units).expression->only_variable(), 1u);
  EXPECT_EQ(compile("-Hinge.angle", names, units).expression->only_variable(), std::nullopt);
}

}  // namespace compiled_expression_test
}  // namespace slew::scene
