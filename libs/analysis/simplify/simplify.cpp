// SPDX-License-Identifier: Apache-2.0
#include "analysis/simplify/simplify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/comparison/comparison.h"
#include "analysis/comparison/observation.h"
#include "analysis/description/instant.h"
#include "core/failure.h"
#include "scene/name_pattern.h"

namespace slew::analysis {
namespace {

using wire::Role;

// attempts that are expected before the candidates are known, for the progress
constexpr std::size_t kUsualWorks = 20;

// "Bag.position 1mm"
struct ErrorLimit {
  std::string name, tolerance;
};

ErrorLimit parse(const std::string& text) {
  const std::size_t space = text.find(' ');
  if (space == std::string::npos || text.find_first_not_of(' ', space) == std::string::npos) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--error: '{}' has no tolerance; expected a variable and a quantity or a part of its "
                              "range, such as 'Bag.position 1mm' or 'Cyl_Lift.force 1%'",
                              text));
  }
  return {text.substr(0, space), text.substr(text.find_first_not_of(' ', space))};
}

// The position of each payload that the scene names, within a millimetre.
std::vector<std::string> errors_of_payloads(const scene::Scene& scene) {
  std::vector<std::string> errors;
  if (!scene.mechanics.payload.empty()) errors.push_back(scene.mechanics.payload + ".position 1mm");
  for (const std::string& payload : scene.other_payloads) errors.push_back(payload + ".position 1mm");
  return errors;
}

class Simplifier {
 public:
  Simplifier(const SimplifyOptions& options, const SimplifyProgress& progress, const SimplifyCost& cost)
      : options_(options), progress_(progress), cost_(cost), base_(load({})) {
    if (!base_->has_mechanics()) {
      throw Failure(ExitCode::bad_input, "the scene has no bodies; there is nothing here to simplify");
    }
    if (!(base_->session.duration > 0)) {
      throw Failure(ExitCode::bad_input,
                    "the scene runs until it is stopped; nothing was run; set --until to the time to try");
    }
    errors_ = options.errors;
    if (errors_.empty()) errors_ = errors_of_payloads(*base_);
    if (errors_.empty()) {
      throw Failure(ExitCode::bad_input,
                    "no tolerance is given and the scene names no payload; nothing was run; name a variable and its "
                    "tolerance with --error, such as 'Bag.position 1mm', or the body in `payload:` of the scene");
    }
    sample_ = {kStepsPerSample * base_->session.step_duration().ns};
    until_ = {base_->session.steps() * base_->session.step_duration().ns / sample_.ns * sample_.ns};
    if (until_.ns == 0) {
      throw Failure(ExitCode::bad_input,
                    fmt::format("a run of fewer than {} steps shows nothing; give a longer --until", kStepsPerSample));
    }
  }

  Simplification run() {
    result_.scene = base_->name;
    result_.until = until_.seconds();
    result_.repeats = options_.repeats;
    watch();
    run_base();
    if (!is_stopped_) try_alone();
    if (!is_stopped_) take_together();
    result_.is_interrupted = is_stopped_;
    if (is_stopped_) take_nothing();
    return std::move(result_);
  }

 private:
  // nothing: the scene's rules refuse it; refusal gets the reason
  std::optional<scene::Scene> load(const scene::Overrides& settings, std::string* refusal = nullptr) {
    scene::SceneOptions scene_options = options_.scene;
    scene_options.overrides.insert(scene_options.overrides.end(), settings.begin(), settings.end());
    scene_options.overrides.emplace_back("session.solution=split");
    try {
      return scene::load_scene(scene_options);
    } catch (const scene::LoadError& error) {
      if (refusal == nullptr) throw;
      const scene::Diagnostic& first = error.diagnostics().front();
      *refusal = first.path.empty() ? first.what : first.path + ": " + first.what;
    }
    return std::nullopt;
  }

  [[nodiscard]] GoesOn part(std::string doing) {
    return [this, doing = std::move(doing)](double share) {
      const double all = static_cast<double>(std::max<std::size_t>(works_, 1));
      is_stopped_ = is_stopped_ || !progress_(doing, std::min(1.0, (static_cast<double>(done_) + share) / all));
      return !is_stopped_;
    };
  }

  // names, dimensions and limits of the watched variables
  void watch() {
    const std::vector<ElementVariable> variables = session::DirectSession(*base_).variables();
    std::vector<std::string> names;
    for (const ElementVariable& variable : variables) names.push_back(variable.name);
    for (const std::string& text : errors_) {
      const ErrorLimit limit = parse(text);
      // the name of a vector stands for all of its parts
      std::vector<std::string> patterns = {limit.name};
      const bool is_whole = std::find(names.begin(), names.end(), limit.name) != names.end();
      if (!is_whole && limit.name.find('*') == std::string::npos) patterns = {limit.name + ".?"};
      std::vector<std::string> chosen;
      try {
        chosen = scene::choose(patterns, names);
      } catch (const Failure&) {
        // the error message suggests names for the name as it was written
        patterns = {limit.name};
        chosen = scene::choose(patterns, names);
      }
      for (const std::string& name : chosen) {
        const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        Watched watched{
            .name = name, .unit = std::string(info(variables[at].dimension).si_unit), .tolerance = 0, .range = 0};
        if (limit.tolerance.ends_with('%')) {
          fraction_.push_back(read_option("--error", limit.tolerance, Dimension::none));
        } else {
          watched.tolerance = read_option("--error", limit.tolerance, variables[at].dimension);
          fraction_.push_back(0);
        }
        if (!(watched.tolerance > 0 || fraction_.back() > 0)) {
          throw Failure(ExitCode::bad_input,
                        fmt::format("--error: '{}' is no tolerance; expected more than zero", text));
        }
        names_.push_back(name);
        result_.watched.push_back(std::move(watched));
      }
    }
  }

  void run_base() {
    base_run_ = observe_run(*base_, names_, until_, sample_, part("the scene as it is"));
    if (is_stopped_) return;
    if (!base_run_.failure.empty()) {
      throw Failure(ExitCode::diverged,
                    fmt::format("the scene as it is ends at {} s: {}", base_run_.failed_at, base_run_.failure));
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t k = 0; k < base_run_.samples(); ++k) {
        low = std::min(low, base_run_.values[k * names_.size() + i]);
        high = std::max(high, base_run_.values[k * names_.size() + i]);
      }
      Watched& watched = result_.watched[i];
      watched.range = high - low;
      if (fraction_[i] > 0) watched.tolerance = fraction_[i] * watched.range;
    }
    result_.base_cost = cost_of(*base_, base_run_, "the scene as it is");
    find_unused();
  }

  double cost_of(const scene::Scene& scene, const Observation& run, const std::string& doing) {
    if (cost_) return cost_(scene, run.steps);
    return time_runs(scene, run.steps, options_.repeats, run.state_hashes, part(doing)).whole;
  }

  // every step of the unchanged scene: pairs that never touch, joints that never move
  void find_unused() {
    PlayedScene played(*base_);
    const coupling::Subsystem& mechanics = *played.session().subsystem(Role::mechanics);
    std::vector<double> values(mechanics.variables().size()), first(values.size()), reach(values.size()),
        most(values.size());
    mechanics.read_variables(first);
    most = first;
    const StepIndex steps = until_.ns / base_->session.step_duration().ns;
    for (StepIndex n = 0; n < steps; ++n) {
      played.advance();
      mechanics.read_variables(values);
      for (std::size_t i = 0; i < values.size(); ++i) {
        reach[i] = std::max(reach[i], std::fabs(values[i] - first[i]));
        most[i] = std::max(most[i], values[i]);
      }
    }
    const std::span<const ElementVariable> variables = mechanics.variables();
    const auto at = [&](const std::string& name) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < variables.size(); ++i) {
        if (variables[i].name == name) return i;
      }
      return std::nullopt;
    };
    for (const multibody::ContactPairDef& pair : base_->mechanics.contacts) {
      const auto contacts = at(pair.name + ".contacts");
      if (pair.tested && contacts && most[*contacts] == 0) found_.untouched_pairs.push_back(pair.name);
    }
    for (const multibody::JointDef& joint : base_->mechanics.joints) {
      const auto position = at(joint.name + ".position");
      if (position && reach[*position] <= kStill) found_.still_joints.push_back(joint.name);
    }
  }

  // settings in addition to the user's own
  Trial attempt(Candidate candidate) {
    Trial trial{.candidate = std::move(candidate)};
    std::optional<scene::Scene> scene = load(trial.candidate.settings, &trial.refusal);
    if (scene) run_trial(*scene, trial);
    trial.was_interrupted = is_stopped_;
    ++done_;
    return trial;
  }

  void run_trial(const scene::Scene& scene, Trial& trial) {
    Observation run;
    try {
      run = observe_run(scene, names_, until_, sample_, part(trial.candidate.title));
    } catch (const Failure& failure) {
      trial.refusal = failure.what();
      return;
    }
    if (is_stopped_) return;
    if (!run.failure.empty()) {
      trial.refusal = fmt::format("its run ends at {:.6g} s: {}", run.failed_at, run.failure);
      return;
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      trial.changes.push_back(difference(run, base_run_, {.unit = "", .columns = {i}}).largest);
    }
    // a candidate that does not hold is not timed
    if (holds(result_.watched, trial)) trial.cost = cost_of(scene, run, trial.candidate.title);
  }

  void try_alone() {
    const std::vector<Candidate> all = candidates(*base_, found_);
    works_ = 2 * all.size() + 1;
    for (const Candidate& candidate : all) {
      result_.trials.push_back(attempt(candidate));
      if (is_stopped_) return;
    }
  }

  [[nodiscard]] bool pays(const Trial& trial, double than) const {
    return trial.has_run() && holds(result_.watched, trial) && trial.cost < (1 - kLeastSaving) * than;
  }

  void take_together() {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < result_.trials.size(); ++i) {
      if (pays(result_.trials[i], result_.base_cost)) order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return result_.trials[a].cost < result_.trials[b].cost; });
    double cost = result_.base_cost;
    std::vector<std::string> groups;
    for (const std::size_t i : order) {
      Trial& trial = result_.trials[i];
      if (std::find(groups.begin(), groups.end(), trial.candidate.group) != groups.end()) continue;
      Trial together = trial;
      if (!result_.settings.empty()) {
        Candidate both{.title = "with " + trial.candidate.title, .group = "", .settings = result_.settings};
        both.settings.insert(both.settings.end(), trial.candidate.settings.begin(), trial.candidate.settings.end());
        together = attempt(std::move(both));
        if (is_stopped_) return;
      }
      if (!pays(together, cost)) continue;
      cost = together.cost;
      trial.is_taken = true;
      groups.push_back(trial.candidate.group);
      result_.settings.insert(result_.settings.end(), trial.candidate.settings.begin(), trial.candidate.settings.end());
    }
    if (result_.settings.empty()) return;
    result_.combined = attempt({.title = "all that are taken", .group = "", .settings = result_.settings});
    // measured once more: a saving that does not repeat is rejected
    if (pays(result_.combined, result_.base_cost)) return;
    take_nothing();
  }

  void take_nothing() {
    result_.settings.clear();
    for (Trial& trial : result_.trials) trial.is_taken = false;
  }

  const SimplifyOptions& options_;
  const SimplifyProgress& progress_;
  const SimplifyCost& cost_;
  std::vector<std::string> errors_;  // those of the options, or of the scene's payload
  std::optional<scene::Scene> base_;
  SimDuration sample_, until_;
  std::vector<std::string> names_;
  std::vector<double> fraction_;  // share of the range, by name; 0: the tolerance is given
  Observation base_run_;
  RunFindings found_;
  std::size_t done_ = 0, works_ = kUsualWorks;
  bool is_stopped_ = false;
  Simplification result_;
};

}  // namespace

std::size_t worst_of(const std::vector<Watched>& watched, const Trial& trial) {
  std::size_t worst = 0;
  for (std::size_t i = 1; i < trial.changes.size(); ++i) {
    const bool is_worse = trial.changes[i] * watched[worst].tolerance > trial.changes[worst] * watched[i].tolerance;
    if (is_worse) worst = i;
  }
  return worst;
}

bool holds(const std::vector<Watched>& watched, const Trial& trial) {
  if (trial.was_interrupted || trial.changes.size() != watched.size()) return false;
  for (std::size_t i = 0; i < watched.size(); ++i) {
    if (!(trial.changes[i] <= watched[i].tolerance)) return false;
  }
  return true;
}

Simplification simplify(const SimplifyOptions& options, const SimplifyProgress& progress, const SimplifyCost& cost) {
  return Simplifier(options, progress, cost).run();
}

}  // namespace slew::analysis
