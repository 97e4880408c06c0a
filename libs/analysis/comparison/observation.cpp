// SPDX-License-Identifier: Apache-2.0
#include "analysis/comparison/observation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/failure.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/results/observe.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr StepIndex kStepsBetweenQuestions = 64;
constexpr Role kPhysics[] = {Role::mechanics, Role::hydraulics};

// Places of the chosen variables among those of the two subsystems.
class SampleReader {
 public:
  SampleReader(const session::DirectSession& session, std::span<const std::string> names)
      : session_(session), places_(names.size()) {
    std::size_t found = 0;
    for (const Role role : kPhysics) {
      const coupling::Subsystem* subsystem = session.subsystem(role);
      if (subsystem == nullptr) continue;
      const std::span<const ElementVariable> all = subsystem->variables();
      buffer_.resize(std::max(buffer_.size(), all.size()));
      for (std::size_t i = 0; i < names.size(); ++i) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == names[i]; });
        if (at == all.end()) continue;
        places_[i] = {role, static_cast<std::size_t>(at - all.begin())};
        ++found;
      }
    }
    if (found != names.size()) {
      throw Failure(ExitCode::failed, "the runs of a comparison do not have the same variables");
    }
  }

  void read(double* values) {
    for (const Role role : kPhysics) {
      const bool is_wanted =
          std::any_of(places_.begin(), places_.end(), [role](const Place& place) { return place.role == role; });
      if (!is_wanted) continue;
      const coupling::Subsystem& subsystem = *session_.subsystem(role);
      subsystem.read_variables({buffer_.data(), subsystem.variables().size()});
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (places_[i].role == role) values[i] = buffer_[places_[i].index];
      }
    }
  }

 private:
  struct Place {
    Role role = Role::mechanics;
    std::size_t index = 0;
  };
  const session::DirectSession& session_;
  std::vector<Place> places_;
  std::vector<double> buffer_;
};

// Energy and joints, from the poses that the formulation integrates; not for a mechanism that another subsystem
// integrates.
class Mechanism {
 public:
  explicit Mechanism(const session::DirectSession& session)
      : mechanics_(session.physics<mechanics_node::MechanicsSubsystem>(Role::mechanics)) {
    if (mechanics_ == nullptr) return;
    gauge_.emplace(mechanics_->model());
    ws_.emplace(mechanics_->model());
  }

  void measure(std::size_t sample, Observation& run) {
    if (mechanics_ == nullptr) return;
    const multibody::Model& model = mechanics_->model();
    mechanics_->mechanism().observe(model, mechanics_->state(), *ws_);
    const multibody::Energy energy = multibody::energy(model, *ws_);
    run.energy[sample] = energy.kinetic + energy.potential;
    run.largest_kinetic_energy = std::max(run.largest_kinetic_energy, energy.kinetic);
    const multibody::JointGap gap = gauge_->measure(*ws_);
    if (gap.position > run.gap.position) {
      run.gap.position = gap.position;
      run.gap.joint = gap.joint;
    }
    run.gap.rate = std::max(run.gap.rate, gap.rate);
  }

 private:
  const mechanics_node::MechanicsSubsystem* mechanics_;
  std::optional<multibody::JointGauge> gauge_;
  std::optional<multibody::Workspace> ws_;
};

// Times of the steps of several runs, as microseconds per simulated millisecond.
class TimedSteps {
 public:
  TimedSteps(StepIndex steps, double milliseconds_of_step)
      : fastest_(static_cast<std::size_t>(steps), std::numeric_limits<std::int64_t>::max()),
        scale_(1e-3 / milliseconds_of_step) {}

  void add(StepIndex step, std::int64_t ns) {
    std::int64_t& fastest = fastest_[static_cast<std::size_t>(step)];
    fastest = std::min(fastest, ns);
    run_ns_ += ns;
  }
  void end_run() { runs_.push_back(std::exchange(run_ns_, 0)); }

  [[nodiscard]] double mean() const {
    std::int64_t sum = 0;
    for (const std::int64_t ns : fastest_) sum += ns;
    return of_step(static_cast<double>(sum));
  }
  [[nodiscard]] double slowest() const {
    return fastest_.empty() ? 0 : scale_ * static_cast<double>(*std::max_element(fastest_.begin(), fastest_.end()));
  }
  [[nodiscard]] double run_median() const {
    std::vector<std::int64_t> sorted = runs_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    return n == 0 ? 0 : of_step(0.5 * static_cast<double>(sorted[(n - 1) / 2] + sorted[n / 2]));
  }

 private:
  [[nodiscard]] double of_step(double ns) const {
    return fastest_.empty() ? 0 : scale_ * ns / static_cast<double>(fastest_.size());
  }

  std::vector<std::int64_t> fastest_;  // ns, by step
  std::vector<std::int64_t> runs_;     // ns, of whole runs
  std::int64_t run_ns_ = 0;
  double scale_;
};

}  // namespace

Observation observe_run(const scene::Scene& scene, std::span<const std::string> variables, SimDuration until,
                        SimDuration sample, const GoesOn& goes_on) {
  PlayedScene played(scene);
  SampleReader reader(played.session(), variables);
  Mechanism mechanism(played.session());
  Observation run;
  run.sample = sample;
  run.variables = variables.size();
  const auto samples = static_cast<std::size_t>(until.ns / sample.ns) + 1;
  run.values.assign(samples * variables.size(), std::numeric_limits<double>::quiet_NaN());
  run.energy.assign(samples, std::numeric_limits<double>::quiet_NaN());
  const auto look = [&] {
    if (played.time().ns % sample.ns != 0) return;
    const auto i = static_cast<std::size_t>(played.time().ns / sample.ns);
    reader.read(run.values.data() + i * variables.size());
    mechanism.measure(i, run);
  };
  look();
  const SimDuration H = scene.session.step_duration();
  const StepIndex steps = until.ns / H.ns;
  while (run.steps < steps) {
    if (run.steps % kStepsBetweenQuestions == 0 &&
        !goes_on(static_cast<double>(run.steps) / static_cast<double>(steps))) {
      run.is_interrupted = true;
      return run;
    }
    played.advance();
    ++run.steps;
    const StepReport& report = played.session().report(Role::mechanics);
    run.iterations += report.iterations;
    if (report.has(StepFlag::not_converged) || played.session().report(Role::hydraulics).has(StepFlag::not_converged)) {
      ++run.not_converged;
    }
    if (report.has_failed() || played.session().report(Role::hydraulics).has_failed()) {
      run.failure = played.session().failure();
      run.failed_at = played.time().seconds();
      break;
    }
    look();
  }
  run.state_hashes = played.state_hashes();
  return run;
}

Cost time_runs(const scene::Scene& scene, StepIndex steps, int repeats, const StateHashes& state_hashes,
               const GoesOn& goes_on) {
  Cost cost;
  const double milliseconds = scene.session.step_duration().seconds() * 1e3;  // duration of a step
  TimedSteps mechanics(steps, milliseconds), whole(steps, milliseconds);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    PlayedScene played(scene);
    for (StepIndex n = 0; n < steps; ++n) {
      if (n % kStepsBetweenQuestions == 0 &&
          !goes_on((repeat + static_cast<double>(n) / static_cast<double>(steps)) / repeats)) {
        cost.is_interrupted = true;
        return cost;
      }
      played.advance();
      const std::int64_t mechanics_ns = played.session().step_time_ns(Role::mechanics);
      mechanics.add(n, mechanics_ns);
      whole.add(n, mechanics_ns + played.session().step_time_ns(Role::hydraulics));
    }
    mechanics.end_run();
    whole.end_run();
    cost.is_repeatable = cost.is_repeatable && played.state_hashes() == state_hashes;
  }
  cost.mechanics = mechanics.mean();
  cost.mechanics_slowest = mechanics.slowest();
  cost.whole = whole.mean();
  cost.mechanics_run_median = mechanics.run_median();
  cost.whole_run_median = whole.run_median();
  return cost;
}

}  // namespace slew::analysis
