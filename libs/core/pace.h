// SPDX-License-Identifier: Apache-2.0
// Pace of a session's ticks, in its scene and in its description on the wire.
#pragma once

namespace slew {

enum class Pace : int {
  real,  // paced by the wall clock
  free   // as fast as possible
};

}  // namespace slew
