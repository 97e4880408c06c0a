// SPDX-License-Identifier: Apache-2.0
#include "core/display.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace slew {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr DisplayUnit kRpm{30 / std::numbers::pi, "rpm"};

constexpr std::pair<std::string_view, DisplayUnit> kUnits[] = {{"Pa", {1e-5, "bar"}},
                                                               {"Pa/s", {1e-5, "bar/s"}},
                                                               {"m3/s", {6e4, "l/min"}},
                                                               {"m3", {1e3, "l"}},
                                                               {"rad", {kDegrees, "deg"}},
                                                               {"rad/s", {kDegrees, "deg/s"}},
                                                               {"N", {1e-3, "kN"}},
                                                               {"N m", {1e-3, "kN m"}},
                                                               {"N/m", {1e-6, "kN/mm"}},
                                                               {"J", {1e-3, "kJ"}},
                                                               {"W", {1e-3, "kW"}},
                                                               {"1", {1, ""}},
                                                               {"rad/s2", {kDegrees, "deg/s2"}}};

// further units in which users choose values
constexpr std::pair<std::string_view, DisplayUnit> kUnitsOfData[] = {
    {"m", {1e3, "mm"}}, {"m2", {1e4, "cm2"}},   {"m3", {1e6, "cm3"}},
    {"rad/s", kRpm},    {"m2/s", {1e6, "cSt"}}, {"m3/rad", {2e6 * std::numbers::pi, "cm3/rev"}}};

bool is_shaft_speed(std::string_view variable) {
  return variable.ends_with(".speed") || variable.ends_with(".speed_setting");
}

// the fewest digits that give the value again, at most six
std::string few_digits(double value) {
  constexpr int kMostDigits = 6;
  constexpr double kSame = 1e-9;  // relative; scaling to another unit costs some 1e-16
  double rounded = value;
  for (int digits = 1; digits <= kMostDigits; ++digits) {
    rounded = std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
    if (std::fabs(rounded - value) <= kSame * std::fabs(value)) break;
  }
  return rounded == 0 ? "0" : fmt::format("{}", rounded);
}

std::string without_sign_of_zero(std::string text) {
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  if (is_zero && text.starts_with('-')) text.erase(0, 1);
  return text;
}

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text + ' ' + std::string(unit);
}

}  // namespace

DisplayUnit display_unit(std::string_view si_unit, std::string_view variable) {
  if (si_unit == "rad/s" && is_shaft_speed(variable)) return kRpm;
  for (const auto& [unit, shown] : kUnits) {
    if (unit == si_unit) return shown;
  }
  return {1, si_unit};
}

std::string digits_text(double value, int digits) {
  return without_sign_of_zero(fmt::format("{:.{}g}", value, digits));
}

std::string decimals_text(double value, int decimals) {
  return without_sign_of_zero(fmt::format("{:.{}f}", value, decimals));
}

std::string quantity_text(double value, std::string_view si_unit, std::string_view variable) {
  // what rounding leaves of an angle of zero
  constexpr double kNoAngle = 1e-12;  // rad
  if (si_unit == "rad" && std::fabs(value) < kNoAngle) value = 0;
  const DisplayUnit shown = display_unit(si_unit, variable);
  return with_unit(digits_text(value * shown.factor, 4), shown.unit);
}

std::string chosen_text(double value, std::string_view si_unit) {
  if (std::isinf(value)) return "none";
  const auto in = [&](const DisplayUnit& unit) { return with_unit(few_digits(value * unit.factor), unit.unit); };
  std::string shortest = in(display_unit(si_unit));
  const bool is_zero = !(std::fabs(value) > 0);  // short in every unit
  const auto offer = [&](std::string text) {
    if (!is_zero && text.size() < shortest.size()) shortest = std::move(text);
  };
  offer(in({1, si_unit}));
  for (const auto& [unit, of_data] : kUnitsOfData) {
    if (unit == si_unit) offer(in(of_data));
  }
  return shortest;
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string duration_text(double seconds) {
  if (!(std::fabs(seconds) > 0)) return "0";
  if (std::fabs(seconds) < 1e-3) return fmt::format("{:.3g} us", seconds * 1e6);
  if (std::fabs(seconds) < 1) return fmt::format("{:.3g} ms", seconds * 1e3);
  return fmt::format("{:.4g} s", seconds);
}

std::string duration_below(double seconds) {
  const double digit = std::pow(10, std::floor(std::log10(seconds)) - 1);
  return duration_text(std::floor(seconds / digit * (1 + 1e-12)) * digit);
}

double rounded_down(double x, int digits) {
  const double digit = std::pow(10, std::floor(std::log10(x)) - (digits - 1));
  constexpr double kRounding = 1 + 1e-12;  // of a bound that has so few digits already
  return std::floor(x / digit * kRounding) * digit;
}

}  // namespace slew
