// SPDX-License-Identifier: Apache-2.0
// The choice of a row: the Pareto front of cost and error, and the best row within a budget or an error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/tradeoff/tradeoff.h"

namespace slew::analysis {

// Stable rows that no other stable row beats: none has a lower median cost and at most their worst error, or a lower
// error and at most their cost.
void mark_pareto(Tradeoff& tradeoff);

// Indices of the points that no other point beats; of equal ones the first. cost and error: of one length; points that
// are not finite are never in it.
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error);

// Error that a variable may have: absolute in SI, or a share of its range.
struct ErrorBound {
  std::string text;                    // the user's text
  std::vector<std::size_t> variables;  // indices in the tradeoff
  double bound = 0;
  bool is_relative = false;
};

// The user's limits: a largest cost, largest errors, or both.
struct Question {
  std::optional<double> budget;  // us per simulated ms
  std::vector<ErrorBound> errors;
  [[nodiscard]] bool has_limits() const noexcept { return budget || !errors.empty(); }
};

// "20 us/ms", or a bare number of them. Throws Failure (bad_input).
[[nodiscard]] double parse_budget(const std::string& text);
// "Cyl_Lift.force 1%", "Bag.position 1 mm". Throws Failure (bad_input), also where the tradeoff has no such variable.
[[nodiscard]] ErrorBound parse_error(const std::string& text, const Tradeoff& tradeoff);

// The row that meets the limits: without errors the one with the least worst error within the budget, else the cheapest
// one. None: no stable row does.
[[nodiscard]] std::optional<std::size_t> best_row(const Tradeoff& tradeoff, const Question& question);

}  // namespace slew::analysis
