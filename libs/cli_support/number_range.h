// The check of every option that is a number with a fraction.
#pragma once

#include <CLI/CLI.hpp>

namespace slew::cli_support {

// Finite numbers from `least` to `most`. CLI::Range is no check of these: it lets nan through.
[[nodiscard]] CLI::Validator number_range(double least, double most);

}  // namespace slew::cli_support
