// SPDX-License-Identifier: Apache-2.0
// Expressions: values and units against the same formulas in C++, and every way to be refused with its place.
#include "scene/expression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace slew::scene {
namespace expression_test {

class Names final : public ExpressionNames {
 public:
  explicit Names(UnitSystem& units) : units_(units) {}
  [[nodiscard]] bool has(std::string_view name) const override { return values_.contains(name); }
  [[nodiscard]] NamedQuantity value(std::string_view name) override {
    const auto found = values_.find(name);
    return found == values_.end() ? NamedQuantity{} : quantity_of(found->second, units_);
  }
  [[nodiscard]] std::string closest_of(std::string_view name) const override { return name == "Lenght" ? "L" : ""; }

 private:
  UnitSystem& units_;
  const std::map<std::string, std::string, std::less<>> values_ = {
      {"L", "2.6 m"}, {"a", "30 deg"}, {"M", "500 kg"}, {"n", "3"}, {"p", "250 bar"}, {"t", "4 s"}, {"half", "1.3 m"}};
};

Quantity value_of(const std::string& text) {
  UnitSystem units;
  Names names(units);
  const ExpressionResult result = evaluate(text, names, units);
  EXPECT_TRUE(result.quantity) << text << ": " << result.fault.problem.what;
  return result.quantity.value_or(Quantity{});
}

// "place: what; expected"
std::string fault_of(const std::string& text) {
  UnitSystem units;
  Names names(units);
  const ExpressionResult result = evaluate(text, names, units);
  if (result.quantity) return "accepted";
  const ValueProblem& problem = result.fault.problem;
  std::string fault = std::to_string(result.fault.at) + ": " + problem.what;
  if (!problem.expected.empty()) fault += "; " + problem.expected;
  if (!problem.suggestion.empty()) fault += "; " + problem.suggestion + "?";
  return fault;
}

const double kAngle = static_cast<double>(std::numbers::pi_v<long double> / 6);

TEST(Expression, HasTheValueOfTheSameFormulaInDoubles) {
  EXPECT_EQ(value_of("L/2 * cos(a)").value, 2.6 / 2 * std::cos(kAngle));
  EXPECT_EQ(value_of("L/2 * cos(a)").exponent, (Exponents{0, 1, 0, 0, 0}));
  EXPECT_EQ(value_of("0.1 + 0.2").value, 0.1 + 0.2);
  EXPECT_EQ(value_of("1 - 2 - 3").value, -4);
  EXPECT_EQ(value_of("2 + 3 * 4").value, 14);
  EXPECT_EQ(value_of("(2 + 3) * 4").value, 20);
  EXPECT_EQ(value_of("-2^2").value, -4);
  EXPECT_EQ(value_of("2^3^2").value, 512);
  EXPECT_EQ(value_of("2^-1").value, 0.5);
  EXPECT_EQ(value_of("8/4/2").value, 1);
  EXPECT_EQ(value_of("- -3").value, 3);
  EXPECT_EQ(value_of("atan2(3 m, 4 m)").value, std::atan2(3.0, 4.0));
  EXPECT_EQ(value_of("sqrt(L^2 + (1 m)^2)").value, std::sqrt(std::pow(2.6, 2) + std::pow(1.0, 2)));
  EXPECT_EQ(value_of("min(3, 1, 2)").value, 1);
  EXPECT_EQ(value_of("max(L, 3 m)").value, 3);
  EXPECT_EQ(value_of("abs(-L)").value, 2.6);
  EXPECT_EQ(value_of("asin(0.5)").value, std::asin(0.5));
  EXPECT_EQ(value_of("pi").value, std::numbers::pi);
}

TEST(Expression, ReadsANumberWithItsUnitToTheSameBitsAsAScene) {
  for (const char* text : {"1050 mm", "0.75 inch", "37.5 deg", "250 bar", "70 l/min", "140 cc/rev", "672.81864 kg m2",
                           "3.5e-7 1/Pa", "46 cSt", "32 %", "40 degC", "1e10 Pa", "5000 Nms/rad", "1.33 m3/s/Pa"}) {
    UnitSystem units;
    const NamedQuantity expected = quantity_of(text, units);
    ASSERT_TRUE(expected.quantity) << text;
    EXPECT_EQ(value_of(text).value, expected.quantity->value) << text;
    EXPECT_EQ(value_of(text).exponent, expected.quantity->exponent) << text;
  }
  EXPECT_EQ(value_of("1050 mm").value, 1.05);
}

TEST(Expression, CarriesUnits) {
  EXPECT_EQ(value_of("M * L^2").exponent, (Exponents{1, 2, 0, 0, 0}));
  EXPECT_EQ(value_of("p * 3 cm2").exponent, (Exponents{1, 1, -2, 0, 0}));
  EXPECT_EQ(value_of("a / t").exponent, (Exponents{0, 0, -1, 0, 1}));
  EXPECT_EQ(value_of("sqrt(2 * p / (870 kg/m3))").exponent, (Exponents{0, 1, -1, 0, 0}));
  EXPECT_EQ(value_of("asin(L / (4 m))").exponent, (Exponents{0, 0, 0, 0, 1}));
  EXPECT_EQ(value_of("L / t").exponent, value_of("1 m/s").exponent);
}

TEST(Expression, ANumberIsBareUntilAUnitTakesPart) {
  EXPECT_TRUE(value_of("2 * n + pi").is_bare);
  EXPECT_FALSE(value_of("L / (2 m)").is_bare);
  EXPECT_FALSE(value_of("cos(a)").is_bare);
  EXPECT_FALSE(value_of("32 %").is_bare);
  EXPECT_FALSE(value_of("min(n, cos(a))").is_bare);
}

TEST(Expression, AWordBehindANumberIsItsUnit) {
  EXPECT_EQ(value_of("2 m / t").value, 0.5);  // spaces around the slash: a division
  EXPECT_EQ(value_of("2 * M").value, 1000);
  EXPECT_EQ(fault_of("1 half"),
            "2: 'half' is a parameter and is no unit; an operator before it, or another name of the parameter");
  EXPECT_EQ(fault_of("2 m/half"), "3: 'half' is a parameter and is no unit; spaces around '/'");
  EXPECT_EQ(fault_of("2 m half"), "3: 'half' is a parameter and is no unit; an operator before it");
  EXPECT_EQ(fault_of("2 m^2"), "3: '^' behind a unit; a power as in 'm2', or brackets around the quantity");
}

// Every word is a parameter of 7 kg.
class NamesAsUnits final : public ExpressionNames {
 public:
  [[nodiscard]] bool has(std::string_view name) const override { return !name.empty(); }
  [[nodiscard]] NamedQuantity value(std::string_view) override {
    return {Quantity{7, {1, 0, 0, 0, 0}, false}, std::nullopt};
  }
  [[nodiscard]] std::string closest_of(std::string_view) const override { return ""; }
};

TEST(Expression, AParameterNamedAsAUnitDoesNotHideTheUnit) {
  UnitSystem units;
  NamesAsUnits names;
  for (const char* text : {"500 N/m", "2.5 t",        "3 m/s",   "250 bar", "5 L",    "2 rad", "4 kg m2",    "6 h",
                           "7 min",   "70 l/min",     "9 deg/s", "3 1/s",   "1 kN",   "8 N m", "140 cc/rev", "3e2 N/m",
                           "1t",      "5000 Nms/rad", "2 g",     "40 degC", "2 m/s2", "5 K"}) {
    const NamedQuantity expected = quantity_of(text, units);
    ASSERT_TRUE(expected.quantity) << text;
    const ExpressionResult result = evaluate(text, names, units);
    ASSERT_TRUE(result.quantity) << text << ": " << result.fault.problem.what;
    EXPECT_EQ(result.quantity->value, expected.quantity->value) << text;
    EXPECT_EQ(result.quantity->exponent, expected.quantity->exponent) << text;
  }
  // apart from a number the word is the parameter
  for (const char* text : {"m", "500 N / m * m / (1 N) * m / 500", "1 * m", "0.5*(m + s)", "(14)/(2) * t"}) {
    const ExpressionResult result = evaluate(text, names, units);
    ASSERT_TRUE(result.quantity) << text << ": " << result.fault.problem.what;
    EXPECT_EQ(result.quantity->exponent, (Exponents{1, 0, 0, 0, 0})) << text;
  }
}

TEST(Expression, TextsOfQuantitiesReadBackToTheSameBits) {
  UnitSystem units;
  for (const char* text :
       {"L/3", "M * L^2 / 7", "a / 7", "p / 3", "1 / t", "L * a", "M / (3 * t^5)", "n / 7", "M * a^2", "(40 degC) / 3",
        "p * L^3", "1 / (3 m)", "p / (7 * t)", "L^3 / (7 * a)", "M / (7 * t)"}) {
    const Quantity quantity = value_of(text);
    const NamedQuantity again = quantity_of(text_of(quantity), units);
    ASSERT_TRUE(again.quantity) << text << " is " << text_of(quantity);
    EXPECT_EQ(again.quantity->value, quantity.value) << text_of(quantity);
    EXPECT_EQ(again.quantity->exponent, quantity.exponent) << text_of(quantity);
  }
}

TEST(Expression, UnitsThatDoNotFitAreRefusedAtTheOperator) {
  EXPECT_EQ(fault_of("L + a"), "2: '+' between a length and an angle; a length, as on the left");
  EXPECT_EQ(fault_of("L - 1"), "2: '-' between a length and a number; a length, as on the left");
  EXPECT_EQ(fault_of("1 + L"), "2: '+' between a number and a length; a number");
  EXPECT_EQ(fault_of("max(L, a)"), "7: 'max' between a length and an angle; a length, as on the left");
  EXPECT_EQ(fault_of("2 * sin(L)"), "8: sin() of a length; an angle, or a number in rad");
  EXPECT_EQ(fault_of("sqrt(L)"), "5: sqrt() of a length; a quantity in even powers of its units, such as m2");
  EXPECT_EQ(fault_of("L^0.5"), "1: a length to the power 0.5; a whole exponent of at most 12, or sqrt()");
  EXPECT_EQ(fault_of("2^L"), "1: the exponent is a length; a number");
  EXPECT_EQ(fault_of("acos(a)"), "5: acos() of an angle; a number");
  EXPECT_EQ(fault_of("L^12^2"), "1: a length to the power 144; a whole exponent of at most 12, or sqrt()");
  EXPECT_EQ(fault_of("(L^12)^6"), "6: the unit has too large a power");
}

TEST(Expression, ValuesThatDoNotExistAreRefused) {
  EXPECT_EQ(fault_of("1 / (n - 3)"), "2: division by zero; a divisor other than 0");
  EXPECT_EQ(fault_of("0^-1"), "1: division by zero: a negative power of 0; another base");
  EXPECT_EQ(fault_of("asin(1.5)"), "5: asin() of 1.5; a number of -1 to 1");
  EXPECT_EQ(fault_of("sqrt(-1)"), "5: sqrt() of -1; a value of at least 0");
  EXPECT_EQ(fault_of("(-8)^(1/3)"), "4: the result is not a finite number; a finite number");
  EXPECT_EQ(fault_of("1e300 * 1e300"), "6: the result is not a finite number; a finite number");
}

TEST(Expression, TextsThatAreNoExpressionAreRefusedAtTheirPlace) {
  EXPECT_EQ(fault_of(""), "0: the expression is empty; a value such as ${L/2}");
  EXPECT_EQ(fault_of("Lenght / 2"), "0: there is no parameter 'Lenght'; L?");
  EXPECT_EQ(fault_of("L /"), "3: the expression ends here; a value");
  EXPECT_EQ(fault_of("(L + 1 m"), "0: this bracket is not closed; ')'");
  EXPECT_EQ(fault_of("L)"), "1: this bracket was not opened; an operator, or the end");
  EXPECT_EQ(fault_of("L L"), "2: an operator is missing here; + - * / or ^");
  EXPECT_EQ(fault_of("1,5"), "1: a comma outside of a function's arguments; a decimal point, or an operator");
  EXPECT_EQ(fault_of("2 ** 3"), "2: '**' is no operator; ^ for a power");
  EXPECT_EQ(fault_of("cos"), "0: 'cos' is a function; cos(...)");
  EXPECT_EQ(fault_of("coss(a)"),
            "0: there is no function 'coss'; sin, cos, tan, asin, acos, atan, atan2, sqrt, abs, min or max; cos?");
  EXPECT_EQ(fault_of("atan2(L)"), "0: atan2() has 1 arguments; 2");
  EXPECT_EQ(fault_of("min()"), "0: min() has 0 arguments; one or more");
  EXPECT_EQ(fault_of("5 furlongz"), "0: unknown unit 'furlongz'; a unit such as m, deg or bar");
  EXPECT_EQ(fault_of("010"), "0: '010' looks octal; 10 or 8");
  EXPECT_EQ(fault_of("L & 3"), "2: '&' cannot stand here; + - * / ^ or the end");
  EXPECT_EQ(fault_of("[1]"), "0: '[' is no value; a number, a name or '('");
}

TEST(Expression, LengthAndDepthAreBounded) {
  EXPECT_NE(fault_of(std::string(501, '1')).find("the expression has 501 characters"), std::string::npos);
  EXPECT_EQ(value_of(std::string(31, '(') + "1" + std::string(31, ')')).value, 1);
  EXPECT_NE(fault_of(std::string(33, '(') + "1" + std::string(33, ')')).find("nested too deeply"), std::string::npos);
  EXPECT_NE(fault_of(std::string(40, '-') + "1").find("nested too deeply"), std::string::npos);
  EXPECT_NE(fault_of("1" +
                     [] {
                       std::string powers;
                       for (int i = 0; i < 40; ++i) powers += "^1";
                       return powers;
                     }())
                .find("nested too deeply"),
            std::string::npos);
}

}  // namespace expression_test
}  // namespace slew::scene
