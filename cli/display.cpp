#include "cli/display.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "core/report_table.h"

namespace slew::cli {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

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

// further units in which people choose values
constexpr std::pair<std::string_view, DisplayUnit> kUnitsOfData[] = {
    {"m", {1e3, "mm"}},     {"m2", {1e4, "cm2"}},
    {"m3", {1e6, "cm3"}},   {"rad/s", {30 / std::numbers::pi, "rpm"}},
    {"m2/s", {1e6, "cSt"}}, {"m3/rad", {2e6 * std::numbers::pi, "cm3/rev"}}};

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

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text + ' ' + std::string(unit);
}

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

DisplayUnit display_unit(std::string_view si_unit) {
  for (const auto& [unit, shown] : kUnits) {
    if (unit == si_unit) return shown;
  }
  return {1, si_unit};
}

std::string quantity_text(double si_value, std::string_view si_unit) {
  const DisplayUnit shown = display_unit(si_unit);
  std::string text = fmt::format("{:.4g}", si_value * shown.factor);
  if (text == "-0") text = "0";
  return with_unit(std::move(text), shown.unit);
}

std::string chosen_text(double si_value, std::string_view si_unit) {
  if (std::isinf(si_value)) return "none";
  const auto in = [&](const DisplayUnit& unit) { return with_unit(few_digits(si_value * unit.factor), unit.unit); };
  std::string shortest = in(display_unit(si_unit));
  const bool is_zero = !(std::fabs(si_value) > 0);  // short in every unit
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

std::size_t output_width() {
  winsize size{};
  const bool is_terminal = isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  return is_terminal ? size.ws_col : 0;
}

void print_table(const ReportTable& table) {
  fmt::print("{}", table.text("", output_width()));
}

std::string table_text(const std::vector<std::vector<std::string>>& rows, std::string_view indent) {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], characters(row[i]));
  }
  std::string text;
  for (const std::vector<std::string>& row : rows) {
    text += indent;
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += row[i];
      if (i + 1 < row.size()) text.append(widths[i] - characters(row[i]) + 2, ' ');
    }
    text += '\n';
  }
  return text;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    const bool is_quoted = cells[i].find_first_of(",\"\r\n") != std::string::npos;
    if (!is_quoted) {
      line += cells[i];
      continue;
    }
    line += '"';
    for (const char c : cells[i]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\r\n";
}

}  // namespace slew::cli
