// SPDX-License-Identifier: Apache-2.0
#include "analysis/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "analysis/fit/measured_data.h"
#include "analysis/fit/signal_run.h"
#include "analysis/fit/standard_errors.h"
#include "analysis/parameter_sweep/measure.h"
#include "analysis/parameter_sweep/variable_values.h"
#include "analysis/parameter_sweep/variation.h"
#include "analysis/sweep/result_folder.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "node/identity.h"
#include "scene/expression.h"
#include "scene/parameters.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

using Points = std::vector<std::vector<double>>;

constexpr double kInner = 0.38196601;  // part of a range where no whole number or short decimal is met by chance
constexpr double kRounding = 1e-12;    // SI, and relative: below it a signal differs from the measured one by rounding
constexpr double kAtBound = 1e-6;      // distance from a bound, as a part of the range
// the same bound as kMostCorrelation, for the variance inflation 1 / (1 - R^2)
constexpr double kMostInflation = 1 / (1 - kMostCorrelation * kMostCorrelation);
// a value is part of a combination if it has at least this part of the first one's effect on the signals
constexpr double kLeastPart = 0.1;
constexpr double kShownChange = 0.01;  // relative change of the first value of a combination

[[noreturn]] void refuse_fit(const std::string& what) {
  throw Failure(ExitCode::bad_input, what);
}

// A free value and its range in SI.
struct FreeValue {
  Variation variation;
  double low = 0, high = 0;
  [[nodiscard]] double in_unit(double u) const { return *number_of(variation, variation.value_at(u)); }
};

class Fitter {
 public:
  Fitter(const FitOptions& options, const FitProgress& progress) : options_(options), progress_(progress) {
    job_.scene = options.scene;
    base_ = scene::load_scene(options.scene);
    fit_.scene = base_.name;
    fit_.folder = options.engine.folder;
    read_signals();
    read_free_values();
    rows_folder_ = (std::filesystem::path(fit_.folder) / "rows").string();
    job_text_ = to_json(job_).dump();
    folder_.emplace(fit_.folder, FolderUse{.task = "fit",
                                           .manifest = manifest(),
                                           .members = {{"scene", "the scene has changed"},
                                                       {"data", "the measured data differ"},
                                                       {"map", "--map differs"},
                                                       {"free", "--free differs"}},
                                           .is_fresh = options.engine.is_fresh});
    write_text(job_file(), job_text_);
  }

  Fit run() {
    const std::vector<SignalOutcome> before = run_points(Points(1, start_));
    if (before.empty()) return interrupted();
    if (before.front().code != ExitCode::ok) {
      throw Failure(before.front().code, "the scene fails at its own values: " + before.front().message +
                                             "; nothing was fitted; change them by --set");
    }
    split(before.front().values, &FittedSignal::before);
    // a signal that hardly changes does not outweigh the others by an offset that no value can mend
    for (FittedSignal& signal : fit_.signals) {
      const double scale = std::max(statistics_of(signal.measured).deviation, signal.rms(signal.before));
      double largest = 1;
      for (const double value : signal.measured) largest = std::max(largest, std::fabs(value));
      if (scale > kRounding * largest) signal.scale = scale;
    }
    fit_.search = minimise_squares(start_, before.front().values.size(), options_.most_iterations,
                                   [this](std::span<const std::vector<double>> points) { return residuals(points); });
    if (fit_.search.was_ended) return interrupted();
    const std::vector<SignalOutcome> after = run_points(Points(1, fit_.search.u));
    if (after.empty()) return interrupted();
    split(after.front().values, &FittedSignal::after);
    judge();
    return std::move(fit_);
  }

 private:
  Fit interrupted() {
    fit_.search.was_ended = true;
    return std::move(fit_);
  }

  [[nodiscard]] std::string job_file() const { return (std::filesystem::path(rows_folder_) / "job.json").string(); }

  // What the fit depends on, beside the number of iterations: more of them continue the search.
  [[nodiscard]] Json manifest() const {
    std::vector<std::string> scene_texts = {result_text(base_)};
    for (const scene::ParameterText& parameter : base_.parameter_texts) {
      scene_texts.push_back(parameter.name);
      scene_texts.push_back(parameter.value);
    }
    std::vector<std::string> data;
    for (const FittedSignal& signal : fit_.signals)
      data.push_back(Json(signal.time).dump() + Json(signal.measured).dump());
    return {{"scene", key_of(scene_texts)}, {"data", key_of(data)}, {"map", options_.maps}, {"free", options_.free}};
  }

  // ---- options ------------------------------------------------------------------------------------------------

  void read_signals() {
    std::vector<std::string> columns;
    for (const std::string& map : options_.maps) {
      const std::size_t equals = map.find('=');
      if (equals == std::string::npos || equals == 0 || equals + 1 == map.size()) {
        refuse_fit("--map " + map + ": is no COLUMN=EXPRESSION, such as 'p_A=Vol_LiftCyl_A.pressure'; nothing was run");
      }
      columns.push_back(map.substr(0, equals));
      job_.expressions.push_back(map.substr(equals + 1));
    }
    refuse_doubled(columns);
    const std::vector<MeasuredSignal> measured = read_measured(options_.data, columns);
    const std::vector<ElementVariable> variables = variables_of_run(base_, session::DirectSession(base_));
    double end = 0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const scene::CompiledExpression expression = compile_of_run("--map", job_.expressions[i], base_, variables);
      if (measured[i].has_unit && measured[i].exponent != expression.exponent()) {
        refuse_fit(
            fmt::format("--map {}: the column is {}, the expression {}; nothing was run; give the column its "
                        "unit, as in 'p_A [bar]'",
                        options_.maps[i], scene::name_of(measured[i].exponent), scene::name_of(expression.exponent())));
      }
      fit_.signals.push_back({.column = columns[i],
                              .expression = job_.expressions[i],
                              .unit = scene::si_unit_of(expression.exponent()),
                              .time = measured[i].time,
                              .measured = measured[i].value,
                              .before = {},
                              .after = {}});
      job_.times.push_back(measured[i].time);
      end = std::max(end, measured[i].time.back());
    }
    // rules of the scene about its duration hold for the data's
    if (base_.session.duration > 0 && end > base_.session.duration) job_.scene.duration = fmt::format("{} s", end);
  }

  // a signal that counts twice would narrow the intervals as further measurements do
  void refuse_doubled(const std::vector<std::string>& columns) const {
    const auto without_spaces = [](std::string text) {
      std::erase(text, ' ');
      return text;
    };
    for (std::size_t i = 0; i < columns.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (columns[i] == columns[j]) {
          refuse_fit(
              fmt::format("--map: the column '{}' is given twice ('{}' and '{}') and would count twice; nothing "
                          "was run; give it once",
                          columns[i], options_.maps[j], options_.maps[i]));
        }
        if (without_spaces(job_.expressions[i]) == without_spaces(job_.expressions[j])) {
          refuse_fit(
              fmt::format("--map: '{}' is given twice ('{}' and '{}') and would count twice; nothing was run; "
                          "give one column for it: of two sensors their mean",
                          job_.expressions[i], options_.maps[j], options_.maps[i]));
        }
      }
    }
  }

  void read_free_values() {
    scene::UnitSystem units;
    for (const std::string& text : options_.free) {
      if (text.find(':') != std::string::npos) {
        refuse_fit("--free " + text + ": a range has no count here; nothing was run; write PATH=LOW..HIGH");
      }
      FreeValue value{.variation = parse_variation(text, Sampling::random, "--free")};
      for (const FreeValue& other : free_) {
        if (other.variation.path == value.variation.path) {
          refuse_fit("--free " + value.variation.path + " is given twice; nothing was run; give it once");
        }
      }
      if (!value.variation.range) {
        refuse_fit("--free " + text + ": is no range; nothing was run; write PATH=LOW..HIGH");
      }
      const auto in_si = [&](double u) { return scene::quantity_of(value.variation.value_at(u), units); };
      const scene::NamedQuantity low = in_si(0), high = in_si(1);
      if (!low.quantity || !high.quantity)
        refuse_fit("--free " + text + ": " + low.problem->what + "; nothing was run");
      value.low = low.quantity->value;
      value.high = high.quantity->value;
      for (const double u : {0.0, 1.0, kInner})
        check_value(text, value.variation.path + "=" + value.variation.value_at(u));
      start_.push_back(start_of(text, value, units));
      free_.push_back(std::move(value));
    }
  }

  void check_value(const std::string& text, const std::string& setting) const {
    scene::SceneOptions options = options_.scene;
    options.overrides.push_back(setting);
    try {
      static_cast<void>(scene::load_scene(options));
    } catch (const scene::LoadError& error) {
      refuse_fit(fmt::format("--free {}: the scene refuses the value '{}': {}; nothing was run", text, setting,
                             error.diagnostics().front().text()));
    }
  }

  // The scene's own value as a part of the range.
  [[nodiscard]] double start_of(const std::string& text, const FreeValue& value, scene::UnitSystem& units) const {
    std::optional<double> own;
    for (const scene::ParameterText& parameter : base_.parameter_texts) {
      if (parameter.name != value.variation.path) continue;
      const scene::NamedQuantity quantity = scene::quantity_of(parameter.value, units);
      if (quantity.quantity) own = quantity.quantity->value;
    }
    for (const scene::ParameterInfo& parameter : scene::parameters(base_)) {
      if (parameter.path == value.variation.path && !parameter.is_choice()) own = parameter.value;
    }
    if (!own)
      refuse_fit("--free " + text + ": the scene has no number there to begin with; nothing was run; set it by --set");
    const double u = (*own - value.low) / (value.high - value.low);
    if (u < 0 || u > 1) {
      refuse_fit(
          fmt::format("--free {}: the scene's own value {} (SI) lies outside of the range; nothing was run; widen "
                      "the range, or begin elsewhere by --set",
                      text, *own));
    }
    return u;
  }

  // ---- runs ---------------------------------------------------------------------------------------------------

  // Outcomes of the points; empty: interrupted.
  std::vector<SignalOutcome> run_points(std::span<const std::vector<double>> points) {
    std::vector<SweepTask> tasks;
    for (const std::vector<double>& u : points) {
      std::vector<std::string> texts = {result_text(base_), job_text_, node::build_id()};
      SweepTask task{.key = "", .label = "", .arguments = {"fit-row", job_file()}};
      for (std::size_t k = 0; k < u.size(); ++k) {
        const std::string setting = free_[k].variation.path + "=" + free_[k].variation.value_at(u[k]);
        texts.push_back(setting);
        task.label += (k > 0 ? ", " : "") + setting;
        task.arguments.insert(task.arguments.end(), {"--set", setting});
      }
      task.key = key_of(texts);
      tasks.push_back(std::move(task));
    }
    SweepOptions engine = options_.engine;
    engine.folder = rows_folder_;
    engine.is_fresh = false;
    const std::vector<SweepResult> results = run_sweep(tasks, engine, [this](const SweepState& state) {
      return progress_(fmt::format("run {}  {}", fit_.runs + state.done, state.doing), kUnknownShare);
    });
    std::vector<SignalOutcome> outcomes;
    for (const SweepResult& result : results) {
      if (!result.is_done) return {};
      ++fit_.runs;
      outcomes.push_back(result.failure.empty() ? signal_outcome_from(result.value)
                                                : SignalOutcome{.code = ExitCode::failed, .message = result.failure});
    }
    return outcomes;
  }

  std::vector<std::optional<std::vector<double>>> residuals(std::span<const std::vector<double>> points) {
    std::vector<std::optional<std::vector<double>>> all;
    for (SignalOutcome& outcome : run_points(points)) {
      all.emplace_back();
      if (outcome.code != ExitCode::ok) continue;
      std::size_t at = 0;
      for (const FittedSignal& signal : fit_.signals) {
        for (const double measured : signal.measured) {
          outcome.values[at] = (outcome.values[at] - measured) / signal.scale;
          ++at;
        }
      }
      all.back() = std::move(outcome.values);
    }
    return all;
  }

  void split(const std::vector<double>& values, std::vector<double> FittedSignal::*into) {
    auto at = values.begin();
    for (FittedSignal& signal : fit_.signals) {
      const auto end = at + static_cast<std::ptrdiff_t>(signal.measured.size());
      (signal.*into).assign(at, end);
      at = end;
    }
  }

  // ---- result -------------------------------------------------------------------------------------------------

  void judge() {
    const std::size_t n = free_.size();
    const LeastSquares& search = fit_.search;
    StandardErrors errors;
    if (!search.normal_inverse.empty()) {
      std::vector<std::size_t> samples;
      for (const FittedSignal& signal : fit_.signals) samples.push_back(signal.measured.size());
      errors = standard_errors(search.normal_inverse, search.jacobian, search.residuals, samples);
    }
    for (std::size_t k = 0; k < n; ++k) {
      const FreeValue& free = free_[k];
      const double u = search.u[k];
      FittedValue value{.path = free.variation.path,
                        .unit = free.variation.unit,
                        .low = free.in_unit(0),
                        .high = free.in_unit(1),
                        .before = free.in_unit(start_[k]),
                        .after = free.in_unit(u)};
      value.is_at_bound = u < kAtBound || u > 1 - kAtBound;
      value.setting = value.path + "=" + free.variation.value_at(u);
      if (!errors.covariance.empty() && is_separated(k)) {
        const double range = std::fabs(value.high - value.low);
        const double half = student_quantile(errors.freedom[k]) * std::sqrt(errors.covariance[k * n + k]) * range;
        value.interval = Interval{value.after - half, value.after + half};
        value.is_beyond_range = 2 * half > range;
      }
      fit_.values.push_back(std::move(value));
    }
    find_undetermined();
    // those of N where J leaves a direction open or the residuals have no errors
    const bool has_errors = fit_.undetermined.empty() && has_variances(errors.covariance, n);
    const std::vector<double>& C = has_errors ? errors.covariance : search.normal_inverse;
    for (std::size_t i = 0; i < n && !C.empty(); ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        fit_.correlations.push_back(C[i * n + j] / std::sqrt(C[i * n + i] * C[j * n + j]));
      }
    }
  }

  [[nodiscard]] static bool has_variances(const std::vector<double>& C, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k) {
      if (C.empty() || !(C[k * n + k] > 0)) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_separated(std::size_t k) const {
    return fit_.search.effects[k] > 0 && fit_.search.inflations[k] <= kMostInflation;
  }

  void find_undetermined() {
    const std::size_t n = free_.size();
    const LeastSquares& search = fit_.search;
    std::vector<bool> is_open(n, !search.normal_inverse.empty());
    while (true) {
      // the least separated value, and those that make up for its change
      std::size_t first = n;
      for (std::size_t k = 0; k < n; ++k) {
        if (is_open[k] && !is_separated(k) && (first == n || search.inflations[k] > search.inflations[first]))
          first = k;
      }
      if (first == n) return;
      fit_.undetermined.push_back(combination_of(first));
      for (const Undetermined::Part& part : fit_.undetermined.back().parts) is_open[part.value] = false;
    }
  }

  // The change of the others for a change of value `first` that changes the signals least: N_j,first / N_first,first.
  [[nodiscard]] Undetermined combination_of(std::size_t first) const {
    const std::size_t n = free_.size();
    const LeastSquares& search = fit_.search;
    const auto range = [this](std::size_t k) { return fit_.values[k].high - fit_.values[k].low; };
    const double own = fit_.values[first].after;
    const double du = own != 0 ? kShownChange * std::fabs(own / range(first)) : kShownChange;
    Undetermined all;
    // a value without any effect is undetermined alone
    const std::size_t others = search.effects[first] > 0 ? n : 1;
    for (std::size_t step = 0; step < others; ++step) {
      const std::size_t k = (first + step) % n;
      const double share = search.normal_inverse[k * n + first] / search.normal_inverse[first * n + first];
      if (std::fabs(share) * search.effects[k] < kLeastPart * search.effects[first]) continue;
      const double change = share * du * range(k), after = fit_.values[k].after;
      all.parts.push_back({k, after != 0 ? change / std::fabs(after) : change, after != 0});
    }
    return all;
  }

  const FitOptions& options_;
  const FitProgress& progress_;
  scene::Scene base_;
  std::optional<ResultFolder> folder_;
  SignalJob job_;
  std::string job_text_, rows_folder_;
  std::vector<FreeValue> free_;
  std::vector<double> start_;  // by free value, 0 to 1
  Fit fit_;
};

}  // namespace

double FittedSignal::rms(const std::vector<double>& simulated) const {
  double squares = 0;
  for (std::size_t i = 0; i < simulated.size(); ++i) squares += std::pow(simulated[i] - measured[i], 2);
  return simulated.empty() ? 0 : std::sqrt(squares / static_cast<double>(simulated.size()));
}

Fit fit_scene(const FitOptions& options, const FitProgress& progress) {
  return Fitter(options, progress).run();
}

}  // namespace slew::analysis
