// SPDX-License-Identifier: Apache-2.0
// `slewring sweep SCENE --vary PATH=RANGE --measure 'max(VARIABLE)' -o DIR`: measures of many runs of a scene with
// varied values, each run a process of its own (sweep/sweep.h).
//
// The folder holds sweep.json with the scene and the options, and rows/NUMBER.json with the result of each row. A row
// with a result is not run again; a folder of another scene or other options is refused. A result depends on scene,
// settings and program alone, not on the number of workers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/parameter_sweep/row_run.h"
#include "analysis/parameter_sweep/statistics.h"
#include "analysis/parameter_sweep/variation.h"
#include "analysis/sweep/sweep.h"
#include "core/json.h"

namespace slew::analysis {

struct ParameterSweepOptions {
  SweepJob job;
  std::vector<std::string> variations;  // "Bag.mass=200kg..1500kg:50"
  Sampling sampling = Sampling::grid;
  std::size_t samples = 0;  // rows of random and lhs
  std::uint64_t seed = 1;
  SweepOptions engine;  // folder: that of the sweep. is_fresh discards the rows of an earlier sweep
};

struct SweptMeasure {
  std::string text, unit;  // SI unit; empty: a number
  std::string variable{};  // as in Measure
};

struct SweptRow {
  Settings settings;
  bool is_done = false;
  RowOutcome outcome{};
  bool is_foreign = false;  // of another build or processor family than this program

  [[nodiscard]] bool has_failed() const noexcept { return is_done && outcome.code != ExitCode::ok; }
};

struct ParameterSweep {
  std::string scene, file;
  double until = 0;  // s
  Sampling sampling = Sampling::grid;
  std::uint64_t seed = 0;
  std::string folder;
  std::vector<Variation> variations;
  std::vector<SweptMeasure> measures;
  std::vector<SweptRow> rows;
  std::size_t kept = 0;  // rows of an earlier sweep

  // Simulated time of each row, for a heading.
  [[nodiscard]] std::string duration_text() const;
  [[nodiscard]] std::size_t done() const noexcept;
  [[nodiscard]] std::size_t failed() const noexcept;
  [[nodiscard]] std::size_t foreign() const noexcept;
};

// Receives the present activity and the share of all work that is done; false ends it.
using ParameterSweepProgress = std::function<bool(std::string_view doing, double share)>;

// Throws LoadError for a wrong scene, Failure for options that cannot be met, both before any row has run: a refused
// end of a range or value of a list, an unknown name or unit of a measure, a folder of another sweep.
[[nodiscard]] ParameterSweep run_parameter_sweep(const ParameterSweepOptions& options,
                                                 const ParameterSweepProgress& progress);

// Over the rows with a value.
[[nodiscard]] SampleStatistics statistics_of(const ParameterSweep& sweep, std::size_t measure);
// None: also for values that are words.
[[nodiscard]] std::optional<Correlation> correlation_of(const ParameterSweep& sweep, std::size_t measure,
                                                        std::size_t variation);

[[nodiscard]] std::string_view to_text(Sampling sampling) noexcept;

// ---- reports. width [characters]: of the lines of a table; 0: no limit
[[nodiscard]] std::string report_text(const ParameterSweep& sweep, std::size_t width = 0);
[[nodiscard]] std::string report_csv(const ParameterSweep& sweep);
[[nodiscard]] Json report_json(const ParameterSweep& sweep);
// One page without other files: parallel coordinates, scatter and table.
[[nodiscard]] std::string report_html(const ParameterSweep& sweep);

}  // namespace slew::analysis
