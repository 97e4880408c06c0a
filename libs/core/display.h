// SPDX-License-Identifier: Apache-2.0
// Display of quantities and tables to users: workshop units, readable digits, lines that fit the terminal.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace slew {
class ReportTable;
}

namespace slew {

struct DisplayUnit {
  double factor = 1;  // shown value = SI value * factor
  std::string_view unit;
};

// Pa -> bar, m3/s -> l/min, rad -> deg, ...; units that are not in the list stay as they are. variable: full name of
// the shown variable, where there is one: `El.speed` and `El.speed_setting` in rad/s are those of a shaft and are shown
// in rpm; rates of joints and bodies (`velocity`, `rate`, `angular_velocity`) in deg/s.
[[nodiscard]] DisplayUnit display_unit(std::string_view si_unit, std::string_view variable = {});

// A number with so many significant digits ("{:.4g}"), or so many decimals ("{:.2f}"). A zero has no sign: -0 is "0",
// -0.001 to two decimals "0.00".
[[nodiscard]] std::string digits_text(double value, int digits);
[[nodiscard]] std::string decimals_text(double value, int decimals);

// "47.2 kN" style: value in the display unit with four significant digits. An angle below 1e-12 rad is 0.
[[nodiscard]] std::string quantity_text(double value, std::string_view si_unit, std::string_view variable = {});

// A chosen value as a user would write it: at most six digits, in the usual unit that gives the shortest text: "30
// deg", "1500 rpm", "0.1 l/min", "500 kg". Parsing the text gives the value to 1e-9 where six digits suffice. A missing
// value or bound is "none".
[[nodiscard]] std::string chosen_text(double value, std::string_view si_unit);

// "1 body", "2 bodies".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view one, std::string_view many);

// "1.9 us", "12 ms", "3.2 s".
[[nodiscard]] std::string duration_text(double seconds);
// Rounded down to two digits.
[[nodiscard]] std::string duration_below(double seconds);

// A bound that a message names as "at most": x > 0 to so many digits, not above x but for rounding.
[[nodiscard]] double rounded_down(double x, int digits = 3);

}  // namespace slew
