// SPDX-License-Identifier: Apache-2.0
// Error against cost of one scene's manoeuvre over many settings, each in a process of its own, against the monolithic
// solution of the whole scene.
//
// Errors are relative to the range of the variable in the reference; the components x, y, z of a vector share the
// largest of their three ranges. A row is stable when it ends, stays finite and its distance from the reference never
// exceeds that range.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/sweep/sweep.h"
#include "analysis/tradeoff/grid.h"
#include "analysis/tradeoff/row.h"
#include "core/dimension.h"

namespace slew::analysis {

struct TradeoffOptions {
  scene::SceneOptions scene;           // duration: run time; empty: the scene's
  std::vector<std::string> axes;       // texts; empty: those of the scene
  std::vector<std::string> variables;  // patterns; empty: forces of the actuators and the position of the payload
  std::vector<std::string> errors;     // bounds of the answer, parse_error(): refused before anything runs
  GridSize size = GridSize::modest;
  std::string folder;  // folder of the results; empty: runs/tradeoff-SCENE
  int workers = 2;
  int repeats = 3;
  bool is_fresh = false;
};

struct TradeoffVariable {
  std::string name, unit;  // SI
  Dimension dimension = Dimension::none;
  double range = 0;              // the errors are relative to it
  double size = 0;               // its largest value in the reference
  std::optional<double> spread;  // largest difference of the reference to itself at ten times its tolerance
  // It moves no more than a hundred times that difference, or 1e-8 of its size or of 1: an error relative to the range
  // would be noise.
  bool is_at_rest = false;

  // A relative error exists.
  [[nodiscard]] bool is_compared() const noexcept { return range > 0 && !is_at_rest; }
};

struct TradeoffRow {
  Settings settings;
  bool is_done = false;  // false: the sweep ended before
  RowResult result;
  bool parts_from_reference = false;
  bool is_pareto = false;

  [[nodiscard]] bool has_run() const noexcept { return is_done && result.refusal.empty(); }
  [[nodiscard]] bool is_stable() const noexcept { return has_run() && result.failure.empty() && !parts_from_reference; }
};

struct Tradeoff {
  std::string scene, file;
  double until = 0;       // s
  std::string reference;  // description of the reference for the user
  std::string folder;
  std::vector<Axis> axes;
  std::vector<TradeoffVariable> variables;
  std::vector<TradeoffRow> rows;  // the first: the unchanged scene
  std::size_t kept = 0;           // rows of an earlier sweep

  [[nodiscard]] std::size_t done() const noexcept;
  [[nodiscard]] bool is_complete() const noexcept { return done() == rows.size(); }
};

// Receives the running tasks and the share of all work that is done; false ends the sweep with the finished rows.
using TradeoffProgress = std::function<bool(std::string_view doing, double share)>;

// Throws LoadError for a wrong scene, Failure for options that cannot be met.
[[nodiscard]] Tradeoff trade_off(const TradeoffOptions& options, const TradeoffProgress& progress);

// Largest or root-mean-square error of a variable relative to its range; none: it has no range, is at rest,
// or the row lacks it.
enum class ErrorKind { largest, rms };
[[nodiscard]] std::optional<double> relative_error(const Tradeoff& tradeoff, const TradeoffRow& row,
                                                   std::size_t variable, ErrorKind kind = ErrorKind::largest);
// The worst of all variables; infinite when the row has none of them.
[[nodiscard]] double worst_error(const Tradeoff& tradeoff, const TradeoffRow& row, ErrorKind kind = ErrorKind::largest);

// Marks the variables that are at rest, by range and spread; components of a vector together.
void mark_at_rest(std::vector<TradeoffVariable>& variables);

// "yes", or the reason for no.
[[nodiscard]] std::string verdict(const TradeoffRow& row);

}  // namespace slew::analysis
