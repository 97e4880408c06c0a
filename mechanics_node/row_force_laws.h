// SPDX-License-Identifier: Apache-2.0
// The force laws of the mechanism's rows, for the port problem: line force of an actuator, friction and limits of a
// joint with the memory of its friction.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "coupling/line_force.h"
#include "coupling/port_dynamics.h"
#include "coupling/port_unit.h"
#include "mechanics_node/mechanism.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics_node {

// An actuator as the mechanics compute it.
struct Port {
  std::string name;
  double offset = 0, ratio = 1;  // stroke x = offset + ratio * coordinate of the row [m, m or m/rad]
  coupling::LineForceLaw law;
  double z = 0;         // pressure force, the mechanics' copy, without its damping -D (v - v_ref) [N]
  double F = 0;         // pressure force with damping [N]
  double friction = 0;  // at the published instant [N]
  double stop = 0;      // at the published instant [N]
  coupling::PortUnit unit = coupling::PortUnit::metre;

  [[nodiscard]] double stroke(double row_x) const noexcept { return offset + ratio * row_x; }
};

class RowForceLaws final : public coupling::RowLaws {
 public:
  // ports: laws of the first rows. active: row of each law. All three outlive this. Bends the mechanism's bristles.
  RowForceLaws(Mechanism& mechanism, const std::vector<Port>& ports, const std::vector<std::size_t>& active);

  bool begin(double h) noexcept override;
  void set_interval(double h) noexcept override { interval_ = h; }
  void keep() noexcept override;
  void go_back() noexcept override;
  void carry(std::size_t index, double v, double h) noexcept override;
  [[nodiscard]] bool is_at_stop(std::size_t index, double x) const noexcept override;
  [[nodiscard]] coupling::RowForce evaluate(std::size_t index, double z, double x, double v) const noexcept override;
  void evaluate_all(std::size_t rows, const double* z, const double* x, const double* v,
                    coupling::RowForce* force) const noexcept override;

 private:
  // Speed of a ball in the stage before [rad/s].
  [[nodiscard]] double ball_speed(std::size_t row) const noexcept;

  Mechanism& mechanism_;
  const std::vector<Port>& ports_;
  const std::vector<std::size_t>& active_;
  bool has_memory_;                  // a row of the mechanism has one
  double interval_ = 0;              // length of the present stage [s]
  std::vector<double> stage_speed_;  // by row, in the stage before
  double held_speed_ = 0;            // speed of the ball whose parts are carried [rad/s]
  std::vector<double> kept_bristles_, kept_speed_;
};

// The innermost call of the port problem's iteration, in line.

inline double RowForceLaws::ball_speed(std::size_t row) const noexcept {
  return multibody::ball_speed(mechanism_.model(), row, stage_speed_);
}

inline coupling::RowForce RowForceLaws::evaluate(std::size_t index, double z, double x, double v) const noexcept {
  const std::size_t row = active_[index];
  if (row < ports_.size()) {
    const coupling::LineForce line = ports_[row].law.evaluate(z, x, v);
    return {line.force, line.d_pressure, line.d_position, line.d_speed, line.stop};
  }
  const multibody::JointLaw& law = multibody::law_of(mechanism_.model(), row);
  const double bending = mechanism_.bristle_of(row);
  const multibody::JointForce joint = mechanism_.is_ball(row)
                                          ? multibody::evaluate_part(law, v, ball_speed(row), interval_, bending)
                                          : multibody::evaluate(law, x, v, interval_, bending);
  return {joint.force, 0, joint.d_x, joint.d_v, joint.limit};
}

}  // namespace slew::mechanics_node
