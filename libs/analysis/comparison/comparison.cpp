// SPDX-License-Identifier: Apache-2.0
#include "analysis/comparison/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "scene/name_pattern.h"
#include "session/direct_session.h"
#include "transport/roles.h"

namespace slew::analysis {
namespace {

using wire::Role;

// origins and centres of mass of all bodies: "Bag.position.y", not a joint's "Hinge.position"
constexpr const char* kDefaultVariables[] = {"*.position.?", "*.center_of_mass.?"};
constexpr std::int64_t kMostSamples = 20'000;
// relative energy drift of a reference below which the scene counts as conservative
constexpr double kEnergyIsKept = 1e-6;
// cost of the observed run with its readings, in timed runs
constexpr double kObservedRun = 2;

// The whole of the work in sub-steps, for the progress.
class Work {
 public:
  explicit Work(const Progress& progress) : progress_(progress) {}
  void expect(double amount) { all_ += amount; }
  // The callback of a part, which returns whether to go on.
  [[nodiscard]] GoesOn part(std::string doing, double amount) {
    return [this, doing = std::move(doing), amount](double share) {
      return progress_(doing, std::min(1.0, (done_ + share * amount) / all_));
    };
  }
  void finish(double amount) { done_ += amount; }

 private:
  const Progress& progress_;
  double all_ = 0, done_ = 0;
};

class Comparer {
 public:
  Comparer(const ComparisonOptions& options, const Progress& progress)
      : options_(options), work_(progress), base_(scene::load_scene(options.scene)) {
    if (!base_.has_mechanics()) {
      throw Failure(ExitCode::bad_input, "the scene has no bodies; there are no formulations to compare");
    }
    if (base_.session.solution == scene::Solution::monolithic) {
      throw Failure(ExitCode::bad_input,
                    "session.solution monolithic has no formulations to compare; nothing was run; set it to split");
    }
    if (!(base_.session.duration > 0)) {
      throw Failure(ExitCode::bad_input,
                    "the scene runs until it is stopped; nothing was run; set --until to the time to compare");
    }
    until_ = duration_of_seconds(base_.session.duration);
    const SimDuration H = base_.session.step_duration();
    sample_.ns = H.ns * std::max<std::int64_t>(1, until_.ns / H.ns / kMostSamples);
    find_rows();
    choose_variables();
  }

  Comparison compare() {
    result_.scene = base_.name;
    result_.until = until_.seconds();
    result_.communication_step = base_.session.step;
    result_.has_hydraulics = base_.has_hydraulics();
    result_.repeats = options_.repeats;
    result_.wanted_rows = planned_.size();
    expect_work();
    if (!run_reference()) return std::move(result_);
    for (Planned& planned : planned_) {
      if (!run_row(planned)) break;
    }
    return std::move(result_);
  }

 private:
  struct Planned {
    ComparedRow row;
    std::optional<scene::Scene> scene;
  };

  // a refusal that does not depend on the step is reported once
  void find_rows() {
    for (const Configuration& configuration : configurations(options_, base_)) {
      Configured configured = load(options_, base_, configuration);
      Planned planned{{.configuration = configuration, .refusal = configured.refusal}, std::move(configured.scene)};
      smallest_step_ = std::min(smallest_step_, configuration.step);
      if (!planned.row.refusal.empty() && !planned_.empty()) {
        ComparedRow& last = planned_.back().row;
        const bool is_same = last.configuration.formulation == configuration.formulation &&
                             last.configuration.integrator == configuration.integrator &&
                             last.refusal == planned.row.refusal;
        if (is_same) {
          last.configuration.step = 0;
          continue;
        }
      }
      planned_.push_back(std::move(planned));
    }
    if (std::none_of(planned_.begin(), planned_.end(), [](const Planned& p) { return p.row.has_run(); })) {
      std::string text = "the scene runs in none of the wanted configurations; nothing was run";
      for (const Planned& planned : planned_) {
        text += fmt::format("\n  {}: {}", planned.row.configuration.formulation, planned.row.refusal);
      }
      throw Failure(ExitCode::bad_input, text);
    }
  }

  void choose_variables() {
    const session::DirectSession session(base_);
    std::vector<std::string> names;
    std::vector<std::string> units;
    for (const Role role : transport::physics_roles()) {
      if (session.subsystem(role) == nullptr) continue;
      for (const ElementVariable& variable : session.subsystem(role)->variables()) {
        names.push_back(variable.name);
        units.emplace_back(info(variable.dimension).si_unit);
      }
    }
    const std::vector<std::string> bodies(std::begin(kDefaultVariables), std::end(kDefaultVariables));
    result_.variables = scene::choose(options_.variables.empty() ? bodies : options_.variables, names);
    for (std::size_t column = 0; column < result_.variables.size(); ++column) {
      const auto at = std::find(names.begin(), names.end(), result_.variables[column]) - names.begin();
      const std::string& unit = units[static_cast<std::size_t>(at)];
      auto of_unit = std::find_if(result_.classes.begin(), result_.classes.end(),
                                  [&](const VariableClass& one) { return one.unit == unit; });
      if (of_unit == result_.classes.end()) of_unit = result_.classes.insert(of_unit, {.unit = unit});
      of_unit->columns.push_back(column);
    }
  }

  [[nodiscard]] double substeps(double step) const { return until_.seconds() / std::min(step, base_.session.step); }

  void expect_work() {
    reference_step_ = reference_step(options_, base_, smallest_step_);
    work_.expect(substeps(reference_step_) * 1.5);
    for (const Planned& planned : planned_) {
      if (planned.row.has_run()) {
        work_.expect(substeps(planned.row.configuration.step) * (kObservedRun + options_.repeats));
      }
    }
  }

  // ---- the reference ------------------------------------------------------------------------------------------

  // the default formulation where the scene allows it, else the first that runs
  void choose_reference() {
    Configuration wanted = default_configuration(reference_step_);
    if (!load(options_, base_, wanted).scene) {
      const auto runs =
          std::find_if(planned_.begin(), planned_.end(), [](const Planned& p) { return p.row.has_run(); });
      wanted.formulation = runs->row.configuration.formulation;
      wanted.integrator = runs->row.configuration.integrator;
    }
    result_.reference = wanted;
  }

  [[nodiscard]] Observation observe_reference(double step, const char* doing, double work) {
    Configuration configuration = result_.reference;
    configuration.step = step;
    const Configured configured = load(options_, base_, configuration);
    if (!configured.scene) throw Failure(ExitCode::bad_input, "the reference cannot run: " + configured.refusal);
    Observation run = observe_run(*configured.scene, result_.variables, until_, sample_, work_.part(doing, work));
    work_.finish(work);
    if (!run.failure.empty()) {
      throw Failure(ExitCode::diverged,
                    fmt::format("the reference ({}, sub-steps of {}) fails at {:.6g} s: {}; nothing can "
                                "be compared; try another --reference or an earlier --until",
                                configuration.formulation, step_text(step), run.failed_at, run.failure));
    }
    return run;
  }

  bool run_reference() {
    choose_reference();
    const double work = substeps(reference_step_);
    reference_ = observe_reference(reference_step_, "reference", work);
    if (reference_.is_interrupted) return false;
    const Observation coarser = observe_reference(2 * reference_step_, "error of the reference", 0.5 * work);
    if (coarser.is_interrupted) return false;
    for (VariableClass& one : result_.classes) {
      const Difference error = difference(coarser, reference_, one);
      one.reference_error = error.largest;
      one.reference_rms = error.rms;
      for (const std::size_t column : one.columns) one.extent = std::max(one.extent, extent_of(column));
    }
    result_.largest_kinetic_energy = reference_.largest_kinetic_energy;
    result_.reference_energy_drift = drift_from_start(reference_);
    const bool is_kept = !base_.has_hydraulics() && result_.reference_energy_drift < kEnergyIsKept;
    result_.energy_rule = is_kept ? EnergyRule::kept : EnergyRule::compared;
    return true;
  }

  [[nodiscard]] double extent_of(std::size_t column) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < reference_.samples(); ++i) {
      const double value = reference_.values[i * reference_.variables + column];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    return high - low;
  }

  // ---- a row --------------------------------------------------------------------------------------------------

  bool run_row(Planned& planned) {
    ComparedRow& row = planned.row;
    if (row.has_run()) {
      const Configuration& c = row.configuration;
      const std::string doing = fmt::format("{}, {}, {}", c.formulation, c.integrator, step_text(c.step));
      const double work = substeps(c.step);
      const Observation run =
          observe_run(*planned.scene, result_.variables, until_, sample_, work_.part(doing, kObservedRun * work));
      work_.finish(kObservedRun * work);
      if (run.is_interrupted) return false;
      judge(run, planned.scene->mechanics, row);
      row.cost = time_runs(*planned.scene, run.steps, options_.repeats, run.state_hashes,
                           work_.part(doing + ", timed", work * options_.repeats));
      work_.finish(work * options_.repeats);
      if (row.cost.is_interrupted) return false;
    }
    result_.rows.push_back(row);
    return true;
  }

  void judge(const Observation& run, const multibody::MechanicsDef& mechanics, ComparedRow& row) const {
    row.failure = run.failure;
    row.failed_at = run.failed_at;
    row.gap = run.gap;
    if (run.gap.joint >= 0) row.open_joint = mechanics.joints[static_cast<std::size_t>(run.gap.joint)].name;
    row.iterations = static_cast<double>(run.iterations) / static_cast<double>(std::max<StepIndex>(1, run.steps));
    row.not_converged = run.not_converged;
    row.state_hashes = run.state_hashes;
    for (const VariableClass& one : result_.classes) row.differences.push_back(difference(run, reference_, one));
    if (reference_.largest_kinetic_energy > 0) {
      row.energy_drift = result_.energy_rule == EnergyRule::kept ? drift_from_start(run) : drift_from_reference(run);
    }
    row.parted_at = parted_at(run);
  }

  [[nodiscard]] double relative(double energy) const { return energy / reference_.largest_kinetic_energy; }

  [[nodiscard]] double drift_from_start(const Observation& run) const {
    double largest = 0;
    for (const double energy : run.energy) largest = std::max(largest, std::fabs(energy - run.energy[0]));
    return reference_.largest_kinetic_energy > 0 ? relative(largest) : 0;
  }

  [[nodiscard]] double drift_from_reference(const Observation& run) const {
    double largest = 0;
    for (std::size_t i = 0; i < run.samples(); ++i) {
      largest = std::max(largest, std::fabs(run.energy[i] - reference_.energy[i]));
    }
    return relative(largest);
  }

  // time from which the motion is farther from the reference than the reference's own range: the two are unrelated then
  [[nodiscard]] std::optional<double> parted_at(const Observation& run) const {
    for (std::size_t i = 0; i < run.samples(); ++i) {
      for (const VariableClass& one : result_.classes) {
        for (const std::size_t column : one.columns) {
          const double error =
              std::fabs(run.values[i * run.variables + column] - reference_.values[i * run.variables + column]);
          if (one.extent > 0 && error > one.extent) return static_cast<double>(i) * run.sample.seconds();
        }
      }
    }
    return std::nullopt;
  }

  const ComparisonOptions& options_;
  Work work_;
  scene::Scene base_;
  SimDuration until_, sample_;
  double smallest_step_ = std::numeric_limits<double>::infinity();
  double reference_step_ = 0;
  std::vector<Planned> planned_;
  Observation reference_;
  Comparison result_;
};

}  // namespace

Difference difference(const Observation& run, const Observation& reference, const VariableClass& of) {
  Difference result;
  double squares = 0;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < std::min(run.samples(), reference.samples()); ++i) {
    for (const std::size_t column : of.columns) {
      const double error = run.values[i * run.variables + column] - reference.values[i * run.variables + column];
      if (std::isnan(error)) continue;
      result.largest = std::max(result.largest, std::fabs(error));
      squares += error * error;
      ++count;
    }
  }
  result.rms = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  return result;
}

Comparison compare(const ComparisonOptions& options, const Progress& progress) {
  return Comparer(options, progress).compare();
}

}  // namespace slew::analysis
