// SPDX-License-Identifier: Apache-2.0
// The mechanics' state as bytes: what is integrated, and what a step takes over from the step before.
#include "coupling/saved_model.h"
#include "mechanics_node/mechanics_subsystem.h"

namespace slew::mechanics_node {
namespace {

constexpr std::uint32_t kLayout = 2;
constexpr std::size_t kFrameNumbers = 13;  // per flexible body in its sample

template <typename Sample, typename Bytes>
void visit_sample(Sample& sample, std::size_t ports, Bytes& bytes) {
  for (auto* values : {&sample.x, &sample.v, &sample.a, &sample.a_free, &sample.F_used, &sample.F_line, &sample.work,
                       &sample.impulse, &sample.v_mean}) {
    visit_sized(bytes, *values, ports);
  }
  visit_sized(bytes, sample.W, ports * ports);
  bytes.choice(sample.W_kind, coupling::MobilityKind::step);
}

}  // namespace

template <typename Self, typename Bytes>
void MechanicsSubsystem::visit(Self& self, Bytes& bytes) {
  if constexpr (Bytes::kIsReading) {
    self.mechanism_.load(bytes);
    self.ramps_.load(bytes, [&](int handle) { return multibody::has_parameter(self.model(), parameter_of(handle)); });
    self.partner_.levels().load(bytes);
  } else {
    self.mechanism_.save(bytes);
    self.ramps_.save(bytes);
    self.partner_.levels().save(bytes);
  }
  PortProblem::visit_trends(self.port_problem_, bytes);
  PartnerForce::visit_past(self.partner_, bytes);
  Mechanism::visit_signals(self.mechanism_, bytes);
  PartnerForce::visit_age(self.partner_, bytes);
  PortProblem::visit_rows(self.port_problem_, bytes);
  bytes.numbers(std::span(self.row_force_));
  DivergenceWatch::visit(self.divergence_, bytes);
  bytes.flag(self.has_failed_);
  visit_report(bytes, self.failure_);
  visit_sample(self.published_.mechanism, self.port_problem_.ports().size(), bytes);
  auto& flexible = self.published_.flexible;
  visit_sized(bytes, flexible.q, self.modal_.mode_count());
  visit_sized(bytes, flexible.u, self.modal_.mode_count());
  visit_sized(bytes, flexible.frame, kFrameNumbers * self.modal_.body_count());
  // a scene without sensors has the states of versions before them
  if (self.sensed_bodies_.empty()) return;
  visit_sized(bytes, self.published_.poses.frame, coupling::kPoseNumbers * self.sensed_bodies_.size());
}

Status MechanicsSubsystem::can_save() const {
  return Status::ok();
}

void MechanicsSubsystem::save(std::vector<std::byte>& state) const {
  StateWriter bytes(state, {kLayout, saved_model_});
  visit(*this, bytes);
  bytes.finish();
}

Status MechanicsSubsystem::load(std::span<const std::byte> state, coupling::OwnSample& sample) {
  reset();
  StateReader bytes(state, {kLayout, saved_model_});
  visit(*this, bytes);
  if (Status status = bytes.finish("mechanics"); !status.is_ok()) {
    reset();
    return status;
  }
  show_loaded();
  sample = {};
  sample.mechanism = published_.mechanism;
  sample.flexible = published_.flexible;
  sample.poses = published_.poses;
  return Status::ok();
}

// Computes what follows from the state, as the end of a step leaves it.
void MechanicsSubsystem::show_loaded() noexcept {
  observing_->payload.copy(model());
  multibody::copy_state(state(), last_good_);
  mechanism_.evaluate();
  mechanism_.observe();
  // body coordinates give angles from the motion; those of the saved state are continued
  multibody::copy_state(last_good_, mechanism_.state_as_evaluated());
}

}  // namespace slew::mechanics_node
