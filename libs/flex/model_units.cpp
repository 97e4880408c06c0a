// SPDX-License-Identifier: Apache-2.0
#include "flex/model_units.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "flex/input_error.h"

namespace slew::flex {

using math::Vec3;

namespace {

struct Units {
  double length, mass, time;  // m, kg, s
};
constexpr double kInch = 0.0254, kFoot = 0.3048, kPoundForce = 4.4482216152605;
constexpr Units kUnits[] = {{1, 1, 1},
                            {1e-3, 1e3, 1},
                            {1e-3, 1, 1e-3},
                            {1e-3, 1, 1},
                            {kInch, kPoundForce / kInch, 1},
                            {kFoot, kPoundForce / kFoot, 1}};

constexpr double kSlowest = 10, kFastest = 15000;        // m/s
constexpr double kShortest = 1e-3, kLongest = 1e3;       // m
constexpr double kLeastDense = 0.1, kMostDense = 25000;  // kg/m3
// nodes are on a line when none is farther from it than this share of its length
constexpr double kStraight = 1e-6;

Units units_of(ModelUnits units) {
  return kUnits[static_cast<std::size_t>(units)];
}

// Properties of a model in its own units.
struct Look {
  double length = 0, mass = 0, wave_speed = 0;
  double density = std::numeric_limits<double>::quiet_NaN();  // (3), for a line

  [[nodiscard]] Look in(const Units& u) const {
    return {length * u.length, mass * u.mass, wave_speed * u.length / u.time,
            density * u.mass / (u.length * u.length * u.length)};
  }
  [[nodiscard]] bool is_solid() const {
    const bool is_dense = std::isnan(density) || (kLeastDense <= density && density <= kMostDense);
    return kSlowest <= wave_speed && wave_speed <= kFastest && kShortest <= length && length <= kLongest && is_dense;
  }
  [[nodiscard]] std::string text() const {
    std::string line =
        fmt::format("{:.4g} kg, {:.4g} m long, a wave speed sqrt(E/rho) of {:.4g} m/s", mass, length, wave_speed);
    if (!std::isnan(density)) line += fmt::format(", {:.3g} kg/m3 along the line", density);
    return line;
  }
};

// longest direction of the nodes; the two others across it
Eigen::Matrix3d directions_of(const FeModel& model, const Eigen::Vector3d& centre) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const FeNode& node : model.nodes) {
    const Eigen::Vector3d r = Eigen::Vector3d(node.position[0], node.position[1], node.position[2]) - centre;
    sum += r * r.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors();
}

double energy(const SparseMatrix& A, const Eigen::VectorXd& u) {
  const Eigen::VectorXd Au = A * u;
  double sum = 0;
  for (int i = 0; i < u.size(); ++i) sum += u[i] * Au[i];
  return sum;
}

Look look_at(const FeModel& model) {
  const RigidMass rigid = rigid_mass(model);
  const Vec3 c = centre_of(rigid);
  const Eigen::Vector3d centre(c[0], c[1], c[2]);
  const Eigen::Matrix3d axes = directions_of(model, centre);
  const Eigen::Vector3d a = axes.col(2);
  double low = std::numeric_limits<double>::infinity(), high = -low, across = 0;
  bool has_rotations = true;
  Eigen::VectorXd stretch = Eigen::VectorXd::Zero(model.freedoms()), bend[2] = {stretch, stretch};
  for (const FeNode& node : model.nodes) {
    const Eigen::Vector3d r = Eigen::Vector3d(node.position[0], node.position[1], node.position[2]) - centre;
    const double s = a.dot(r);
    low = std::min(low, s);
    high = std::max(high, s);
    across = std::max(across, (r - a * s).norm());
    has_rotations = has_rotations && node.freedoms == 6;
    stretch.segment<3>(node.first) = a * s;
    if (node.freedoms < 6) continue;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d n = axes.col(k);
      bend[k].segment<3>(node.first) = n * (0.5 * s * s);
      bend[k].segment<3>(node.first + 3) = a.cross(n) * s;
    }
  }
  Look look;
  look.length = high - low;
  look.mass = rigid.mass;
  const double stretching = energy(model.K, stretch), moving = energy(model.M, stretch);
  look.wave_speed = look.length * std::sqrt(stretching / moving / 12);
  if (!has_rotations || across > kStraight * look.length) return look;
  const double bending = std::sqrt(energy(model.K, bend[0]) * energy(model.K, bend[1]));
  look.density = look.mass / (12 * look.length * bending / stretching);
  return look;
}

}  // namespace

void to_si(ModelUnits units, FeModel& model) {
  const Units u = units_of(units);
  if (units == ModelUnits::m_kg_s) return;
  Eigen::VectorXd d(model.freedoms());
  for (FeNode& node : model.nodes) {
    node.position = node.position * u.length;
    for (int a = 0; a < node.freedoms; ++a) d[node.first + a] = a < 3 ? 1 : u.length;
  }
  const auto scale = [&d](SparseMatrix& A, double factor) {
    for (int j = 0; j < A.outerSize(); ++j) {
      for (SparseMatrix::InnerIterator it(A, j); it; ++it) it.valueRef() *= factor * d[it.row()] * d[j];
    }
  };
  scale(model.M, u.mass);
  scale(model.K, u.mass / (u.time * u.time));
}

void judge_units(const FeModel& model, ModelUnits stated) {
  const Look look = look_at(model);
  if (look.is_solid()) return;
  // in the original units of the matrices, for any stated units
  const Units taken = units_of(stated);
  const Look raw = look.in({1 / taken.length, 1 / taken.mass, 1 / taken.time});
  std::string fits;
  for (std::size_t k = 0; k < std::size(kUnits); ++k) {
    const Look as = raw.in(kUnits[k]);
    if (as.is_solid()) fits += fmt::format("{}units: {} ({})", fits.empty() ? "" : "; ", kUnitNames[k], as.text());
  }
  throw InputError(fmt::format(
      "{}: in {} this is no solid: {}; expected {} to {} m/s, {} m to {} m{}; {}", model.name,
      kUnitNames[static_cast<std::size_t>(stated)], look.text(), kSlowest, kFastest, kShortest, kLongest,
      std::isnan(look.density) ? "" : fmt::format(", {} to {} kg/m3", kLeastDense, kMostDense),
      fits.empty() ? "set `units:` of the matrices beside their files, or export them in m, kg, s" : "set " + fits));
}

}  // namespace slew::flex
