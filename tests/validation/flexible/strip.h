// SPDX-License-Identifier: Apache-2.0
// The strip of the extremes: a steel bar of 1 m and 10 mm x 10 mm along x, so slender that shear and stretch are below
// 1e-4 of bending, clamped at its root; by modes that bend along y, or by segments.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "multibody/formulations/passes.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/segmented_def.h"
#include "tests/validation/flexible/slender_beam.h"
#include "tests/validation/flexible/small_motion.h"
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

}  // namespace slew::multibody::testing
