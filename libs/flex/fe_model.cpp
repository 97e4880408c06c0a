// SPDX-License-Identifier: Apache-2.0
#include "flex/fe_model.h"

#include <fmt/format.h>

#include "flex/input_error.h"

namespace slew::flex {

using math::Mat3;
using math::Vec3;

std::size_t find_node(const FeModel& model, int id, const std::string& key) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    if (model.nodes[i].id == id) return i;
  }
  throw InputError(fmt::format("{}.{}: there is no node {}; expected one of its {} nodes, {} to {}", model.name, key,
                               id, model.nodes.size(), model.nodes.front().id, model.nodes.back().id));
}

double extent(const FeModel& model) {
  double size = 0;
  for (const FeNode& node : model.nodes) size = std::max(size, norm(node.position - model.nodes.front().position));
  return size;
}

Eigen::Matrix<double, Eigen::Dynamic, 6> rigid_motions(const FeModel& model, Vec3 point) {
  Eigen::Matrix<double, Eigen::Dynamic, 6> R(model.freedoms(), 6);
  R.setZero();
  for (const FeNode& node : model.nodes) {
    // u = t + w x r = t - r~ w
    const Mat3 turning = math::skew(point - node.position);
    for (int a = 0; a < 3; ++a) {
      R(node.first + a, a) = 1;
      for (int b = 0; b < 3; ++b) R(node.first + a, 3 + b) = turning(a, b);
      if (node.freedoms == 6) R(node.first + 3 + a, 3 + a) = 1;
    }
  }
  return R;
}

RigidMass rigid_mass(const FeModel& model) {
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model);
  const Eigen::Matrix<double, Eigen::Dynamic, 6> MR = model.M * R;
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (int row = 0; row < model.freedoms(); ++row) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) sum(i, j) += R(row, i) * MR(row, j);
    }
  }
  RigidMass out;
  out.mass = (sum(0, 0) + sum(1, 1) + sum(2, 2)) / 3;
  // upper right block: -s0~
  out.first = Vec3(sum(1, 5) - sum(2, 4), sum(2, 3) - sum(0, 5), sum(0, 4) - sum(1, 3)) * 0.5;
  Mat3 inertia;
  for (int j = 0; j < 3; ++j) {
    inertia.c[j] = Vec3(0.5 * (sum(3, 3 + j) + sum(3 + j, 3)), 0.5 * (sum(4, 3 + j) + sum(3 + j, 4)),
                        0.5 * (sum(5, 3 + j) + sum(3 + j, 5)));
  }
  out.second = second_moment_of(inertia);
  return out;
}

Mat3 inertia_of(const Mat3& second_moment) noexcept {
  const double trace = second_moment(0, 0) + second_moment(1, 1) + second_moment(2, 2);
  return Mat3::diagonal(trace, trace, trace) - second_moment;
}

Mat3 second_moment_of(const Mat3& inertia) noexcept {
  const double half = (inertia(0, 0) + inertia(1, 1) + inertia(2, 2)) / 2;
  return Mat3::diagonal(half, half, half) - inertia;
}

math::Vec3 centre_of(const RigidMass& mass) noexcept {
  return mass.first * (1 / mass.mass);
}

math::Mat3 central_inertia(const RigidMass& mass) noexcept {
  const math::Vec3 c = centre_of(mass);
  return inertia_of(mass.second - outer(c, c) * mass.mass);
}

}  // namespace slew::flex
