#include "cli_support/number_range.h"

#include <fmt/format.h>

namespace slew::cli_support {

CLI::Validator number_range(double least, double most) {
  const std::string range = fmt::format("from {:.12g} to {:.12g}", least, most);
  const auto problem = [least, most, range](const std::string& text) {
    double number = 0;
    // nan is in no order: only what is inside is let through
    const bool is_inside = CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
    return is_inside ? std::string() : fmt::format("'{}' is no number {}", text, range);
  };
  return {problem, range, "number range"};
}

}  // namespace slew::cli_support
