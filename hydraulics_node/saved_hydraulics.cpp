// The hydraulics' state as bytes: the circuit's integration, the copy of the partner's model, the coupling's indicator.
#include "hydraulics_node/hydraulics_subsystem.h"

namespace slew::hydraulic_node {
namespace {

constexpr std::uint32_t kLayout = 1;

template <typename Sample, typename Bytes>
void visit_sample(Sample& sample, std::size_t ports, Bytes& bytes) {
  for (auto* values :
       {&sample.F, &sample.F_dot, &sample.K, &sample.lambda, &sample.D, &sample.x_ref, &sample.v_ref,
        &sample.friction_scale, &sample.work, &sample.impulse, &sample.p_A, &sample.p_B, &sample.Q_A, &sample.Q_B}) {
    visit_sized(bytes, *values, ports);
  }
  bytes.number(sample.flags);
}

}  // namespace

template <typename Self, typename Bytes>
void HydraulicsSubsystem::visit(Self& self, Bytes& bytes) {
  if constexpr (Bytes::kIsReading) {
    self.integrator_->load(bytes);
    const int parameters = static_cast<int>(self.circuit_->parameters().size());
    self.ramps_.load(bytes, [&](int handle) { return handle >= 0 && handle < parameters; });
    self.levels_.load(bytes);
    self.reduced_.load(bytes);
    self.signal_trends_.load(bytes);
    self.indicator_.load(bytes);
    if (self.is_free_running_) self.past_.load(bytes);
  } else {
    self.integrator_->save(bytes);
    self.ramps_.save(bytes);
    self.levels_.save(bytes);
    self.reduced_.save(bytes);
    self.signal_trends_.save(bytes);
    self.indicator_.save(bytes);
    if (self.is_free_running_) self.past_.save(bytes);
  }
  for (auto& sent : self.history_) {
    bytes.number(sent.step);
    if (sent.step < 0) continue;
    visit_sample(sent.sample, self.m_, bytes);
    visit_sized(bytes, sent.displacement, self.m_);
  }
  bytes.number(self.used_step_);
  bytes.number(self.partner_age_);
  visit_sample(self.published_, self.m_, bytes);
  visit_sized(bytes, self.stiffness_, self.m_);
  visit_report(bytes, self.failure_);
  bytes.count(self.failure_text_length_, self.failure_text_.size());
  bytes.numbers(std::span(self.failure_text_).first(self.failure_text_length_));
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

}  // namespace slew::hydraulic_node
