// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "scene/names.h"
#include "scene/units.h"

namespace slew::analysis {
namespace {

bool meets(const Tradeoff& tradeoff, const TradeoffRow& row, const ErrorBound& bound) {
  return std::all_of(bound.variables.begin(), bound.variables.end(), [&](std::size_t v) {
    if (v >= row.result.errors.size() || !row.result.errors[v]) return false;
    const double range = tradeoff.variables[v].range;
    if (bound.is_relative && tradeoff.variables[v].is_at_rest) return true;
    const double allowed = bound.is_relative ? bound.bound * range : bound.bound;
    return row.result.errors[v]->largest <= allowed;
  });
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::optional<double> number_of(const std::string& text) {
  try {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    if (used != text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (std::isfinite(cost[i]) && std::isfinite(error[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] != cost[b] ? cost[a] < cost[b] : error[a] < error[b];
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (!(error[i] < least)) continue;
    least = error[i];
    front.push_back(i);
  }
  return front;
}

void mark_pareto(Tradeoff& tradeoff) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<double> cost, error;
  for (TradeoffRow& row : tradeoff.rows) {
    row.is_pareto = false;
    cost.push_back(row.is_stable() ? row.result.cost.median : kNever);
    error.push_back(row.is_stable() ? worst_error(tradeoff, row) : kNever);
  }
  for (const std::size_t i : pareto_front(cost, error)) tradeoff.rows[i].is_pareto = true;
}

double parse_budget(const std::string& text) {
  std::string number = trimmed(text);
  constexpr std::string_view kUnit = "us/ms";
  if (number.ends_with(kUnit)) number = trimmed(number.substr(0, number.size() - kUnit.size()));
  const std::optional<double> value = number_of(number);
  if (!value || !(*value > 0)) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--budget '{}': is no cost; nothing was run; expected microseconds per simulated "
                              "millisecond, such as '20 us/ms'",
                              text));
  }
  return *value;
}

ErrorBound parse_error(const std::string& text, const Tradeoff& tradeoff) {
  const std::string whole = trimmed(text);
  const std::size_t space = whole.find(' ');
  const auto refuse = [&](const std::string& what) -> Failure {
    return {ExitCode::bad_input,
            fmt::format("--error '{}': {}; nothing was run; expected a variable of the table and a quantity or a "
                        "share of its range, such as 'Cyl_Lift.force 1%'",
                        text, what)};
  };
  if (space == std::string::npos) throw refuse("it has no bound");
  const std::string name = whole.substr(0, space);
  std::string quantity = trimmed(whole.substr(space));
  ErrorBound bound{.text = whole, .variables = {}};
  for (std::size_t v = 0; v < tradeoff.variables.size(); ++v) {
    const std::string& candidate = tradeoff.variables[v].name;
    if (scene::fits_pattern(candidate, name) || scene::fits_pattern(candidate, name + ".?"))
      bound.variables.push_back(v);
  }
  if (bound.variables.empty()) {
    std::string names;
    for (const TradeoffVariable& one : tradeoff.variables) names += (names.empty() ? "" : ", ") + one.name;
    throw refuse("there is no '" + name + "' in the table (" + names + "); name it with --variables");
  }
  if (quantity.ends_with('%')) {
    const std::optional<double> share = number_of(trimmed(quantity.substr(0, quantity.size() - 1)));
    if (!share) throw refuse("'" + quantity + "' is no share");
    bound.is_relative = true;
    bound.bound = *share / 100;
  } else {
    scene::UnitSystem units;
    const Dimension dimension = tradeoff.variables[bound.variables.front()].dimension;
    const scene::QuantityResult read = scene::read_quantity(quantity, scene::Writing::plain, dimension, units);
    if (!read.value)
      throw Failure(ExitCode::bad_input, fmt::format("--error '{}': {}; nothing was run", text, read.problem.text()));
    bound.bound = *read.value;
  }
  if (!(bound.bound > 0)) throw refuse("the bound is not positive");
  return bound;
}

std::optional<std::size_t> best_row(const Tradeoff& tradeoff, const Question& question) {
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tradeoff.rows.size(); ++i) {
    const TradeoffRow& row = tradeoff.rows[i];
    if (!row.is_stable() || (question.budget && row.result.cost.median > *question.budget)) continue;
    if (!std::all_of(question.errors.begin(), question.errors.end(),
                     [&](const ErrorBound& bound) { return meets(tradeoff, row, bound); })) {
      continue;
    }
    const double value = question.errors.empty() ? worst_error(tradeoff, row) : row.result.cost.median;
    if (!(value < least)) continue;
    least = value;
    best = i;
  }
  return best;
}

}  // namespace slew::analysis
