// SPDX-License-Identifier: Apache-2.0
#include "flex/mode_order.h"

#include <algorithm>
#include <cmath>

#include "flex/decompositions.h"

namespace slew::flex {

using Eigen::MatrixXd;
using math::Vec3;

namespace {

// relative distance below which two w^2 are one frequency, to rounding
constexpr double kRepeated = 2e-8;
// translations below this share of rotation times size are rounding
constexpr double kNoTranslation = 1e-9;
// components this close to the largest one count as equal: the first node's is taken
constexpr double kEqual = 1e-6;

Vec3 translation(const FeNode& node, const MatrixXd& Phi, Eigen::Index mode) {
  return {Phi(node.first, mode), Phi(node.first + 1, mode), Phi(node.first + 2, mode)};
}

double preference(const FeModel& model, const MatrixXd& Phi, Eigen::Index a, Eigen::Index b) {
  double sum = 0;
  for (const FeNode& node : model.nodes) {
    const Vec3 u = transpose_multiply(model.axes, translation(node, Phi, a));
    const Vec3 v = transpose_multiply(model.axes, translation(node, Phi, b));
    sum += (u[0] * v[0] + 3 * (u[1] * v[1])) + 2 * (u[2] * v[2]);
  }
  return sum;
}

void turn_group(const FeModel& model, MatrixXd& Phi, Eigen::Index first, Eigen::Index count) {
  MatrixXd Q(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) Q(i, j) = Q(j, i) = preference(model, Phi, first + i, first + j);
  }
  const MatrixXd turned = Phi.middleCols(first, count) * descending_modes(Q).vectors;
  Phi.middleCols(first, count) = turned;
}

// the sign of the first of the largest values in the rows offset to offset + 2 of every node
double sign_of_largest(const FeModel& model, const MatrixXd& Phi, Eigen::Index mode, int offset, double largest) {
  for (const FeNode& node : model.nodes) {
    for (int a = offset; a < std::min(offset + 3, node.freedoms); ++a) {
      const double value = Phi(node.first + a, mode);
      if (std::abs(value) >= (1 - kEqual) * largest) return value < 0 ? -1 : 1;
    }
  }
  return 1;
}

double largest_in(const FeModel& model, const MatrixXd& Phi, Eigen::Index mode, int offset) {
  double largest = 0;
  for (const FeNode& node : model.nodes) {
    for (int a = offset; a < std::min(offset + 3, node.freedoms); ++a)
      largest = std::max(largest, std::abs(Phi(node.first + a, mode)));
  }
  return largest;
}

}  // namespace

void separate_repeated(const FeModel& model, std::vector<double>& lambda, MatrixXd& Phi) {
  for (std::size_t first = 0; first < lambda.size();) {
    std::size_t end = first + 1;
    while (end < lambda.size() && lambda[end] - lambda[end - 1] <= kRepeated * std::abs(lambda[end])) ++end;
    if (end - first > 1) {
      turn_group(model, Phi, static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(end - first));
      double mean = 0;
      for (std::size_t i = first; i < end; ++i) mean += lambda[i];
      mean /= static_cast<double>(end - first);
      for (std::size_t i = first; i < end; ++i) lambda[i] = mean;
    }
    first = end;
  }
}

void choose_signs(const FeModel& model, MatrixXd& Phi) {
  const double size = extent(model);
  for (Eigen::Index mode = 0; mode < Phi.cols(); ++mode) {
    const double moved = largest_in(model, Phi, mode, 0), turned = largest_in(model, Phi, mode, 3);
    const bool is_turning = moved < kNoTranslation * turned * size;
    const double sign =
        is_turning ? sign_of_largest(model, Phi, mode, 3, turned) : sign_of_largest(model, Phi, mode, 0, moved);
    Phi.col(mode) *= sign;
  }
}

}  // namespace slew::flex
