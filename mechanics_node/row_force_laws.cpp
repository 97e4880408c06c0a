// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/row_force_laws.h"

namespace slew::mechanics_node {
namespace {

bool has_memory(const Mechanism& mechanism) noexcept {
  for (std::size_t row = 0; row < mechanism.row_count(); ++row) {
    if (mechanism.is_ball(row)) return true;
  }
  return !mechanism.state().bristles.empty();
}

}  // namespace

RowForceLaws::RowForceLaws(Mechanism& mechanism, const std::vector<Port>& ports, const std::vector<std::size_t>& active)
    : mechanism_(mechanism),
      ports_(ports),
      active_(active),
      has_memory_(has_memory(mechanism)),
      stage_speed_(mechanism.row_count()),
      kept_bristles_(mechanism.state().bristles),
      kept_speed_(mechanism.row_count()) {}

bool RowForceLaws::begin(double h) noexcept {
  interval_ = h;
  stage_speed_ = mechanism_.workspace().row_v;
  return has_memory_;
}

void RowForceLaws::keep() noexcept {
  kept_bristles_ = mechanism_.state().bristles;
  kept_speed_ = stage_speed_;
}

void RowForceLaws::go_back() noexcept {
  mechanism_.state_as_evaluated().bristles = kept_bristles_;
  stage_speed_ = kept_speed_;
}

void RowForceLaws::carry(std::size_t index, double v, double h) noexcept {
  const std::size_t row = active_[index];
  if (row < ports_.size()) return;
  const multibody::JointLaw& law = multibody::law_of(mechanism_.model(), row);
  const bool is_ball = mechanism_.is_ball(row);
  // the three parts of a ball come one after the other, with the speed that the first one found
  if (is_ball && mechanism_.model().rows[row].number == 0) held_speed_ = ball_speed(row);
  if (multibody::has_bristles(law)) {
    double& z = mechanism_.state_as_evaluated().bristles[row];
    z = is_ball ? multibody::bent_part(law, v, held_speed_, h, z) : multibody::bent(law, v, h, z);
  }
  stage_speed_[row] = v;
}

bool RowForceLaws::is_at_stop(std::size_t index, double x) const noexcept {
  const std::size_t row = active_[index];
  return row < ports_.size() ? ports_[row].law.touches_stop(x)
                             : multibody::touches_limit(mechanism_.model().rows[row].law, x);
}

void RowForceLaws::evaluate_all(std::size_t rows, const double* z, const double* x, const double* v,
                                coupling::RowForce* force) const noexcept {
  for (std::size_t i = 0; i < rows; ++i) force[i] = RowForceLaws::evaluate(i, z[i], x[i], v[i]);
}

}  // namespace slew::mechanics_node
