// SPDX-License-Identifier: Apache-2.0
// Pose and motion of a link at one instant.
#pragma once

#include "math/rotation.h"

namespace slew::multibody {

// In Ground axes. alpha and a are the accelerations that the link would have with u' = 0 in a frame that accelerates
// with gravity (Ground has a = -g), so that gravity needs no forces of its own.
struct LinkMotion {
  math::Mat3 R;      // R_WL
  math::Vec3 p;      // m, origin
  math::Vec3 r;      // m, from the parent's origin
  math::Vec3 w;      // rad/s
  math::Vec3 v;      // m/s, of the origin
  math::Vec3 axis;   // z of the link: of a joint with one or two coordinates
  math::Vec3 axis1;  // universal joint: z of the parent's frame
  math::Vec3 alpha;  // rad/s2
  math::Vec3 a;      // m/s2, of the origin
};

}  // namespace slew::multibody
