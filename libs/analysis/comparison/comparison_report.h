// SPDX-License-Identifier: Apache-2.0
// Reports of a comparison as text, JSON, CSV and a picture of error over cost.
#pragma once

#include <string>
#include <vector>

#include "analysis/comparison/comparison.h"

namespace slew::analysis {

// The runs and the reference, then the table; a line at the end for each remark. width [characters] of the lines of a
// table; 0: no limit.
[[nodiscard]] std::string report_text(const Comparison& comparison, std::size_t width = 0);

[[nodiscard]] std::string report_json(const Comparison& comparison);

// Comma-separated values (RFC 4180): one line for every row, SI units in the heading; a missing value is empty.
[[nodiscard]] std::string report_csv(const Comparison& comparison);

// Error of the first class of variables over the mechanics' cost, one mark for each row that ran and is stable, one
// line for each formulation and integrator. Self-contained SVG, or a page with the picture and the table below.
[[nodiscard]] std::string report_svg(const Comparison& comparison);
[[nodiscard]] std::string report_html(const Comparison& comparison);

}  // namespace slew::analysis
