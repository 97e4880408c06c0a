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

CoupledRun::CoupledRun(const scene::Scene& scene)
    : H_(scene.session.step_duration()), mechanics_(scene), hydraulics_(scene) {}

Status CoupledRun::start() {
  PartnerSamples partners;
  static_cast<void>(mechanics_.first_sample(mechanics_sample_));
  partners.mechanism = &mechanics_sample_.mechanism;
  const Status status = hydraulics_.start(partners, hydraulics_sample_);
  if (!status.is_ok()) return status;
  partners = {};
  partners.actuators = &hydraulics_sample_.actuators;
  return mechanics_.start(partners, mechanics_sample_);
}

void CoupledRun::step(std::span<const double> controls) {
  PartnerSamples for_mechanics, for_hydraulics;
  for_mechanics.actuators = &hydraulics_sample_.actuators;
  for_hydraulics.mechanism = &mechanics_sample_.mechanism;
  mechanics_next_ = mechanics_sample_;
  hydraulics_next_ = hydraulics_sample_;
  const StepReport m = mechanics_.step(n_, for_mechanics, controls, mechanics_next_);
  const StepReport h = hydraulics_.step(n_, for_hydraulics, controls, hydraulics_next_);
  std::swap(mechanics_sample_, mechanics_next_);
  std::swap(hydraulics_sample_, hydraulics_next_);
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

Traces reference_traces(const scene::Scene& scene, double duration, std::int64_t* right_hand_sides) {
  monolith::Monolith monolith(scene);
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
  if (right_hand_sides != nullptr) *right_hand_sides = monolith.statistics().right_hand_sides;
  return traces;
}

Comparison compare(const scene::Scene& scene, const Traces& reference, double duration) {
  CoupledRun run(scene);
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
      port.work += std::fabs(run.mechanism().work[i]);
      port.residual += std::fabs(defects.dE_star);
      port.net += defects.dE_star;
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
