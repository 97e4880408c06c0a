// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/published_mobility.h"

#include <algorithm>

#include "math/small_solve.h"
#include "multibody/constraints/rows.h"
#include "multibody/joints/joint_law.h"

namespace slew::mechanics_node {

PublishedMobility::PublishedMobility(const Mechanism& mechanism, RowMobility& rows, std::size_t ports,
                                     double exchange_interval)
    : mechanism_(mechanism),
      rows_(rows),
      exchange_interval_(exchange_interval),
      mean_(mechanism.row_count()),
      slope_(mechanism.row_count()),
      matrix_(mechanism.row_count() * mechanism.row_count()),
      right_(mechanism.row_count() * (ports + 1)) {
  joints_.reserve(mechanism.row_count());
}

void PublishedMobility::publish(const std::vector<Port>& ports, coupling::MechanismSample& sample,
                                std::span<double> row_force) noexcept {
  const std::size_t m = ports.size();
  const std::size_t row_count = mechanism_.row_count();
  const Rows rows = rows_.over_exchange();
  for (std::size_t i = 0; i < m; ++i) {
    sample.a_free[i] = ports[i].ratio * rows.a_free[i];
    for (std::size_t j = 0; j < m; ++j) {
      sample.W[i * m + j] = ports[i].ratio * rows.W[i * row_count + j] * ports[j].ratio;
    }
  }
  sample.W_kind = rows.kind;
  linearise_joints(m, row_force);
  if (joints_.empty() || m == 0) return;
  sample.W_kind = coupling::MobilityKind::step;
  if (solve_joints(rows, ports)) add_joints(rows, ports, sample);
}

void PublishedMobility::linearise_joints(std::size_t ports, std::span<double> row_force) noexcept {
  const multibody::Model& model = mechanism_.model();
  const multibody::Workspace& workspace = mechanism_.workspace();
  const double H = exchange_interval_;
  joints_.clear();
  for (std::size_t row = ports; row < model.rows.size(); ++row) {
    row_force[row] = 0;
    if (!mechanism_.is_row_active(row)) continue;
    const double v = workspace.row_v[row];
    // force now, and after H at the present speed: bristles bend over the interval
    const auto after = [&](double time) {
      return multibody::joint_force(model, row, workspace.row_x, workspace.row_v, time, mechanism_.bristle_of(row));
    };
    const multibody::JointForce law = after(0);
    const multibody::JointForce bent = multibody::has_bristles(multibody::law_of(model, row)) ? after(H) : law;
    row_force[row] = law.force;
    mean_[row] = 0.5 * (law.force + bent.force) + 0.5 * H * law.d_x * v;
    slope_[row] = std::max(0.0, -(bent.d_v + H * law.d_x));
    joints_.push_back(row);
  }
}

// (1): forces of the joints without line forces and, by column, for each port's line force, in right_.
bool PublishedMobility::solve_joints(const Rows& rows, const std::vector<Port>& ports) noexcept {
  const std::size_t m = ports.size(), r = joints_.size(), row_count = mechanism_.row_count();
  const std::size_t columns = m + 1;
  for (std::size_t a = 0; a < r; ++a) {
    const double HS = exchange_interval_ * slope_[joints_[a]];
    for (std::size_t b = 0; b < r; ++b) {
      matrix_[a * r + b] = (a == b ? 1.0 : 0.0) + HS * rows.W[joints_[a] * row_count + joints_[b]];
    }
    right_[a * columns] = mean_[joints_[a]] - HS * rows.a_free[joints_[a]];
    for (std::size_t i = 0; i < m; ++i) {
      right_[a * columns + 1 + i] = -HS * rows.W[joints_[a] * row_count + i] * ports[i].ratio;
    }
  }
  return math::solve_in_place(matrix_.data(), right_.data(), r, columns);
}

// (2)
void PublishedMobility::add_joints(const Rows& rows, const std::vector<Port>& ports,
                                   coupling::MechanismSample& sample) const noexcept {
  const std::size_t m = ports.size(), r = joints_.size(), row_count = mechanism_.row_count();
  const std::size_t columns = m + 1;
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t a = 0; a < r; ++a) {
      const double w = ports[i].ratio * rows.W[i * row_count + joints_[a]];
      sample.a_free[i] += w * right_[a * columns];
      for (std::size_t j = 0; j < m; ++j) sample.W[i * m + j] += w * right_[a * columns + 1 + j];
    }
  }
  // symmetric to the bit, as the partner may factorise it
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double mean = 0.5 * (sample.W[i * m + j] + sample.W[j * m + i]);
      sample.W[i * m + j] = sample.W[j * m + i] = mean;
    }
  }
}

}  // namespace slew::mechanics_node
