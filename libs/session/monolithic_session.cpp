// SPDX-License-Identifier: Apache-2.0
#include "session/monolithic_session.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "coupling/parameter_ramps.h"
#include "flex_node/flex_subsystem.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "measurement/measuring_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "monolith/monolith.h"
#include "scene/instruments.h"
#include "sensor_node/sensor_subsystem.h"

namespace slew::session {
namespace {

using coupling::OwnSample;
using coupling::PartnerSamples;
using wire::Role;

// changes of parameters that may be under way together
constexpr std::size_t kMostRamps = 4096;

}  // namespace

// The one system of a session and how far it has come.
class Monolithic {
 public:
  explicit Monolithic(const scene::Scene& scene) : scene_(scene), H_(scene.session.step_duration()) { reset(); }

  void reset() {
    monolith_ = std::make_unique<monolith::Monolith>(
        scene_, monolith::MonolithOptions{scene_.session.rtol, scene_.session.rtol});
    const std::size_t ports = monolith_->ports().size();
    for (std::vector<double>* of_ports : {&F_, &work_, &impulse_}) of_ports->assign(ports, 0);
    ramps_.clear();
    paths_.clear();
    failure_.clear();
    next_ = -1;
  }

  // Time 0, by the first subsystem that calls it.
  Status start() {
    if (next_ >= 0) return Status::ok();
    if (Status status = monolith_->start(); !status.is_ok()) return status;
    next_ = 0;
    for (std::size_t i = 0; i < F_.size(); ++i) F_[i] = monolith_->ports()[i].F;
    return Status::ok();
  }

  void change_parameter(StepIndex n, const coupling::ParameterChange& change) {
    if (n < next_) return;  // another subsystem has started the step already, and it was done
    const std::optional<double> now = monolith_->parameter(change.path);
    if (!now) return;
    auto path = std::find(paths_.begin(), paths_.end(), change.path);
    if (path == paths_.end()) path = paths_.insert(path, std::string(change.path));
    ramps_.begin(static_cast<int>(path - paths_.begin()), *now, change.value, n, change.over, H_);
  }

  // From t_n to t_n+1, by the first subsystem that steps.
  void advance(StepIndex n, std::span<const double> controls) {
    if (n < next_ || !failure_.empty()) return;
    ramps_.apply(n, [this](int path, double value) {
      const Status status = monolith_->set_parameter(paths_[static_cast<std::size_t>(path)], value);
      if (!status.is_ok() && failure_.empty()) failure_ = status.text;
    });
    for (std::size_t i = 0; i < F_.size(); ++i) {
      work_[i] = -monolith_->ports()[i].work;
      impulse_[i] = -monolith_->ports()[i].impulse;
    }
    if (!failure_.empty()) return;
    const Status status = monolith_->advance_to(start_of(n + 1, H_), controls);
    for (std::size_t i = 0; i < F_.size(); ++i) {
      const monolith::PortState& port = monolith_->ports()[i];
      F_[i] = port.F;
      work_[i] += port.work;
      impulse_[i] += port.impulse;
    }
    if (!status.is_ok()) failure_ = status.text;
    next_ = n + 1;
  }

  [[nodiscard]] mechanics_node::FollowedStep mechanics() const noexcept {
    return {monolith_->equations().mechanism_state(), F_, work_, impulse_};
  }
  [[nodiscard]] hydraulics_node::FollowedCircuit circuit() const noexcept {
    const monolith::SceneEquations& equations = monolith_->equations();
    return {equations.circuit_state(), equations.circuit_vapour(), work_, impulse_};
  }
  // Empty: no failure.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  const scene::Scene& scene_;
  SimDuration H_;
  std::unique_ptr<monolith::Monolith> monolith_;
  std::vector<double> F_, work_, impulse_;  // by port; work and impulse of the last step
  std::vector<std::string> paths_;          // paths of the changed parameters; the index is a ramp's handle
  coupling::ParameterRamps ramps_{kMostRamps};
  StepIndex next_ = -1;  // step that is not done yet; -1: not started
  std::string failure_;
};

namespace {

// One part of the system as a subsystem: Shown follows.
template <typename Shown>
class Part : public coupling::Subsystem {
 public:
  template <typename... More>
  Part(std::shared_ptr<Monolithic> whole, const scene::Scene& scene, More... more)
      : whole_(std::move(whole)), shown_(scene, more...) {}

  bool first_sample(OwnSample& sample) noexcept override { return shown_.first_sample(sample); }

  Status start(const PartnerSamples& partners, OwnSample& sample) override {
    if (Status status = shown_.start(partners, sample); !status.is_ok()) return status;
    if (Status status = whole_->start(); !status.is_ok()) return status;
    // no tick has come yet: the state alone
    show(kJoinStep, partners, {}, sample);
    last_ = sample;
    return Status::ok();
  }

  StepReport step(StepIndex n, const PartnerSamples& partners, std::span<const double> controls,
                  OwnSample& sample) noexcept override {
    whole_->advance(n, controls);
    if (!whole_->failure().empty()) {
      sample = last_;
      StepReport report;
      report.raise(StepFlag::non_finite);
      return report;
    }
    const StepReport report = show(n, partners, controls, sample);
    last_ = sample;
    return report;
  }

  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override {
    whole_->change_parameter(n, change);
    return shown_.change_parameter(n, change);
  }

  void reset() override {
    shown_.reset();
    whole_->reset();
  }

  std::uint64_t state_hash() const noexcept override { return shown_.state_hash(); }
  Status can_save() const override {
    return Status::error(ExitCode::bad_input,
                         "session.solution: monolithic is integrated by CVODE, whose past cannot be put back, so that "
                         "its state is not saved. Set session.solution: split for a session that is to go on later");
  }
  void save(std::vector<std::byte>&) const override {}
  Status load(std::span<const std::byte>, OwnSample&) override {
    reset();
    return can_save();
  }
  coupling::Level level() const noexcept override { return shown_.level(); }
  std::span<const ElementVariable> variables() const noexcept override { return shown_.variables(); }
  void read_variables(std::span<double> values) const noexcept override { shown_.read_variables(values); }
  std::string_view offender_name(std::int32_t index) const noexcept override { return shown_.offender_name(index); }
  const Shown& shown() const noexcept { return shown_; }
  std::string_view failure_text() const noexcept override {
    return whole_->failure().empty() ? shown_.failure_text() : whole_->failure();
  }

 protected:
  virtual StepReport show(StepIndex n, const PartnerSamples& partners, std::span<const double> controls,
                          OwnSample& sample) noexcept = 0;
  std::shared_ptr<Monolithic> whole_;
  Shown shown_;

 private:
  OwnSample last_;  // last good sample
};

class MechanicsPart final : public Part<mechanics_node::MechanicsSubsystem> {
 public:
  using Part::Part;

 private:
  StepReport show(StepIndex n, const PartnerSamples&, std::span<const double> controls,
                  OwnSample& sample) noexcept override {
    return shown_.follow(n, whole_->mechanics(), controls, sample);
  }
};

class HydraulicsPart final : public Part<hydraulics_node::HydraulicsSubsystem> {
 public:
  using Part::Part;

 private:
  StepReport show(StepIndex n, const PartnerSamples& partners, std::span<const double> controls,
                  OwnSample& sample) noexcept override {
    return shown_.follow(n, whole_->circuit(), n < 0 ? PartnerSamples{} : partners, controls, sample);
  }
};

}  // namespace

std::unique_ptr<coupling::Subsystem> SubsystemFamily::make(Role role, const scene::Scene& scene) {
  if (role == Role::flex && scene.has_modes()) return flex_node::make_flex_subsystem(scene);
  if (role == Role::sensor && scene.has_sensors()) return sensor_node::make_sensor_subsystem(scene);
  const bool is_mechanics = role == Role::mechanics && scene.has_mechanics();
  const bool is_hydraulics = role == Role::hydraulics && scene.has_hydraulics();
  if (!is_mechanics && !is_hydraulics) return nullptr;
  if (scene.session.solution == scene::Solution::split) {
    return is_mechanics ? mechanics_node::make_mechanics_subsystem(scene)
                        : hydraulics_node::make_hydraulics_subsystem(scene);
  }
  if (monolithic_ == nullptr) monolithic_ = std::make_shared<Monolithic>(scene);
  const SimDuration step = scene.session.step_duration();
  if (is_mechanics) {
    auto mechanics = std::make_unique<MechanicsPart>(monolithic_, scene, mechanics_node::Motion::followed);
    const multibody::Model& model = mechanics->shown().model();
    return measurement::with_instruments(std::move(mechanics), scene::instruments_of(scene, scene::Computes::mechanics),
                                         step, [&model] { return model.gravity; });
  }
  return measurement::with_instruments(std::make_unique<HydraulicsPart>(monolithic_, scene),
                                       scene::instruments_of(scene, scene::Computes::hydraulics), step, {});
}

}  // namespace slew::session
