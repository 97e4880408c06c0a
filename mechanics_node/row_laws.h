// The laws of the mechanics' rows, as the port problem asks for them: line force of a cylinder, friction and limits of
// a joint. Internal to the library.
#pragma once

#include "mechanics_node/mechanics_subsystem.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics {

class MechanicsSubsystem::Laws final : public coupling::RowLaws {
 public:
  explicit Laws(MechanicsSubsystem& owner)
      : owner_(owner), kept_bristles_(owner.state_.bristles), kept_speed_(owner.model_.rows.size()) {}
  bool begin(double h) const noexcept override {
    owner_.bristle_interval_ = h;
    owner_.stage_speed_ = owner_.workspace_.row_v;
    return owner_.has_balls_ || !owner_.state_.bristles.empty();
  }
  void set_interval(double h) const noexcept override { owner_.bristle_interval_ = h; }
  void keep() const noexcept override {
    kept_bristles_ = owner_.state_.bristles;
    kept_speed_ = owner_.stage_speed_;
  }
  void go_back() const noexcept override {
    owner_.state_.bristles = kept_bristles_;
    owner_.stage_speed_ = kept_speed_;
  }
  bool is_at_stop(std::size_t index, double x) const noexcept override {
    const std::size_t row = owner_.active_[index];
    return row < owner_.ports_.size() ? owner_.ports_[row].law.touches_stop(x)
                                      : multibody::touches_limit(owner_.model_.rows[row].law, x);
  }
  void carry(std::size_t index, double v, double h) const noexcept override {
    const std::size_t row = owner_.active_[index];
    if (row < owner_.ports_.size()) return;
    const multibody::JointLaw& law = multibody::law_of(owner_.model_, row);
    const bool is_ball = owner_.is_ball(row);
    // the three parts of a ball come one after the other
    if (is_ball && owner_.model_.rows[row].number == 0) held_speed_ = speed_of(row);
    if (multibody::has_bristles(law)) {
      double& z = owner_.state_.bristles[row];
      z = is_ball ? multibody::bent_part(law, v, held_speed_, h, z) : multibody::bent(law, v, h, z);
    }
    owner_.stage_speed_[row] = v;
  }
  coupling::RowForce evaluate(std::size_t index, double z, double x, double v) const noexcept override {
    const std::size_t row = owner_.active_[index];
    if (row < owner_.ports_.size()) {
      const coupling::LineForce line = owner_.ports_[row].law.evaluate(z, x, v);
      return {line.force, line.d_pressure, line.d_position, line.d_speed, line.stop};
    }
    const multibody::JointLaw& law = multibody::law_of(owner_.model_, row);
    const double h = owner_.bristle_interval_, bending = owner_.bristle_of(row);
    const multibody::JointForce joint = owner_.is_ball(row)
                                            ? multibody::evaluate_part(law, v, speed_of(row), h, bending)
                                            : multibody::evaluate(law, x, v, h, bending);
    return {joint.force, 0, joint.d_x, joint.d_v, joint.limit};
  }
  void evaluate_all(std::size_t rows, const double* z, const double* x, const double* v,
                    coupling::RowForce* force) const noexcept override {
    for (std::size_t i = 0; i < rows; ++i) force[i] = Laws::evaluate(i, z[i], x[i], v[i]);
  }

 private:
  // of a ball, in the stage before
  [[nodiscard]] double speed_of(std::size_t row) const noexcept {
    return multibody::ball_speed(owner_.model_, row, owner_.stage_speed_);
  }

  MechanicsSubsystem& owner_;
  mutable double held_speed_ = 0;  // rad/s, of the ball whose parts are carried
  mutable std::vector<double> kept_bristles_, kept_speed_;
};

}  // namespace slew::mechanics
