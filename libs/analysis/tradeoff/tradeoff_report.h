// SPDX-License-Identifier: Apache-2.0
// Reports of a tradeoff as text, JSON, CSV and an interactive page.
#pragma once

#include <optional>
#include <string>

#include "analysis/tradeoff/answer.h"
#include "analysis/tradeoff/tradeoff.h"

namespace slew::analysis {

struct Answer {
  Question question;
  std::optional<std::size_t> row;  // none: no stable row meets it
  std::string overlay;             // file; empty: the unchanged scene meets it best, or no row does
};

// The runs and the reference, then the table; the answer last. width [characters] of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const Tradeoff& tradeoff, const std::optional<Answer>& answer,
                                      std::size_t width = 0);
[[nodiscard]] std::string report_json(const Tradeoff& tradeoff, const std::optional<Answer>& answer);
// Comma-separated values (RFC 4180), SI units in the heading; a missing value is empty.
[[nodiscard]] std::string report_csv(const Tradeoff& tradeoff);
// Self-contained: error over cost, the Pareto front, settings on hover, the scene as it is marked; the table below. The
// data are in the page as the value of report_json().
[[nodiscard]] std::string report_html(const Tradeoff& tradeoff, const std::optional<Answer>& answer);

// One line: the request and the settings that meet it.
[[nodiscard]] std::string answer_text(const Tradeoff& tradeoff, const Answer& answer);

}  // namespace slew::analysis
