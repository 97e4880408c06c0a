// SPDX-License-Identifier: Apache-2.0
// Violation of a mechanism's joints, measured on the poses and velocities of its links.
//
// Every joint of the scene demands g = 0 and g' = 0 for its rows (constraint.h). The gauge evaluates all rows, also of
// joints with coordinates and redundant ones, from the links' motion alone. So its figures are comparable between all
// formulations: in joint coordinates the joints of the tree are closed to rounding, in body coordinates every joint
// shows the residual of the correction.
//
// Not covered: fixed joints, whose bodies are one link, and forces along free coordinates (limits, friction).
#pragma once

#include <vector>

#include "multibody/model/model.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// All rows of the scene's joints that hold links to each other, redundant ones included, in the order of the joints.
// Allocates.
[[nodiscard]] std::vector<Constraint> joint_constraints(const Model& model);

struct JointGap {
  double position = 0;  // largest |g|, m or rad
  double rate = 0;      // largest |g'|, m/s or rad/s
  int joint = -1;       // joint of the scene with the largest violation; -1: all are closed exactly
};

class JointGauge {
 public:
  // Allocates.
  explicit JointGauge(const Model& model);

  // For the motion in ws, as Dynamics::observe() leaves it. NaN when the motion is not finite. Does not allocate.
  [[nodiscard]] JointGap measure(const Workspace& ws) const noexcept;

 private:
  std::vector<Constraint> constraints_;
};

}  // namespace slew::multibody
