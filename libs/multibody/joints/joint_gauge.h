// How far the joints of a mechanism are open, measured on the poses and velocities of its links.
//
// Every joint of the scene forbids what its rows say (constraint.h): g = 0 and g' = 0. The gauge evaluates all of them,
// joints with coordinates and rows that others imply included, from the links' motion alone. So its figures mean the
// same for every formulation, whatever that one integrates and corrects: in joint coordinates the joints of the tree
// are closed but for rounding, in body coordinates every joint shows what the correction has left.
//
// Not covered: fixed joints, whose bodies are one link, and what joints allow (limits, friction).
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
  int joint = -1;       // of the scene, the most open one; -1: all are closed exactly
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
