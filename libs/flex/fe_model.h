// SPDX-License-Identifier: Apache-2.0
// A linear finite element model: nodes, mass and stiffness, and optional data beyond the two matrices.
//
// All vectors and freedoms are in the axes of the body frame. A node has three translations, or these and three
// rotations; its rows follow each other: ux uy uz [rx ry rz]. The internal freedoms of beam elements (beam_element.h)
// come behind those of the nodes; rigid motions leave them zero.
// Beams of this program have their mass as samples: M = sum w N^T N, and every integral of rho over the solid is a sum
// over the same samples, so that all integrals are consistent with M. Imported matrices have M only.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "flex/beam_element.h"
#include "math/vector3.h"

namespace slew::flex {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct FeNode {
  int id = 0;
  math::Vec3 position;  // m, undeformed
  int first = 0;        // row of ux
  int freedoms = 6;     // 3 or 6
};

// A share of the mass at a point of the reference configuration, or the second moment of a section about its axis.
struct MassSample {
  double weight = 0;         // w: kg, > 0; for an offset kg m2
  bool is_offset = false;    // true: position and N are per metre away from the axis, and linear integrals vanish
  math::Vec3 position;       // m; for an offset a unit vector
  ElementFreedoms freedoms;  // rows of the model that move it, -1: none
  Matrix3xElement N;         // displacement of the point per freedom
};

struct FeModel {
  std::string name;
  std::string made_of;  // one line for files and reports
  std::vector<FeNode> nodes;
  SparseMatrix M;  // kg, kg m, kg m2
  SparseMatrix K;  // N/m, N, N m
  // columns: preferred directions for modes that share a frequency; for a beam its first section's x, y, z
  math::Mat3 axes = math::Mat3::identity();
  std::vector<MassSample> samples;    // empty: imported
  std::vector<BeamElement> elements;  // empty: imported

  [[nodiscard]] int freedoms() const noexcept { return static_cast<int>(M.rows()); }
  [[nodiscard]] bool is_beam() const noexcept { return !elements.empty(); }
};

// Index of the node with the id. Throws InputError that names the requesting key.
[[nodiscard]] std::size_t find_node(const FeModel& model, int id, const std::string& key);

// m; distance of the farthest node from the first one
[[nodiscard]] double extent(const FeModel& model);

// freedoms x 6: displacements of the model moved as a rigid body, along x, y, z and about x, y, z of the body frame
// through the point.
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, 6> rigid_motions(const FeModel& model, math::Vec3 point = {});

// Sums over the solid, about the body frame's origin.
struct RigidMass {
  double mass = 0;    // kg
  math::Vec3 first;   // s0 = integral rho x [kg m]
  math::Mat3 second;  // W0 = integral rho x x^T [kg m2]
};

// From R^T M R with the rigid motions R, by the matrices alone.
[[nodiscard]] RigidMass rigid_mass(const FeModel& model);

[[nodiscard]] math::Vec3 centre_of(const RigidMass& mass) noexcept;        // m
[[nodiscard]] math::Mat3 central_inertia(const RigidMass& mass) noexcept;  // about it [kg m2]

// Tensor of inertia tr(W) 1 - W of a second moment W, and back.
[[nodiscard]] math::Mat3 inertia_of(const math::Mat3& second_moment) noexcept;
[[nodiscard]] math::Mat3 second_moment_of(const math::Mat3& inertia) noexcept;

}  // namespace slew::flex
