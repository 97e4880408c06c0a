// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes/case_stepper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/coupling_check.h"
#include "analysis/extremes/pressure_ceiling.h"
#include "core/arithmetic_self_test.h"
#include "hydraulics/circuit.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/joints/joint_gauge.h"
#include "scene/parameters.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace {

using wire::Role;

constexpr double kRunLimit = 60;  // s of processor time: wall time would count other load
constexpr StepIndex kStepsBetweenLooks = 64;
constexpr double kKickAfter = 0.02;  // s

session::SampleAges ages_of(const ExtremeCase& one, Strictness strictness, double H) {
  if (strictness == Strictness::kicked) {
    return [kick = kick_of(one, H)](StepIndex n) -> StepIndex { return n == kick ? 1 : 0; };
  }
  if (strictness == Strictness::compared) return {};
  if (one.delay > 0) return [delay = one.delay](StepIndex n) { return std::min(n, delay); };
  if (one.lost > 0) {
    return
        [lost = one.lost](StepIndex n) { return std::max<StepIndex>(0, n % kLossPeriod - (kLossPeriod - lost) + 1); };
  }
  return {};
}

// Energy of a port that the coupling made since the start.
struct PortEnergy {
  double gained = 0, made = 0;  // J: sum of dE*, the least it was
  double work = 0, stored = 0;  // J: done by the mechanics' side; in the oil at its largest force
  void add(double dE_star, double done, double F, double K) {
    gained += dE_star;
    made = std::max(made, -gained);
    work += std::fabs(done);
    if (K > 0) stored = std::max(stored, 0.5 * F * F / K);
  }
  [[nodiscard]] double share() const {
    const double scale = std::max(work, stored);
    return scale > 0 ? made / scale : 0;
  }
};

class Stepper {
 public:
  Stepper(const ExtremeCase& one, const scene::Scene& scene, Strictness strictness)
      : case_(one),
        scene_(scene),
        is_whole_(strictness == Strictness::whole),
        session_(scene, ages_of(one, strictness, scene.session.step)),
        ceiling_(scene),
        H_(scene.session.step_duration()) {
    if (const auto* mechanics = session_.physics<mechanics_node::MechanicsSubsystem>(Role::mechanics)) {
      mechanics_ = mechanics;
      gauge_.emplace(mechanics->model());
      ws_.emplace(mechanics->model());
    }
    hydraulics_ = session_.physics<hydraulics_node::HydraulicsSubsystem>(Role::hydraulics);
    if (hydraulics_ == nullptr) return;
    ceiling_.set_circuit(hydraulics_->circuit());
    values_.resize(hydraulics_->variables().size());
    const auto variables = hydraulics_->variables();
    for (const hydraulics::VolumeDef& volume : scene.hydraulics.volumes) {
      for (std::size_t i = 0; i < variables.size(); ++i) {
        if (!volume.fixed && variables[i].name == volume.name + ".pressure") pressures_.push_back({i, volume.name});
      }
    }
  }

  SteppedCase run() {
    run_.measures.H = H_.seconds();
    set_floating_point_mode();
    run_.measures.refusal = refusal_of_changes();
    if (!run_.measures.refusal.empty()) return std::move(run_);
    if (const Status status = session_.start(); !status.is_ok()) {
      run_.measures.refusal = status.text;
      return std::move(run_);
    }
    run_.measures.warnings = coupling_warnings(scene_, session_);
    const auto ports = scene_.ports.size();
    if (has_ports()) energy_.resize(ports);
    run_.trace.columns = ports > 0 ? ports : pressures_.size();
    const StepIndex steps = duration_of_seconds(case_.duration).ns / H_.ns;
    const StepIndex first = is_whole_ ? case_.begin_ns / H_.ns : 0;
    const StepIndex hold = is_whole_ && case_.hold_at >= 0 ? duration_of_seconds(case_.hold_at).ns / H_.ns : -1;
    const std::clock_t limit = std::clock() + static_cast<std::clock_t>(kRunLimit * CLOCKS_PER_SEC);
    for (StepIndex k = 0; k < steps && run_.measures.failure.empty() && run_.measures.alarm.empty(); ++k) {
      if (k == hold) sleep_until_monotonic(monotonic_ns() + kHold.ns);
      drive(k);
      session_.step(first + k, commands_, controls_);
      ++run_.measures.steps;
      look(k);
      if (k % kStepsBetweenLooks == 0 && std::clock() > limit) {
        run_.measures.failure = fmt::format("it takes more than {} s of processor time", kRunLimit);
        run_.measures.ended_at = run_.measures.H * static_cast<double>(k);
      }
    }
    finish();
    return std::move(run_);
  }

 private:
  struct Pressure {
    std::size_t index;
    std::string volume;
  };

  [[nodiscard]] bool has_ports() const { return hydraulics_ != nullptr && !scene_.ports.empty(); }

  // the same refusal as for a parameter change of a session
  [[nodiscard]] std::string refusal_of_changes() const {
    if (case_.changes.empty()) return {};
    const scene::ParameterDirectory directory(scene_);
    for (const SuddenChange& change : case_.changes) {
      const Status status = directory.check(change.path, change.value).status;
      if (!status.is_ok()) return status.text;
    }
    return {};
  }

  void drive(StepIndex k) {
    const double t = static_cast<double>(k) * H_.seconds();
    const double raw = case_.alternates ? (k % 2 == 0 ? 1.0 : -1.0) : raw_at(case_.inputs, t);
    controls_.resize(scene_.inputs.size());
    for (std::size_t i = 0; i < controls_.size(); ++i) {
      const scene::InputDef& input = scene_.inputs[i];
      controls_[i] = input.scale * (input.type == scene::InputType::digital ? std::max(0.0, raw) : raw);
    }
    commands_.clear();
    for (const SuddenChange& change : case_.changes) {
      if (duration_of_seconds(change.at).ns / H_.ns == k) commands_.push_back({0, change.path, change.value, 0});
    }
  }

  void look(StepIndex k) {
    Measures& m = run_.measures;
    std::uint32_t flags = 0;
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      if (session_.subsystem(role) != nullptr) flags |= session_.report(role).flags;
    }
    const auto count = [flags](StepFlag flag) { return (flags & static_cast<std::uint32_t>(flag)) != 0 ? 1 : 0; };
    m.not_converged += count(StepFlag::not_converged);
    m.over_budget += count(StepFlag::step_budget);
    m.cavitating += count(StepFlag::cavitating);
    m.relief_open += count(StepFlag::relief_open);
    m.at_limit += count(StepFlag::limit_hit);
    m.too_late += count(StepFlag::late_input);
    m.creates_energy += count(StepFlag::coupling_creates_energy);
    // the mechanics ends a diverged run, the hydraulics one that its coupling's alarm ends
    const bool has_diverged =
        session_.subsystem(Role::mechanics) != nullptr && session_.report(Role::mechanics).has(StepFlag::ended);
    if (count(StepFlag::non_finite) != 0 || has_diverged) {
      m.failure = session_.failure();
      m.ended_at = static_cast<double>(k + 1) * H_.seconds();
      return;
    }
    if (count(StepFlag::ended) != 0) {
      m.alarm = session_.failure();
      m.ended_at = static_cast<double>(k + 1) * H_.seconds();
    }
    look_at_circuit(k);
    if (k % std::max<std::int64_t>(1, milliseconds(1).ns / H_.ns) == 0) look_at_joints();
  }

  void look_at_circuit(StepIndex k) {
    if (hydraulics_ == nullptr) return;
    Measures& m = run_.measures;
    hydraulics_->read_variables(values_);
    for (const Pressure& pressure : pressures_) {
      const double p = values_[pressure.index];
      if (!m.highest_pressure || p > *m.highest_pressure) {
        m.highest_pressure = p;
        m.highest_at = pressure.volume;
      }
      m.lowest_pressure = std::min(m.lowest_pressure.value_or(p), p);
      if (!has_ports()) run_.trace.values.push_back(p);
    }
    if (!has_ports()) return;
    const coupling::Indicator& indicator = hydraulics_->indicator();
    const coupling::ActuatorSample& actuators = hydraulics_->at_instant();
    for (std::size_t i = 0; i < scene_.ports.size(); ++i) {
      energy_[i].add(indicator.port(i).dE_star, session_.mechanism().work[i], actuators.F[i], actuators.K[i]);
      m.eta = std::max(m.eta.value_or(0), indicator.port(i).eta);
      run_.trace.values.push_back(actuators.F[i]);
    }
    const double omega_H = indicator.omega_H();
    m.stiffness = std::max(m.stiffness.value_or(0), omega_H * omega_H);
    ceiling_.follow(session_.mechanism(), actuators);
    if (k == 0 || !commands_.empty()) ceiling_.put_on(session_.mechanism());
  }

  void look_at_joints() {
    if (mechanics_ == nullptr) return;
    mechanics_->mechanism().observe(mechanics_->model(), mechanics_->state(), *ws_);
    const double gap = gauge_->measure(*ws_).position;
    std::optional<double>& largest = run_.measures.gap;
    // a value that is not a number stays
    if (!largest || !(gap <= *largest)) largest = std::isnan(largest.value_or(0)) ? largest : gap;
  }

  void finish() {
    Measures& m = run_.measures;
    if (m.highest_pressure) m.ceiling = ceiling_.value();
    for (const PortEnergy& port : energy_) m.made = std::max(m.made.value_or(0), port.share());
    for (const Role role : {Role::mechanics, Role::hydraulics}) {
      const coupling::Subsystem* subsystem = session_.subsystem(role);
      if (subsystem == nullptr) continue;
      std::vector<double> values(subsystem->variables().size());
      subsystem->read_variables(values);
      run_.trace.last.insert(run_.trace.last.end(), values.begin(), values.end());
    }
  }

  const ExtremeCase& case_;
  const scene::Scene& scene_;
  bool is_whole_;
  session::DirectSession session_;
  PressureCeiling ceiling_;
  SimDuration H_;
  const mechanics_node::MechanicsSubsystem* mechanics_ = nullptr;
  const hydraulics_node::HydraulicsSubsystem* hydraulics_ = nullptr;
  std::optional<multibody::JointGauge> gauge_;
  std::optional<multibody::Workspace> ws_;
  std::vector<double> values_;
  std::vector<Pressure> pressures_;
  std::vector<PortEnergy> energy_;  // by port
  std::vector<double> controls_;
  std::vector<wire::Command> commands_;
  SteppedCase run_;
};

}  // namespace

StepIndex kick_of(const ExtremeCase& one, double H) {
  const double from = one.inputs.empty() ? 0 : one.inputs.front().at;
  return static_cast<StepIndex>((from + kKickAfter) / H);
}

SteppedCase step_case(const ExtremeCase& one, const scene::Scene& scene, Strictness strictness) {
  return Stepper(one, scene, strictness).run();
}

}  // namespace slew::analysis
