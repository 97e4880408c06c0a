// The mechanics' state as bytes: what is integrated, and what a step takes over from the one before.
#include "coupling/saved_model.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "mechanics_node/parameter_handle.h"

namespace slew::mechanics {
namespace {

constexpr std::uint32_t kLayout = 2;
constexpr std::size_t kFrameNumbers = 13;  // of a flexible body in its sample

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
    multibody::load(self.model_, self.state_, bytes);
    self.mechanism_.load(bytes);
    self.ramps_.load(bytes, [&](int handle) { return multibody::has_parameter(self.model_, parameter_of(handle)); });
    self.levels_.load(bytes);
    self.a_free_trends_.load(bytes);
    if (self.is_free_running_) self.past_.load(bytes);
  } else {
    multibody::save(self.model_, self.state_, bytes);
    self.mechanism_.save(bytes);
    self.ramps_.save(bytes);
    self.levels_.save(bytes);
    self.a_free_trends_.save(bytes);
    if (self.is_free_running_) self.past_.save(bytes);
  }
  for (auto& operated : self.operated_) bytes.number(self.model_.elements.loads[operated.load].signal);
  bytes.number(self.used_step_);
  bytes.number(self.partner_age_);
  for (auto& port : self.ports_) {
    for (auto* x : {&port.z, &port.F, &port.friction, &port.stop}) bytes.number(*x);
  }
  for (auto& is_active : self.row_is_active_) bytes.flag(is_active);
  bytes.numbers(self.row_force_);
  DivergenceWatch::visit(self.divergence_, bytes);
  bytes.flag(self.has_failed_);
  visit_report(bytes, self.failure_);
  visit_sample(self.published_.mechanism, self.ports_.size(), bytes);
  auto& flexible = self.published_.flexible;
  visit_sized(bytes, flexible.q, self.modal_.mode_count());
  visit_sized(bytes, flexible.u, self.modal_.mode_count());
  visit_sized(bytes, flexible.frame, kFrameNumbers * self.modal_.body_count());
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
  return Status::ok();
}

// What follows from the state, as the end of a step leaves it.
void MechanicsSubsystem::show_loaded() noexcept {
  heavier_ = model_;
  multibody::copy_state(state_, last_good_);
  for (std::size_t row = 0; row < row_is_active_.size(); ++row) {
    if (row_is_active_[row] != 0) {
      multibody::activate_row(workspace_, static_cast<int>(row));
    } else {
      multibody::deactivate_row(workspace_, static_cast<int>(row));
    }
  }
  is_evaluated_ = false;
  evaluate();
  multibody::observe(model_, state_, workspace_);
  // angles of body coordinates are read off the motion, and continued from those that were there
  multibody::copy_state(last_good_, state_);
}

}  // namespace slew::mechanics
