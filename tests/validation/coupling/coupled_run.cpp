// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/coupling/coupled_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "scene/parameters.h"

namespace slew::coupling::test {

// ---- operator -------------------------------------------------------------------------------------------------

Operator::Operator(const scene::Scene& scene, SimDuration grid)
    : inputs_(scene.inputs), player_(scene), grid_(grid), ramped_(inputs_.size()), controls_(inputs_.size()) {}

std::span<const double> Operator::controls(SimTime t) {
  for (; (tick_ + 1) * grid_.ns <= t.ns;) {
    ++tick_;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const double raw = player_.value(i, SimTime{tick_ * grid_.ns});
      const double wanted = std::fabs(raw) > inputs_[i].dead_zone ? raw : 0.0;
      const double most = inputs_[i].ramp > 0 ? grid_.seconds() / inputs_[i].ramp : 2.0;
      ramped_[i] += std::clamp(wanted - ramped_[i], -most, most);
      controls_[i] = inputs_[i].scale * ramped_[i];
    }
  }
  return controls_;
}

// ---- coupled run ----------------------------------------------------------------------------------------------

Ages lost(StepIndex count, StepIndex period) {
  return [count, period](StepIndex n) { return std::max<StepIndex>(0, n % period - (period - count) + 1); };
}

Ages delayed(StepIndex steps) {
  return [steps](StepIndex n) { return std::min(n, steps); };
}

CoupledRun::CoupledRun(const scene::Scene& scene, Ages ages)
    : scene_(scene), session_(scene, ages), H_(scene.session.step_duration()), ages_(std::move(ages)) {}

Status CoupledRun::start() {
  return session_.start();
}

void CoupledRun::step(std::span<const double> controls) {
  const StepIndex age = ages_ ? ages_(n_) : n_ % scene_.session.exchange_every;
  had_new_sample_ = n_ - age != used_;
  used_ = n_ - age;
  session_.step(n_, changes_, controls);
  changes_.clear();
  for (const wire::Role role : {wire::Role::mechanics, wire::Role::hydraulics}) {
    flags_ |= session_.report(role).flags;
    has_failed_ = has_failed_ || session_.report(role).has_failed();
  }
  ++n_;
}

void CoupledRun::change(std::string_view path, double value, SimDuration over) {
  if (scene::ParameterDirectory(scene_).find(path) == nullptr) {
    throw std::runtime_error("no such parameter: " + std::string(path));
  }
  wire::Command& change = changes_.emplace_back();
  change.path = path;
  change.value = value;
  change.over_ns = over.ns;
}

double CoupledRun::variable(std::string_view name) const {
  for (const wire::Role role : {wire::Role::mechanics, wire::Role::hydraulics}) {
    const Subsystem* const subsystem = session_.subsystem(role);
    const std::span<const ElementVariable> variables = subsystem->variables();
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (variables[i].name != name) continue;
      std::vector<double> values(variables.size());
      subsystem->read_variables(values);
      return values[i];
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// ---- comparison -----------------------------------------------------------------------------------------------

Traces reference_traces(const scene::Scene& scene, double duration, monolith::MonolithOptions options) {
  monolith::Monolith monolith(scene, options);
  const Status status = monolith.start();
  if (!status.is_ok()) throw std::runtime_error(status.text);
  Operator op(scene, kControlGrid);
  Traces traces(scene.ports.size());
  const auto samples = static_cast<std::int64_t>(std::llround(duration / kTraceGrid.seconds()));
  for (std::int64_t k = 0; k <= samples; ++k) {
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const monolith::PortState& port = monolith.ports()[i];
      traces[i].x.push_back(port.x);
      traces[i].v.push_back(port.v);
      traces[i].F.push_back(port.F);
    }
    if (k == samples) break;
    const Status step = monolith.advance_to({(k + 1) * kTraceGrid.ns}, op.controls({k * kTraceGrid.ns}));
    if (!step.is_ok()) throw std::runtime_error(step.text);
  }
  return traces;
}

Comparison compare(const scene::Scene& scene, const Traces& reference, double duration) {
  return compare(scene, reference, duration, Ages{});
}

Comparison compare(const scene::Scene& scene, const Traces& reference, double duration, Ages ages) {
  CoupledRun run(scene, std::move(ages));
  const Status status = run.start();
  if (!status.is_ok()) throw std::runtime_error(status.text);
  Operator op(scene, kControlGrid);
  Comparison result;
  result.ports.resize(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const auto [low, high] = std::minmax_element(reference[i].F.begin(), reference[i].F.end());
    result.ports[i].F_range = *high - *low;
    result.ports[i].F_largest = std::max(std::fabs(*low), std::fabs(*high));
  }
  const SimDuration H = scene.session.step_duration();
  const auto steps = static_cast<StepIndex>(std::llround(duration / H.seconds()));
  for (StepIndex n = 0; n < steps && !run.has_failed(); ++n) {
    const std::int64_t before = monotonic_ns();
    run.step(op.controls(run.time()));
    result.seconds_of_work += 1e-9 * static_cast<double>(monotonic_ns() - before);
    result.omega_H = std::max(result.omega_H, run.indicator().omega_H());
    const bool is_on_grid = run.time().ns % kTraceGrid.ns == 0;
    const auto k = static_cast<std::size_t>(run.time().ns / kTraceGrid.ns);
    for (std::size_t i = 0; i < reference.size(); ++i) {
      PortError& port = result.ports[i];
      const PortDefects& defects = run.indicator().port(i);
      // work adds up from one exchange to the next
      if ((n + 1) % scene.session.exchange_every == 0) port.work += std::fabs(run.mechanism().work[i]);
      if (run.had_new_sample()) {
        port.residual += std::fabs(defects.dE_star);
        port.net += defects.dE_star;
      }
      const double F = run.actuators().F[i];
      const double K = run.hydraulics().integrator().actuators()[i].stiffness;
      port.spring = std::max(port.spring, F * F / (2 * K));
      if (!is_on_grid) continue;
      port.x = std::max(port.x, std::fabs(run.mechanism().x[i] - reference[i].x[k]));
      port.F = std::max(port.F, std::fabs(F - reference[i].F[k]));
    }
  }
  result.flags = run.flags();
  result.has_failed = run.has_failed();
  return result;
}

Comparison compare(scene::Scene& scene, double step, Level level, const Traces& reference, double duration) {
  scene.session.step = step;
  scene.session.coupling = level;
  return compare(scene, reference, duration);
}

}  // namespace slew::coupling::test
