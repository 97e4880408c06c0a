// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/parameter_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "analysis/parameter_sweep/measure.h"
#include "analysis/parameter_sweep/variable_values.h"
#include "analysis/sweep/result_folder.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

constexpr std::string_view kSamplingNames[] = {"grid", "random", "lhs"};

class ParameterSweeper {
 public:
  explicit ParameterSweeper(const ParameterSweepOptions& options)
      : options_(options), base_(scene::load_scene(options.job.scene)) {
    if (!(base_.session.duration > 0)) {
      throw Failure(ExitCode::bad_input,
                    "the scene runs until it is stopped; nothing was run; set --until to the time to run");
    }
    result_.scene = base_.name;
    result_.file = options.job.scene.file;
    result_.until = base_.session.duration;
    result_.sampling = options.sampling;
    result_.seed = options.seed;
    result_.folder = options.engine.folder;
    read_variations();
    read_measures();
    for (Settings& settings : sweep_rows(result_.variations, options.sampling, options.samples, options.seed)) {
      result_.rows.push_back({.settings = std::move(settings)});
    }
  }

  ParameterSweep run(const ParameterSweepProgress& progress) {
    prepare_folder();
    SweepOptions engine = options_.engine;
    engine.folder = rows_folder().string();
    engine.is_fresh = false;  // the rows of an earlier sweep are removed
    const auto report = [&progress](const SweepState& state) {
      return progress(fmt::format("{}/{}  {}", state.done, state.all, state.doing), state.share);
    };
    const std::vector<SweepResult> results = run_sweep(tasks(), engine, report);
    const Fingerprint own = own_fingerprint();
    for (std::size_t i = 0; i < results.size(); ++i) take(results[i], own, result_.rows[i]);
    return std::move(result_);
  }

 private:
  // ---- options ------------------------------------------------------------------------------------------------

  void read_variations() {
    for (const std::string& text : options_.variations) {
      Variation variation = parse_variation(text, options_.sampling);
      for (const Variation& other : result_.variations) {
        if (other.path == variation.path) {
          throw Failure(ExitCode::bad_input,
                        "--vary " + variation.path + " is given twice; nothing was run; give it once");
        }
      }
      if (variation.path == "session.duration" && !options_.job.scene.duration.empty()) {
        throw Failure(ExitCode::bad_input,
                      "--vary session.duration and --until both set the duration; nothing was run; give one of them");
      }
      check_values(text, variation);
      result_.variations.push_back(std::move(variation));
    }
  }

  // the ends of a range, or all values of a list, each alone: ranges of a scene's fields are intervals
  void check_values(const std::string& text, const Variation& variation) const {
    const std::vector<std::string> values =
        variation.range ? std::vector{variation.value_at(0), variation.value_at(1)} : variation.list;
    for (const std::string& value : values) {
      scene::SceneOptions options = options_.job.scene;
      options.overrides.push_back(variation.path + "=" + value);
      try {
        static_cast<void>(scene::load_scene(options));
      } catch (const scene::LoadError& error) {
        throw Failure(ExitCode::bad_input,
                      fmt::format("--vary {}: the scene refuses the value '{}': {}; nothing was run; change the range, "
                                  "or the scene's other values by --set",
                                  text, value, error.diagnostics().front().text()));
      }
    }
  }

  void read_measures() {
    const std::vector<ElementVariable> variables = variables_of_run(base_, session::DirectSession(base_));
    for (const std::string& text : options_.job.measures) {
      const Measure measure = parse_measure(text, base_, variables);
      result_.measures.push_back({measure.text, measure.unit, measure.variable});
    }
  }

  // ---- folder -------------------------------------------------------------------------------------------------

  [[nodiscard]] std::filesystem::path rows_folder() const {
    return std::filesystem::path(options_.engine.folder) / "rows";
  }
  [[nodiscard]] std::string job_file() const { return (rows_folder() / "job.json").string(); }

  // Everything that rows depend on, except the program: rows of another one are marked.
  [[nodiscard]] Json manifest() const {
    std::vector<std::string> scene_texts = {result_text(base_)};
    for (const scene::ParameterText& parameter : base_.parameter_texts) {
      scene_texts.push_back(parameter.name);
      scene_texts.push_back(parameter.value);
    }
    const bool is_grid = options_.sampling == Sampling::grid;
    return {{"scene", key_of(scene_texts)},
            {"vary", options_.variations},
            {"measure", options_.job.measures},
            {"sample", to_text(options_.sampling)},
            {"samples", is_grid ? Json() : Json(options_.samples)},
            {"seed", is_grid ? Json() : Json(options_.seed)}};
  }

  void prepare_folder() {
    folder_.emplace(options_.engine.folder, FolderUse{.task = "sweep",
                                                      .manifest = manifest(),
                                                      .members = {{"scene", "the scene has changed"},
                                                                  {"vary", "--vary differs"},
                                                                  {"measure", "--measure differs"},
                                                                  {"sample", "--sample differs"},
                                                                  {"samples", "--samples differs"},
                                                                  {"seed", "--seed differs"}},
                                                      .is_fresh = options_.engine.is_fresh});
    write_text(job_file(), to_json(options_.job).dump());
  }

  // ---- rows ---------------------------------------------------------------------------------------------------

  [[nodiscard]] std::vector<SweepTask> tasks() const {
    std::vector<SweepTask> tasks;
    for (const SweptRow& row : result_.rows) {
      SweepTask task{.key = fmt::format("{:06}", tasks.size()), .label = text_of(row.settings), .arguments = {}};
      task.arguments = {"sweep-row", job_file()};
      for (const std::string& one : overrides_of(row.settings)) {
        task.arguments.insert(task.arguments.end(), {"--set", one});
      }
      tasks.push_back(std::move(task));
    }
    return tasks;
  }

  void take(const SweepResult& from, const Fingerprint& own, SweptRow& row) {
    row.is_done = from.is_done;
    if (!from.is_done) return;
    if (from.was_kept) ++result_.kept;
    if (!from.failure.empty()) {
      row.outcome = {.code = ExitCode::failed, .message = from.failure, .fingerprint = own};
      return;
    }
    row.outcome = row_outcome_from(from.value);
    row.is_foreign = row.outcome.fingerprint != own;
  }

  const ParameterSweepOptions& options_;
  scene::Scene base_;
  std::optional<ResultFolder> folder_;  // locked until the rows are written
  ParameterSweep result_;
};

template <typename Is>
std::size_t count_rows(const std::vector<SweptRow>& rows, Is&& is) {
  return static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), is));
}

// Value of a measure; none in a row that failed.
std::optional<double> value_of(const SweptRow& row, std::size_t measure) {
  const bool has_value = row.is_done && measure < row.outcome.values.size();
  return has_value ? row.outcome.values[measure] : std::nullopt;
}

}  // namespace

std::string ParameterSweep::duration_text() const {
  for (const Variation& variation : variations) {
    if (variation.path == "session.duration") return "the varied duration";
  }
  return fmt::format("{} s", until);
}

std::size_t ParameterSweep::done() const noexcept {
  return count_rows(rows, [](const SweptRow& row) { return row.is_done; });
}
std::size_t ParameterSweep::failed() const noexcept {
  return count_rows(rows, [](const SweptRow& row) { return row.has_failed(); });
}
std::size_t ParameterSweep::foreign() const noexcept {
  return count_rows(rows, [](const SweptRow& row) { return row.is_foreign; });
}

ParameterSweep run_parameter_sweep(const ParameterSweepOptions& options, const ParameterSweepProgress& progress) {
  return ParameterSweeper(options).run(progress);
}

SampleStatistics statistics_of(const ParameterSweep& sweep, std::size_t measure) {
  std::vector<double> values;
  for (const SweptRow& row : sweep.rows) {
    if (const std::optional<double> value = value_of(row, measure)) values.push_back(*value);
  }
  return statistics_of(std::span<const double>(values));
}

std::optional<Correlation> correlation_of(const ParameterSweep& sweep, std::size_t measure, std::size_t variation) {
  std::vector<double> x, y;
  for (const SweptRow& row : sweep.rows) {
    const std::optional<double> varied = number_of(sweep.variations[variation], row.settings[variation].second),
                                value = value_of(row, measure);
    if (!varied) return std::nullopt;
    if (!value) continue;
    x.push_back(*varied);
    y.push_back(*value);
  }
  return correlation_of(std::span<const double>(x), std::span<const double>(y));
}

std::string_view to_text(Sampling sampling) noexcept {
  return kSamplingNames[static_cast<std::size_t>(sampling)];
}

}  // namespace slew::analysis
