// SPDX-License-Identifier: Apache-2.0
// The hydraulics' state as bytes: the circuit's integration, the copy of the partner's model, the coupling's indicator.
#include "hydraulics_node/hydraulics_subsystem.h"

namespace slew::hydraulics_node {
namespace {

constexpr std::uint32_t kLayout = 5;

}  // namespace

template <typename Self, typename Bytes>
void HydraulicsSubsystem::visit(Self& self, Bytes& bytes) {
  if constexpr (Bytes::kIsReading) {
    self.integrator_->load(bytes);
    const int parameters = static_cast<int>(self.circuit_->parameters().size());
    self.ramps_.load(bytes, [&](int handle) { return handle >= 0 && handle < parameters; });
    self.levels_.load(bytes);
    self.reduced_.load(bytes);
    self.signals_.load(bytes);
    self.alarm_.load_indicator(bytes);
  } else {
    self.integrator_->save(bytes);
    self.ramps_.save(bytes);
    self.levels_.save(bytes);
    self.reduced_.save(bytes);
    self.signals_.save(bytes);
    self.alarm_.save_indicator(bytes);
  }
  LateSamples::visit(self.late_samples_, bytes);
  bytes.number(self.used_step_);
  bytes.number(self.partner_age_);
  visit_actuators(self.published_, self.m_, self.cross_count(), bytes);
  visit_sized(bytes, self.stiffness_, self.m_);
  visit_report(bytes, self.failure_);
  CouplingAlarm::visit_text(self.alarm_, bytes);
  CouplingAlarm::visit_made(self.alarm_, bytes);
  ForeseenForces::visit(self.foreseen_, bytes);
  bytes.flag(self.has_own_);
  if (self.has_own_) visit_actuators(self.own_, self.m_, self.cross_count(), bytes);
  ConvergenceWatch::visit(self.convergence_, bytes);
}

Status HydraulicsSubsystem::can_save() const {
  if (integrator_->can_save()) return Status::ok();
  return Status::error(
      ExitCode::bad_input,
      "hydraulics.solver: cvode keeps a history that cannot be restored, so that its state is not saved. "
      "Set hydraulics.solver: rodas3, implicit_euler or rk4 for a session that is to be continued later");
}

void HydraulicsSubsystem::save(std::vector<std::byte>& state) const {
  if (!integrator_->can_save()) return;
  StateWriter bytes(state, {kLayout, saved_model_});
  visit(*this, bytes);
  bytes.finish();
}

Status HydraulicsSubsystem::load(std::span<const std::byte> state, coupling::OwnSample& sample) {
  reset();
  if (Status status = can_save(); !status.is_ok()) return status;
  StateReader bytes(state, {kLayout, saved_model_});
  visit(*this, bytes);
  if (Status status = bytes.finish("hydraulics"); !status.is_ok()) {
    reset();
    return status;
  }
  sample = {};
  sample.actuators = published_;
  return Status::ok();
}

}  // namespace slew::hydraulics_node
