// The strip of the extremes: a steel bar of 1 m and 10 mm x 10 mm along x, so slender that shear and stretch are below
// 1e-4 of bending, clamped at its root; by modes that bend along y, or by segments.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "multibody/passes.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/segmented_def.h"
#include "tests/validation/flexible/slender_beam.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/extremes/outcome.h"

namespace slew::multibody::testing {

inline constexpr double kSide = 0.01, kDensity = 7850, kSteel = 2.1e11;

inline flex::BeamDef strip(double youngs_modulus = kSteel) {
  return flex::testing::straight(flex::testing::square(kSide), flex::testing::steel(youngs_modulus, kDensity),
                                 {1, 0, 0}, 21);
}

inline slew::testing::SlenderBeam slender(double youngs_modulus = kSteel) {
  return {.EI = youngs_modulus * std::pow(kSide, 4) / 12, .rho_A = kDensity * kSide * kSide};
}

// ordinals of the lowest `count` modes that bend along y or z alone
inline std::vector<int> bending(const ModalBody& all, int direction, int count) {
  std::vector<int> kept;
  for (std::size_t k = 0; k < all.modes() && static_cast<int>(kept.size()) < count; ++k) {
    const math::Vec3 shift = all.nodes.back().shift[k];
    if (std::abs(shift[direction]) > 0.9 * norm(shift)) kept.push_back(static_cast<int>(k) + 1);
  }
  return kept;
}

inline std::shared_ptr<const ModalBody> strip_modes(
    int count, flex::GeometricStiffening stiffening = flex::GeometricStiffening::straight_beam,
    double youngs_modulus = kSteel) {
  flex::ReductionDef reduction = flex::testing::with_modes(24);
  reduction.stiffening = stiffening;
  const auto all = slew::testing::modes_of(strip(youngs_modulus), reduction, {});
  return slew::testing::modes_of(strip(youngs_modulus), reduction, bending(*all, 1, count));
}

// clamped to Ground, without gravity; q: start of the first mode
inline MechanicsDef clamped_strip(std::shared_ptr<const ModalBody> modes, double q = 0) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Strip", .type = BodyType::flexible}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Strip"}};
  def.flexible_bodies = {{.body = "Strip", .modes = std::move(modes)}};
  std::vector<double>& start = def.flexible_bodies[0].start;
  start.assign(def.flexible_bodies[0].modes->modes(), 0.0);
  start.front() = q;
  def.max_substep = 1e-5;
  return def;
}

inline MechanicsDef clamped_segments(int segments, double youngs_modulus = kSteel) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Strip", .type = BodyType::segmented}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Strip"}};
  def.segmented_bodies = {{.body = "Strip",
                           .chain = slew::testing::segments_of(strip(youngs_modulus), segments),
                           .start = SegmentStart::straight}};
  def.integrator = Integrator::trapezoidal;
  return def;
}

// Squares of small motion about the start [1/s2], ascending: accelerations that displacements cause.
inline std::vector<double> squares_of(const MechanicsDef& def) {
  constexpr double kProbe = 1e-6;
  const Model model = build_model(def);
  Workspace ws(model);
  const State start = start_state(model);
  const auto n = static_cast<Eigen::Index>(start.u.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  const std::vector<double> rest(start.u.size());
  std::vector<double> rate(start.q.size());
  for (Eigen::Index j = 0; j < n; ++j) {
    for (const double sign : {1.0, -1.0}) {
      State moved = start;
      moved.u[static_cast<std::size_t>(j)] = 1;
      update_motion(model, moved.q, moved.u, ws);
      coordinate_rates(model, ws, moved.q, moved.u, rate);
      for (std::size_t k = 0; k < rate.size(); ++k) moved.q[k] += sign * kProbe * rate[k];
      moved.u = rest;
      normalize_quaternions(model, moved.q);
      evaluate(model, moved, ws);
      for (Eigen::Index i = 0; i < n; ++i) A(i, j) -= sign * ws.udot[static_cast<std::size_t>(i)] / (2 * kProbe);
    }
  }
  const Eigen::VectorXd real = A.eigenvalues().real();
  std::vector<double> squares(real.begin(), real.end());
  std::sort(squares.begin(), squares.end());
  return squares;
}

}  // namespace slew::multibody::testing
