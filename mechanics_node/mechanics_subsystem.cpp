// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/mechanics_subsystem.h"

#include <cmath>

#include "core/failure.h"
#include "coupling/saved_model.h"
#include "measurement/measuring_subsystem.h"
#include "multibody/joints/joint_law.h"
#include "multibody/model/parameters.h"
#include "scene/instruments.h"
#include "scene/ports.h"
#include "scene/sensors.h"

namespace slew::mechanics_node {
namespace {

multibody::MechanicsDef as_moved(multibody::MechanicsDef mechanics, Motion motion) {
  if (motion == Motion::followed) mechanics.formulation = multibody::Formulation::recursive;
  return mechanics;
}

std::vector<double> ratios(const std::vector<Port>& ports) {
  std::vector<double> ratios;
  for (const Port& port : ports) ratios.push_back(port.ratio);
  return ratios;
}

// Index of the first coordinate or speed that is not finite.
std::int32_t first_not_finite(const multibody::State& state) noexcept {
  for (std::size_t i = 0; i < state.q.size(); ++i) {
    if (!std::isfinite(state.q[i])) return static_cast<std::int32_t>(i);
  }
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    if (!std::isfinite(state.u[i])) return static_cast<std::int32_t>(state.q.size() + i);
  }
  return -1;
}

// Bodies whose poses the sensors need, in the order of their frames.
std::vector<int> sensed_bodies(const scene::Scene& scene, const multibody::Model& model) {
  std::vector<int> bodies;
  if (!scene.has_sensors()) return bodies;
  const sensors::SensorsDef def = scene::sensors_of(scene);
  for (const contact::FrameDef& frame : std::span(def.frames).subspan(1)) {  // after Ground
    bodies.push_back(multibody::find_body(model, frame.name));
  }
  return bodies;
}

}  // namespace

MechanicsSubsystem::MechanicsSubsystem(const scene::Scene& scene, Motion motion)
    : H_(scene.session.step_duration()),
      exchange_every_(scene.session.exchange_every),
      mechanism_(scene, as_moved(scene.mechanics, motion)),
      substeps_(multibody::substep_count(model(), H_.seconds())),
      partner_(scene),
      row_mobility_(mechanism_, scene.ports.size(), exchange_interval(), H_.seconds() / substeps_),
      port_problem_(scene, mechanism_, partner_, row_mobility_),
      published_mobility_(mechanism_, row_mobility_, scene.ports.size(), exchange_interval()),
      modal_(scene, model()),
      sensed_bodies_(sensed_bodies(scene, model())),
      ramps_(multibody::parameter_count(model())),
      divergence_(model()),
      observing_(std::make_unique<MechanicsVariables::Work>(
          model(), PayloadSensitivity(model(), payload_of(mechanism_.def(), model()), ratios(port_problem_.ports())))),
      variables_(model(), port_problem_.ports(), observing_->payload.payload(), partner_.is_free_running()),
      last_good_(state()),
      row_force_(model().rows.size()),
      saved_model_(coupling::saved_model(
          variables_.list(),
          {H_.ns, exchange_every_, partner_.is_free_running(), static_cast<int>(mechanism_.def().formulation),
           static_cast<int>(multibody::step_rule(mechanism_.def()).integrator),
           static_cast<int>(scene.session.flexible)})) {
  coupling::resize(published_.mechanism, port_problem_.ports().size());
}

void MechanicsSubsystem::reset() {
  mechanism_.reset();
  observing_->payload.copy(model());
  last_good_ = state();
  partner_.reset();
  port_problem_.reset();
  ramps_.clear();
  divergence_.reset();
  has_failed_ = false;
  failure_ = StepReport{};
  coupling::resize(published_.mechanism, port_problem_.ports().size());
}

// ---- start ----------------------------------------------------------------------------------------------------

bool MechanicsSubsystem::first_sample(coupling::OwnSample& sample) noexcept {
  mechanism_.evaluate();
  // no work and no impulse yet, whatever the sample held before a reset
  coupling::resize(sample.mechanism, port_problem_.ports().size());
  publish(sample);
  return true;
}

Status MechanicsSubsystem::start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) {
  const std::size_t ports = port_problem_.ports().size();
  if (ports > 0) {
    if (partners.actuators == nullptr || partners.actuators->F.size() != ports) {
      return Status::error(ExitCode::failed, "hydraulics states " +
                                                 std::to_string(partners.actuators ? partners.actuators->F.size() : 0) +
                                                 " actuators, mechanics has " + std::to_string(ports) +
                                                 " ports: the nodes run different scenes");
    }
    port_problem_.set_forces(partners.actuators->F.span());
  }
  if (partners.elastic != nullptr) {
    Status status = modal_.begin(mechanism_.def(), *partners.elastic, mechanism_.change_model());
    if (!status.is_ok()) return status;
    observing_->payload.copy(model());
  }
  coupling::resize(sample.mechanism, ports);
  publish(sample);
  return Status::ok();
}

// ---- step -----------------------------------------------------------------------------------------------------

void MechanicsSubsystem::apply_ramps(StepIndex n) noexcept {
  if (ramps_.empty()) return;
  ramps_.apply(n, [this](int handle, double value) {
    multibody::set_parameter(mechanism_.change_model(), parameter_of(handle), value);
    multibody::set_parameter(observing_->payload.model(), parameter_of(handle), value);
  });
  port_problem_.forget_trends();
}

void MechanicsSubsystem::apply_signals(std::span<const double> controls) noexcept {
  if (!mechanism_.set_signals(controls)) return;
  observing_->payload.copy_signals(model());
  port_problem_.forget_trends();
}

// Elastic forces that the flex node publishes at every step. A sample of other sizes leaves those of the step before.
void MechanicsSubsystem::take_elastic_forces(const coupling::ElasticSample* sample, StepReport& report) noexcept {
  if (sample == nullptr || modal_.is_empty()) return;
  if (modal_.apply(*sample, mechanism_.change_model()) && modal_.apply(*sample, observing_->payload.model())) {
    modal_.take_places(*sample, model(), mechanism_.change_state());
  } else {
    report.raise(StepFlag::clamp_active);
  }
}

void MechanicsSubsystem::receive_forces(StepIndex n, const coupling::PartnerSamples& partners,
                                        StepReport& report) noexcept {
  partner_.receive(n, partners.actuators_age);
  if (partners.actuators == nullptr) return;
  if (partner_.is_too_old(published_.mechanism.W, *partners.actuators, H_.seconds())) {
    report.raise(StepFlag::late_input);
  }
}

StepReport MechanicsSubsystem::step(StepIndex n, const coupling::PartnerSamples& partners,
                                    std::span<const double> controls, coupling::OwnSample& sample) noexcept {
  if (has_failed_) {
    sample = published_;
    return failure_;
  }
  apply_ramps(n);
  apply_signals(controls);
  StepReport report;
  take_elastic_forces(partners.elastic, report);
  receive_forces(n, partners, report);
  const double h = H_.seconds() / substeps_;
  coupling::MechanismSample& out = sample.mechanism;
  coupling::resize(out, port_problem_.ports().size());
  if (n % exchange_every_ != 0) {
    out.work = published_.mechanism.work;
    out.impulse = published_.mechanism.impulse;
  }
  mechanism_.evaluate();
  const coupling::PortArray strokes_before = port_problem_.strokes();
  for (int i = 0; i < substeps_; ++i) {
    port_problem_.take_substep({n, partners.actuators, out, report}, h, i == 0);
    // the time counts steps, so that rounding does not add up
    mechanism_.state_as_evaluated().time = static_cast<double>(n) * H_.seconds() + (i + 1) * h;
  }
  if (!multibody::is_finite(state())) {
    report.raise(StepFlag::non_finite);
    report.offender = first_not_finite(state());
    divergence_.name_lost_motion(model(), offender_name(report.offender));
    return end_with(report, sample);
  }
  mechanism_.evaluate();
  divergence_.count_step(!report.has(StepFlag::not_converged));
  return finish_step(strokes_before, h, report, sample);
}

StepReport MechanicsSubsystem::follow(StepIndex n, const FollowedStep& step, std::span<const double> controls,
                                      coupling::OwnSample& sample) noexcept {
  if (has_failed_) {
    sample = published_;
    return failure_;
  }
  apply_ramps(n);
  apply_signals(controls);
  coupling::MechanismSample& out = sample.mechanism;
  const std::size_t ports = port_problem_.ports().size();
  coupling::resize(out, ports);
  const coupling::PortArray strokes_before = port_problem_.strokes();
  multibody::copy_state(step.state, mechanism_.change_state());
  port_problem_.forget_trends();
  port_problem_.set_forces(step.F);
  for (std::size_t i = 0; i < ports; ++i) {
    out.work[i] = step.work[i];
    out.impulse[i] = step.impulse[i];
  }
  mechanism_.evaluate();
  return finish_step(strokes_before, H_.seconds(), {}, sample);
}

StepReport MechanicsSubsystem::finish_step(const coupling::PortArray& strokes_before, double h,
                                           const StepReport& report, coupling::OwnSample& sample) noexcept {
  StepReport finished = report;
  if (divergence_.ends_run(model(), state(), mechanism_.workspace(), h, H_.seconds())) {
    finished.raise(StepFlag::ended);
    return end_with(finished, sample);
  }
  multibody::copy_state(state(), last_good_);
  const std::vector<Port>& ports = port_problem_.ports();
  const coupling::PortArray strokes = port_problem_.strokes();
  for (std::size_t i = 0; i < ports.size(); ++i) {
    sample.mechanism.v_mean[i] = (strokes[i] - strokes_before[i]) / H_.seconds();
    if (ports[i].law.touches_stop(strokes[i])) finished.raise(StepFlag::limit_hit);
  }
  publish(sample);
  raise_flags(finished);
  return finished;
}

StepReport MechanicsSubsystem::end_with(const StepReport& report, coupling::OwnSample& sample) noexcept {
  has_failed_ = true;
  failure_ = report;
  // variables are the last good ones as well
  mechanism_.show(last_good_);
  sample = published_;
  return report;
}

// Flags of the published instant: joint limits, deflections beyond the theory.
void MechanicsSubsystem::raise_flags(StepReport& report) const noexcept {
  const multibody::Workspace& workspace = mechanism_.workspace();
  for (std::size_t row = port_problem_.ports().size(); row < model().rows.size(); ++row) {
    if (multibody::touches_limit(model().rows[row].law, workspace.row_x[row])) report.raise(StepFlag::limit_hit);
  }
  for (std::size_t part = 0; part < model().parts.size(); ++part) {
    if (multibody::is_bent_far(model(), part, state().q)) report.raise(StepFlag::large_deflection);
  }
  for (const multibody::SegmentedPart& part : model().segmented) {
    if (multibody::is_bent_far(model(), part, workspace)) report.raise(StepFlag::large_deflection);
  }
}

std::string_view MechanicsSubsystem::offender_name(std::int32_t index) const noexcept {
  return multibody::joint_of(model(), index);
}

// Work, impulse and mean speed are those of the finished step and stay in the sample.
void MechanicsSubsystem::publish(coupling::OwnSample& sample) noexcept {
  mechanism_.evaluate();
  mechanism_.observe();
  port_problem_.publish_motion(sample.mechanism);
  published_mobility_.publish(port_problem_.ports(), sample.mechanism, row_force_);
  port_problem_.publish_line_forces(sample.mechanism, row_force_);
  modal_.read(model(), state(), mechanism_.workspace(), sample.flexible);
  sample.poses.frame.clear();
  for (const int body : sensed_bodies_) append_frame(model(), mechanism_.workspace(), body, sample.poses.frame);
  published_ = sample;
}

// ---- parameters, hash, variables ------------------------------------------------------------------------------

bool MechanicsSubsystem::change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept {
  if (partner_.levels().change(change.path, change.value)) return true;
  const std::optional<multibody::Parameter> parameter = multibody::find_parameter(model(), change.path);
  if (!parameter) return false;
  ramps_.begin(handle_of(*parameter), multibody::get_parameter(model(), *parameter), change.value, n, change.over, H_);
  return true;
}

std::uint64_t MechanicsSubsystem::state_hash() const noexcept {
  StateHash hash;
  mechanism_.add_to(hash);
  modal_.add_to(model(), hash);
  ramps_.add_to(hash);
  partner_.levels().add_to(hash);
  // with an exchange at every step each step begins with another copy
  port_problem_.add_to(hash, exchange_every_ > 1);
  mechanism_.add_signals_to(hash);
  divergence_.add_to(hash);
  hash.add(has_failed_);
  return hash.digest();
}

void MechanicsSubsystem::read_variables(std::span<double> values) const noexcept {
  variables_.read({mechanism_, port_problem_.ports(), published_.mechanism, row_force_, partner_.age()}, *observing_,
                  values);
}

std::unique_ptr<coupling::Subsystem> make_mechanics_subsystem(const scene::Scene& scene) {
  require(scene::check_is_split(scene));
  auto mechanics = std::make_unique<MechanicsSubsystem>(scene);
  const multibody::Model& model = mechanics->model();
  return measurement::with_instruments(std::move(mechanics), scene::instruments_of(scene, scene::Computes::mechanics),
                                       scene.session.step_duration(), [&model] { return model.gravity; });
}

}  // namespace slew::mechanics_node
