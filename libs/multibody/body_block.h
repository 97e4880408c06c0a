// Blocks of two links in the saddle-point matrix of body coordinates. Internal to the library.
#pragma once

#include <array>

#include "multibody/body_passes.h"
#include "multibody/spatial_block.h"

namespace slew::multibody {

// Adds a block of two links to the blocks of the links' nodes, beside the rows of their joints.
void add_block(const BodyModel& body, math::BlockLdl& ldl, int row_link, int column_link,
               const SpatialBlock& block) noexcept;

// A matrix between points of two links, which may be one link or Ground: A[i][j] at (links[i], links[j]), s from their
// origins. A[1][0] is A[0][1] transposed.
struct PointPair {
  std::array<int, 2> links;
  std::array<math::Vec3, 2> s;  // m
  std::array<std::array<math::Mat3, 2>, 2> A;
};
void add_pair(const BodyModel& body, math::BlockLdl& ldl, const PointPair& pair) noexcept;

}  // namespace slew::multibody
