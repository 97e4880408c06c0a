// How quantities and tables are shown to people: the units of the workshop, as many digits as can be read, lines that
// fit the terminal.
#pragma once

#include <cstddef>
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

// Pa -> bar, m3/s -> l/min, rad -> deg, ...; units that are not in the list stay as they are.
[[nodiscard]] DisplayUnit display_unit(std::string_view si_unit);

// "47.2 kN" style: value in the display unit with four significant digits.
[[nodiscard]] std::string quantity_text(double value, std::string_view si_unit);

// A value that somebody has chosen, as a person would write it: at most six digits, in the unit of those usual that
// makes it shortest: "30 deg", "1500 rpm", "0.1 l/min", "500 kg". Reading it back gives the value to 1e-9 where six
// digits can; what is not given, and a bound that is not there, is "none".
[[nodiscard]] std::string chosen_text(double value, std::string_view si_unit);

// "1 body", "2 bodies".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view one, std::string_view many);

// "1.9 us", "12 ms", "3.2 s".
[[nodiscard]] std::string duration_text(double seconds);
// Rounded down to two digits.
[[nodiscard]] std::string duration_below(double seconds);

// Characters of a line where standard output is a terminal; 0 elsewhere: a line may have any length.
[[nodiscard]] std::size_t output_width();

// To standard output, in lines that fit the terminal.
void print_table(const ReportTable& table);

}  // namespace slew
