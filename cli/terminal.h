// SPDX-License-Identifier: Apache-2.0
// Standard output as a terminal shows it.
#pragma once

#include <cstddef>

#include "core/report_table.h"

namespace slew::cli {

// Line length in characters if standard output is a terminal; otherwise 0: no limit.
[[nodiscard]] std::size_t output_width();

// Standard output is a terminal with colours, and NO_COLOR (no-color.org) is not set or empty.
[[nodiscard]] bool uses_colours();

// Prints to standard output, in lines that fit the terminal.
void print_table(const ReportTable& table);

}  // namespace slew::cli
