// SPDX-License-Identifier: Apache-2.0
// A second formulation of the same equations, for agreement tests: Jacobians of every mass assembled into M u' + h = Q
// in long double, velocity terms by differentiating the Jacobians numerically along the motion. It starts from the
// Def and shares no dynamics code with the library.
#pragma once

#include <string>
#include <vector>

#include "multibody/flexible/expand_nodes.h"
#include "multibody/model/defs.h"
#include "multibody/model/model.h"
#include "tests/properties/multibody/random_modes.h"
#include "tests/properties/multibody/reference_space.h"
#include "tests/support/reference_algebra.h"

namespace slew::multibody::testing {

using slew::testing::difference;
using slew::testing::Index;
using slew::testing::to_vector;
using Vector = slew::testing::Dense<Real>;
using Matrix = slew::testing::Dense<Real>;

struct BodyMotion {
  Matrix3 R = Matrix3::identity();
  Vector3 p;
  Columns Jw, Jp;  // angular velocity and velocity of the origin per u
};

class Assembled {
 public:
  // model: only where each joint's coordinates lie in q and u is taken from it
  // points: mass points of the flexible bodies
  Assembled(const MechanicsDef& def, const Model& model, MassPoints points = {})
      : def_(def.flexible_bodies.empty() ? def : with_nodes(def)), model_(model), points_(std::move(points)) {}

  [[nodiscard]] std::vector<BodyMotion> motion(const Vector& q) const;
  [[nodiscard]] Vector coordinate_rates(const Vector& q, const Vector& u) const;

  [[nodiscard]] Matrix mass_matrix(const Vector& q) const;
  // M u' = forces(q, u) with row forces zero
  [[nodiscard]] Vector forces(const Vector& q, const Vector& u) const;
  [[nodiscard]] Vector accelerations(const Vector& q, const Vector& u) const;

  // coordinate of a row and its Jacobian, both from the Def's geometry
  [[nodiscard]] Real row_value(const std::string& row, const Vector& q) const;
  [[nodiscard]] Vector row_jacobian(const std::string& row, const Vector& q) const;
  [[nodiscard]] Real row_bias(const std::string& row, const Vector& q, const Vector& u) const;

  // what joint j of the Def, one that is cut, must keep; its Jacobian; J' u
  [[nodiscard]] Vector cut_values(std::size_t j, const Vector& q) const;
  [[nodiscard]] Matrix cut_jacobian(std::size_t j, const Vector& q) const;
  [[nodiscard]] Vector cut_bias(std::size_t j, const Vector& q, const Vector& u) const;

  [[nodiscard]] Real potential(const Vector& q) const;  // gravity and modes

 private:
  // one moving mass: m J_v^T J_v, with rotational inertia about it as J_w^T I J_w
  struct Mass {
    Real mass = 0;
    Matrix3 inertia;
    Columns Jv, Jw;
    Vector3 center;
  };
  [[nodiscard]] std::vector<Mass> masses(const Vector& q) const;
  void add_force_dummies(const std::vector<BodyMotion>& bodies, std::vector<Mass>& list) const;
  [[nodiscard]] const BodyMotion& body(const std::vector<BodyMotion>& bodies, const std::string& name) const;
  [[nodiscard]] Vector element_forces(const Vector& q, const Vector& u) const;

  void place_node(const JointDef& joint, const BodyMotion& frame, const Vector& q, BodyMotion& node) const;
  void add_points(const std::vector<BodyMotion>& bodies, const Vector& q, std::vector<Mass>& list) const;
  [[nodiscard]] const FlexiblePart& part_of(const std::string& body) const;

  const MechanicsDef def_;
  const Model& model_;
  MassPoints points_;
};

// Derivative at 0 of a smooth function of one variable, to about 1e-14: central differences of order 8.
template <typename Function>
auto derivative_at_zero(const Function& f) {
  constexpr Real h = 2e-3L;
  using Value = decltype(f(h));
  const Value d1 = f(h) - f(-h);
  const Value d2 = f(2 * h) - f(-2 * h);
  const Value d3 = f(3 * h) - f(-3 * h);
  const Value d4 = f(4 * h) - f(-4 * h);
  const Value sum = d1 * (4.0L / 5) - d2 * (1.0L / 5) + d3 * (4.0L / 105) - d4 * (1.0L / 280);
  return Value(sum / h);
}

}  // namespace slew::multibody::testing
