// SPDX-License-Identifier: Apache-2.0
// Natural frequencies of bodies of finite segments. Internal to the library.
#pragma once

#include <cstddef>

#include "multibody/model/model.h"

namespace slew::multibody {

struct FastestSegments {
  double omega = 0;      // rad/s
  double decay = 0;      // 1/s, beta omega^2
  std::size_t part = 0;  // part with the largest motion, Model::segmented
};

// Largest frequency of the mechanism at its start with the segments' beams as its only springs: by power iteration with
// M^-1 K as differences of accelerations.
[[nodiscard]] FastestSegments fastest_segments(const Model& model);

}  // namespace slew::multibody
