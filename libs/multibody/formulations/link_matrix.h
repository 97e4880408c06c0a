// SPDX-License-Identifier: Apache-2.0
// Symmetric matrices over the speeds of all links, filled block by block into any storage. Internal to the library.
#pragma once

#include "multibody/formulations/spatial_block.h"

namespace slew::multibody {

class LinkMatrix {
 public:
  virtual ~LinkMatrix() = default;
  // Ground has no rows: both links are at least 1, and for two links only the block with row > column is given.
  virtual void add(int row_link, int column_link, const SpatialBlock& block) noexcept = 0;
};

// Inertias of the links and of cylinders and pistons between them.
void add_masses(const Model& model, const Workspace& ws, LinkMatrix& matrix) noexcept;

// The part of a matrix between two points of the same or of two links, at s [m] from their origins.
void add_points(int link_a, math::Vec3 s_a, int link_b, math::Vec3 s_b, const math::Mat3& A,
                LinkMatrix& matrix) noexcept;

// A over the motion of link 2 against link 1, the point at P [m, Ground].
void add_relative(const Workspace& ws, int link1, int link2, math::Vec3 P, const RelativeMatrix& A,
                  LinkMatrix& matrix) noexcept;

}  // namespace slew::multibody
