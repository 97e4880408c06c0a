// SPDX-License-Identifier: Apache-2.0
// Blocks of links in the saddle-point matrix of body coordinates, beside the rows of their joints. Internal to the
// library.
#pragma once

#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/link_matrix.h"

namespace slew::multibody {

class BodyMatrix final : public LinkMatrix {
 public:
  BodyMatrix(const BodyModel& body, math::BlockLdl& ldl) noexcept : body_(body), ldl_(ldl) {}
  void add(int row_link, int column_link, const SpatialBlock& block) noexcept override;

 private:
  const BodyModel& body_;
  math::BlockLdl& ldl_;
};

}  // namespace slew::multibody
