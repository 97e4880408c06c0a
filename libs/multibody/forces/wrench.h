// SPDX-License-Identifier: Apache-2.0
// What a force element does to a link: force and moment about the link's origin, Ground axes.
//
// Every kind of element in this folder is a pure function from the motions (pose and velocity) of the links it touches
// to its wrenches on them. Nothing is remembered between two calls, so that tangents may be taken one element at a time
// by differences.
#pragma once

#include "math/rotation.h"
#include "multibody/model/link_motion.h"

namespace slew::multibody {

struct Wrench {
  math::Vec3 f;  // N
  math::Vec3 n;  // N m
};

// On the two links of an element.
struct WrenchPair {
  Wrench on1, on2;
};

// A force at a point (Ground) of a link, with a moment of its own.
[[nodiscard]] inline Wrench wrench_at(math::Vec3 point, const LinkMotion& link, math::Vec3 force,
                                      math::Vec3 moment = math::Vec3()) noexcept {
  return {force, moment + cross(point - link.p, force)};
}

// What -dF of a law counts for a small motion over its coordinate and over its rate: position K + rate D.
struct ChangeWeights {
  double position = 0, rate = 0;
};

}  // namespace slew::multibody
