// SPDX-License-Identifier: Apache-2.0
// Reports of a stress test as text, JSON and a page.
#pragma once

#include <string>

#include "analysis/stress/stress.h"

namespace slew::analysis {

// The machine, the table with two rows a cell, the books, the verdict. width [characters]: of the lines of a table; 0:
// no limit.
[[nodiscard]] std::string report_text(const Stress& stress, std::size_t width = 0);

[[nodiscard]] std::string report_json(const Stress& stress);

// The largest response of every 0.1 s of each cell over its time, as plot_html() draws curves.
[[nodiscard]] std::string report_html(const Stress& stress);

}  // namespace slew::analysis
