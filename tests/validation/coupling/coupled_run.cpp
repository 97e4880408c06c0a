#include "tests/validation/coupling/coupled_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

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

Ages exchanges_of(const scene::Scene& scene) {
  return [every = scene.session.exchange_every](StepIndex n) { return n % every; };
}

Ages lost(StepIndex count, StepIndex period) {
  return [count, period](StepIndex n) { return std::max<StepIndex>(0, n % period - (period - count) + 1); };
}

Ages delayed(StepIndex steps) {
  return [steps](StepIndex n) { return std::min(n, steps); };
}

CoupledRun::CoupledRun(const scene::Scene& scene, Ages ages)
    : H_(scene.session.step_duration()),
      mechanics_(scene),
      hydraulics_(scene),
      ages_(std::move(ages)),
      mechanics_samples_(kKept),
      hydraulics_samples_(kKept) {}

Status CoupledRun::start() {
  PartnerSamples partners;
  static_cast<void>(mechanics_.first_sample(mechanics_samples_[0]));
  partners.mechanism = &mechanics_samples_[0].mechanism;
  const Status status = hydraulics_.start(partners, hydraulics_samples_[0]);
  if (!status.is_ok()) return status;
  partners = {};
  partners.actuators = &hydraulics_samples_[0].actuators;
  return mechanics_.start(partners, mechanics_samples_[0]);
}

void CoupledRun::step(std::span<const double> controls) {
  const StepIndex age = ages_(n_);
  had_news_ = n_ - age != used_;
  used_ = n_ - age;
  PartnerSamples for_mechanics, for_hydraulics;
  for_mechanics.actuators = &hydraulics_samples_[slot(n_ - age)].actuators;
  for_hydraulics.mechanism = &mechanics_samples_[slot(n_ - age)].mechanism;
  for_mechanics.actuators_age = for_hydraulics.mechanism_age = age;
  const StepReport m = mechanics_.step(n_, for_mechanics, controls, mechanics_samples_[slot(n_ + 1)]);
  const StepReport h = hydraulics_.step(n_, for_hydraulics, controls, hydraulics_samples_[slot(n_ + 1)]);
  flags_ |= m.flags | h.flags;
  has_failed_ = has_failed_ || m.has_failed() || h.has_failed();
  ++n_;
}

void CoupledRun::change(std::string_view path, double value, SimDuration over) {
  const ParameterChange change{path, value, over};
  // a level of the coupling is both sides'
  const bool of_mechanics = mechanics_.change_parameter(n_, change);
  if (!hydraulics_.change_parameter(n_, change) && !of_mechanics) {
    throw std::runtime_error("no such parameter: " + std::string(path));
  }
}

double CoupledRun::variable(std::string_view name) const {
  for (const Subsystem* subsystem :
       {static_cast<const Subsystem*>(&mechanics_), static_cast<const Subsystem*>(&hydraulics_)}) {
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
  return compare(scene, reference, duration, exchanges_of(scene));
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
      if (run.had_news()) {
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
