// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>

#include "analysis/coupling_lamp.h"
#include "analysis/tradeoff/answer.h"
#include "core/failure.h"
#include "mechanics_node/payload.h"
#include "multibody/model/model.h"
#include "node/identity.h"
#include "scene/name_pattern.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

// own error of the reference, as a share of the range, above which the variable is at rest
constexpr double kMostOwnError = 0.01;
constexpr double kRounded = 1e-8;

constexpr double kReferenceTolerance = 1e-9, kLooserTolerance = 1e-8;
constexpr double kReferenceLimit = 600;       // s of wall time
constexpr double kRowLimit = 60;              // s
constexpr std::int64_t kReferenceParts = 16;  // parts of a communication step, where the monolith cannot run
constexpr double kReferenceWeight = 2;        // in rows

std::string exact(double value) {
  return fmt::format("{:.17g}", value);
}

// "Bag.position" of "Bag.position.y"
std::string_view stem_of(std::string_view name) {
  for (const std::string_view end : {".x", ".y", ".z"}) {
    if (name.ends_with(end)) return name.substr(0, name.size() - end.size());
  }
  return name;
}

class Trader {
 public:
  Trader(const TradeoffOptions& options, const TradeoffProgress& progress) : options_(options), progress_(progress) {
    scene_options_ = options.scene;
    scene_options_.overrides.emplace_back("session.solution=split");
    // the error of a setting beyond its limit is to be measured
    scene_options_.overrides.emplace_back("session.coupling_alarm=warn");
    scene_options_.is_recording = false;
    base_ = scene::load_scene(scene_options_);
    if (!(base_.session.duration > 0)) {
      throw Failure(ExitCode::bad_input,
                    "the scene runs until it is stopped; nothing was run; set --until to the time to run");
    }
    result_.scene = base_.name;
    result_.file = options.scene.file;
    result_.until = base_.session.duration;
    result_.folder = options.folder.empty() ? "runs/tradeoff-" + base_.name : options.folder;
    choose_axes();
    choose_variables();
    for (const std::string& text : options.errors) static_cast<void>(parse_error(text, result_));
    plan_rows();
  }

  Tradeoff run() {
    if (run_references()) run_rows();
    mark_pareto(result_);
    return std::move(result_);
  }

 private:
  struct Planned {
    double H = 0;
    std::string text;     // canonical text of the row's scene
    bool is_run = false;  // it was not refused
  };
  struct Reference {
    scene::Overrides overrides;  // replace the row's
    std::string samples;         // file
    RowResult result;
    bool is_done = false;
  };

  void choose_axes() {
    for (const std::string& text : options_.axes) result_.axes.push_back(parse_axis(text));
    if (result_.axes.empty()) result_.axes = default_axes(base_);
  }

  // names of the bodies that are lifted; without mechanics none
  [[nodiscard]] std::vector<std::string> payload_names() const {
    if (!base_.has_mechanics()) return {};
    const multibody::Model model = multibody::build_model(base_.mechanics);
    const int payload = mechanics_node::payload_of(base_.mechanics, model);
    std::vector<std::string> names = base_.other_payloads;
    names.insert(names.begin(), payload > 0 ? model.bodies[static_cast<std::size_t>(payload)].name
                                            : base_.mechanics.bodies.back().name);
    return names;
  }

  void choose_variables() {
    const std::vector<ElementVariable> variables = session::DirectSession(base_).variables();
    std::vector<std::string> names;
    for (const ElementVariable& variable : variables) names.push_back(variable.name);
    std::vector<std::string> patterns = options_.variables;
    if (patterns.empty()) {
      for (const scene::PortDef& port : base_.ports) {
        patterns.push_back(port.name + (port.unit == coupling::PortUnit::metre ? ".force" : ".torque"));
      }
      for (const std::string& lifted : payload_names()) patterns.push_back(lifted + ".position.?");
      if (patterns.empty()) patterns.emplace_back("*.pressure");
    }
    // the name of a vector stands for its parts
    for (std::string& pattern : patterns) {
      const bool is_vector = std::find(names.begin(), names.end(), pattern + ".x") != names.end();
      if (is_vector) pattern += ".?";
    }
    for (const std::string& name : scene::choose(patterns, names)) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      result_.variables.push_back({.name = name,
                                   .unit = std::string(info(variables[at].dimension).si_unit),
                                   .dimension = variables[at].dimension,
                                   .spread = {}});
      names_.push_back(name);
    }
  }

  [[nodiscard]] scene::SceneOptions options_with(const scene::Overrides& overrides) const {
    scene::SceneOptions row_options = scene_options_;
    row_options.overrides.insert(row_options.overrides.end(), overrides.begin(), overrides.end());
    return row_options;
  }

  // Rows with the same scene are one; a value that is refused alone is not tried with others.
  void plan_rows() {
    const std::vector<Settings> grid =
        options_.axes.empty() ? default_grid(result_.axes, options_.size) : product_grid(result_.axes);
    std::set<std::string> seen;
    std::set<std::pair<std::string, std::string>> refused;
    for (const Settings& settings : grid) {
      const bool is_hopeless =
          settings.size() > 1 &&
          std::any_of(settings.begin(), settings.end(), [&](const auto& one) { return refused.contains(one); });
      if (is_hopeless) continue;
      Planned planned;
      TradeoffRow row{.settings = settings, .result = {}};
      try {
        const scene::Scene scene = scene::load_scene(options_with(overrides_of(settings)));
        planned = {scene.session.step, result_text(scene), true};
        if (!seen.insert(planned.text).second) continue;
      } catch (const scene::LoadError& error) {
        row.is_done = true;
        row.result.refusal = error.first_reason();
        if (settings.size() == 1) refused.insert(settings.front());
      }
      planned_.push_back(std::move(planned));
      result_.rows.push_back(std::move(row));
    }
  }

  // ---- tasks --------------------------------------------------------------------------------------------------

  [[nodiscard]] RowJob job_for(const scene::Overrides& overrides, double H) const {
    RowJob job;
    job.scene = options_with(overrides);
    job.variables = names_;
    job.row_step = H;
    job.repeats = options_.repeats;
    job.time_limit = kRowLimit;
    return job;
  }

  // writes the job beside its result
  [[nodiscard]] SweepTask task_of(RowJob& job, const std::string& label, double weight, const std::string& scene_text) {
    std::string names;
    for (const std::string& name : names_) names += name + ' ';
    const std::vector<std::string> texts = {scene_text,           names,
                                            exact(job.row_step),  std::to_string(job.repeats),
                                            scene_options_.input, node::build_id(),
                                            job.samples,          job.kind == RunKind::reference ? "reference" : "row"};
    SweepTask task{.key = key_of(texts), .label = label, .arguments = {}, .weight = weight};
    const std::string base = (std::filesystem::path(result_.folder) / task.key).string();
    if (job.kind == RunKind::reference) job.samples = base + ".samples";
    std::error_code error;
    std::filesystem::create_directories(result_.folder, error);
    std::ofstream file(base + ".job", std::ios::binary);
    file << to_json(job).dump();
    if (!file.flush()) {
      throw Failure(ExitCode::storage,
                    "cannot write into " + result_.folder + "; nothing was run; name another folder with --folder");
    }
    task.arguments = {"tradeoff-row", base + ".job"};
    return task;
  }

  [[nodiscard]] SweepOptions sweep_options() const {
    SweepOptions sweep;
    sweep.folder = result_.folder;
    sweep.workers = options_.workers;
    sweep.is_fresh = options_.is_fresh;
    return sweep;
  }

  // share of the whole: references and rows by their weights
  [[nodiscard]] SweepProgress part(double from, double to) const {
    return [this, from, to](const SweepState& state) {
      const std::string doing = fmt::format("{}/{}  {}", state.done, state.all, state.doing);
      return progress_(doing, from + (to - from) * state.share);
    };
  }

  // ---- references ---------------------------------------------------------------------------------------------

  [[nodiscard]] static scene::Overrides monolithic(double H, double rtol) {
    return {"session.step=" + exact(H), "session.solution=monolithic", "session.rtol=" + exact(rtol),
            "session.flexible=once"};
  }

  // the split scene in short steps; whole nanoseconds, not below the smallest step of a scene
  [[nodiscard]] static scene::Overrides finely_split(const scene::Scene& scene, double H) {
    const std::int64_t ns = duration_of_seconds(H).ns;
    std::int64_t parts = kReferenceParts;
    while (parts > 1 &&
           (ns % parts != 0 || static_cast<double>(ns) * 1e-9 / static_cast<double>(parts) < scene::kMinStep)) {
      --parts;
    }
    const double h = static_cast<double>(ns / parts) * 1e-9;
    scene::Overrides overrides = {"session.step=" + exact(h)};
    if (scene.has_mechanics()) overrides.push_back("mechanics.max_substep=" + exact(h));
    if (scene.has_hydraulics()) overrides.emplace_back("hydraulics.relative_tolerance=1e-7");
    return overrides;
  }

  bool run_reference_sweep(const std::vector<double>& steps, double from, double to,
                           const std::function<scene::Overrides(double)>& overrides) {
    std::vector<SweepTask> tasks;
    for (const double H : steps) {
      Reference& reference = references_[H];
      reference = {};
      reference.overrides = overrides(H);
      RowJob job = job_for(reference.overrides, H);
      job.kind = RunKind::reference;
      job.time_limit = kReferenceLimit;
      const scene::Scene scene = scene::load_scene(job.scene);
      tasks.push_back(
          task_of(job, fmt::format("reference, step {} ms", H * 1e3), kReferenceWeight, result_text(scene)));
      reference.samples = job.samples;
    }
    const std::vector<SweepResult> results = run_sweep(tasks, sweep_options(), part(from, to));
    for (std::size_t i = 0; i < steps.size(); ++i) {
      Reference& reference = references_[steps[i]];
      reference.is_done = results[i].is_done;
      if (!results[i].is_done) return false;
      if (results[i].failure.empty()) {
        reference.result = result_from(results[i].value);
      } else {
        reference.result.failure = results[i].failure;
      }
    }
    return true;
  }

  // Communication steps of the rows, as far as the scene allows them; rows with another one cannot be compared.
  [[nodiscard]] std::vector<double> steps_with_reference() {
    std::map<double, std::string> refusals;  // empty: none
    std::vector<double> steps;
    for (std::size_t i = 0; i < planned_.size(); ++i) {
      if (!planned_[i].is_run) continue;
      const double H = planned_[i].H;
      const auto [known, is_new] = refusals.try_emplace(H);
      if (is_new) {
        try {
          static_cast<void>(scene::load_scene(options_with(monolithic(H, kReferenceTolerance))));
          steps.push_back(H);
        } catch (const scene::LoadError& error) {
          known->second = error.first_reason();
        }
      }
      if (known->second.empty()) continue;
      planned_[i].is_run = false;
      result_.rows[i].is_done = true;
      result_.rows[i].result.refusal = "there is no reference in this step: " + known->second;
    }
    return steps;
  }

  bool run_references() {
    const std::vector<double> steps = steps_with_reference();
    if (steps.empty()) {
      throw Failure(ExitCode::bad_input, "no row of this scene can run: " + result_.rows.front().result.refusal);
    }
    const double share = kReferenceWeight * static_cast<double>(steps.size()) /
                         (kReferenceWeight * static_cast<double>(steps.size()) + static_cast<double>(planned_.size()));
    rows_from_ = share;
    if (!run_reference_sweep(steps, 0, share, [](double H) { return monolithic(H, kReferenceTolerance); }))
      return false;
    const auto failed = [&] {
      std::string text;
      for (const double H : steps) {
        const RowResult& of = references_[H].result;
        if (text.empty()) text = of.refusal.empty() ? of.failure : of.refusal;
      }
      return text;
    };
    result_.reference = fmt::format("all physics as one system (CVODE, rtol {:g}), input held over the row's step",
                                    kReferenceTolerance);
    if (const std::string why = failed(); !why.empty()) {
      if (!run_reference_sweep(steps, 0, share, [this](double H) { return finely_split(base_, H); })) return false;
      if (const std::string again = failed(); !again.empty()) {
        throw Failure(ExitCode::diverged, "there is no reference: as one system: " + why + "; split in short steps: " +
                                              again + "; nothing can be compared; try an earlier --until");
      }
      result_.reference =
          fmt::format("the scene in {} parts of each row's step with tight tolerances, since as one system: {}",
                      kReferenceParts, why);
      is_split_reference_ = true;
    }
    find_ranges();
    return true;
  }

  void find_ranges() {
    const Reference& of_base =
        references_.at(planned_.front().is_run ? planned_.front().H : references_.begin()->first);
    std::map<std::string_view, double> by_stem;
    for (std::size_t v = 0; v < names_.size(); ++v) {
      const double range = of_base.result.high[v] - of_base.result.low[v];
      double& of_stem = by_stem[stem_of(names_[v])];
      if (std::isfinite(range)) of_stem = std::max(of_stem, range);
    }
    for (std::size_t v = 0; v < names_.size(); ++v) {
      result_.variables[v].range = by_stem[stem_of(names_[v])];
      result_.variables[v].size = std::max(std::fabs(of_base.result.low[v]), std::fabs(of_base.result.high[v]));
    }
  }

  // ---- rows ---------------------------------------------------------------------------------------------------

  void run_rows() {
    std::vector<SweepTask> tasks;
    std::vector<std::size_t> row_of;
    for (std::size_t i = 0; i < planned_.size(); ++i) {
      if (!planned_[i].is_run) continue;
      RowJob job = job_for(overrides_of(result_.rows[i].settings), planned_[i].H);
      job.samples = references_.at(planned_[i].H).samples;
      tasks.push_back(task_of(job, text_of(result_.rows[i].settings), 1, planned_[i].text));
      row_of.push_back(i);
    }
    if (!is_split_reference_ && planned_.front().is_run) {
      // own error of the reference
      const double H = planned_.front().H;
      RowJob job = job_for(monolithic(H, kLooserTolerance), H);
      job.samples = references_.at(H).samples;
      job.repeats = 1;
      job.time_limit = kReferenceLimit;
      const scene::Scene scene = scene::load_scene(job.scene);
      tasks.push_back(task_of(job, "error of the reference", kReferenceWeight, result_text(scene)));
    }
    const std::vector<SweepResult> results = run_sweep(tasks, sweep_options(), part(rows_from_, 1));
    if (results.size() > row_of.size() && results.back().is_done && results.back().failure.empty()) {
      const RowResult own = result_from(results.back().value);
      for (std::size_t v = 0; v < own.errors.size(); ++v) {
        if (own.errors[v]) result_.variables[v].spread = own.errors[v]->largest;
      }
      mark_at_rest(result_.variables);
    }
    for (std::size_t k = 0; k < row_of.size(); ++k) take(results[k], result_.rows[row_of[k]]);
  }

  void take(const SweepResult& from, TradeoffRow& row) {
    row.is_done = from.is_done;
    if (!from.is_done) return;
    if (from.was_kept) ++result_.kept;
    if (!from.failure.empty()) {
      row.result.failure = from.failure;
      return;
    }
    row.result = result_from(from.value);
    for (std::size_t v = 0; v < row.result.errors.size(); ++v) {
      const double range = result_.variables[v].range;
      row.parts_from_reference =
          row.parts_from_reference ||
          (result_.variables[v].is_compared() && row.result.errors[v] && row.result.errors[v]->largest > range);
    }
  }

  const TradeoffOptions& options_;
  const TradeoffProgress& progress_;
  scene::SceneOptions scene_options_;
  scene::Scene base_;
  std::vector<std::string> names_;
  std::vector<Planned> planned_;            // beside result_.rows
  std::map<double, Reference> references_;  // by communication step
  bool is_split_reference_ = false;
  double rows_from_ = 0;
  Tradeoff result_;
};

}  // namespace

std::size_t Tradeoff::done() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const TradeoffRow& row) { return row.is_done; }));
}

Tradeoff trade_off(const TradeoffOptions& options, const TradeoffProgress& progress) {
  return Trader(options, progress).run();
}

std::optional<double> relative_error(const Tradeoff& tradeoff, const TradeoffRow& row, std::size_t variable,
                                     ErrorKind kind) {
  if (variable >= row.result.errors.size() || !row.result.errors[variable]) return std::nullopt;
  const double range = tradeoff.variables[variable].range;
  if (!tradeoff.variables[variable].is_compared()) return std::nullopt;
  const VariableError& error = *row.result.errors[variable];
  return (kind == ErrorKind::largest ? error.largest : error.rms) / range;
}

double worst_error(const Tradeoff& tradeoff, const TradeoffRow& row, ErrorKind kind) {
  double worst = -1;
  for (std::size_t v = 0; v < tradeoff.variables.size(); ++v) {
    if (const std::optional<double> error = relative_error(tradeoff, row, v, kind)) worst = std::max(worst, *error);
  }
  return worst < 0 ? std::numeric_limits<double>::infinity() : worst;
}

void mark_at_rest(std::vector<TradeoffVariable>& variables) {
  std::map<std::string_view, double> spreads, sizes;
  for (const TradeoffVariable& variable : variables) {
    double& of_stem = spreads[stem_of(variable.name)];
    of_stem = std::max(of_stem, variable.spread.value_or(0));
    sizes[stem_of(variable.name)] = std::max(sizes[stem_of(variable.name)], variable.size);
  }
  for (TradeoffVariable& variable : variables) {
    const std::string_view stem = stem_of(variable.name);
    variable.is_at_rest =
        spreads[stem] > kMostOwnError * variable.range || variable.range < kRounded * std::max(1.0, sizes[stem]);
  }
}

std::string verdict(const TradeoffRow& row) {
  if (!row.is_done) return "not run";
  if (!row.result.refusal.empty()) return "refused: " + row.result.refusal;
  if (!row.result.failure.empty()) return fmt::format("no: {} at {:.4g} s", row.result.failure, row.result.failed_at);
  if (row.parts_from_reference) return "no: error exceeds the reference's own range";
  if (row.result.eta && lamp_of(*row.result.eta) == coupling::Lamp::red) return "yes, but the coupling's lamp is red";
  return "yes";
}

}  // namespace slew::analysis
