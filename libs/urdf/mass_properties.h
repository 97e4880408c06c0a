// SPDX-License-Identifier: Apache-2.0
// Mass properties of a robot's links, checked for groups that move as one.
//
// Links that fixed joints hold together are one body: a link with impossible mass properties of its own (a dummy base
// of a milligram with a tensor) is combined with the others of its group, and the sum is checked. The mass of the
// root's group has no effect if the root is fixed to Ground. The rule of a tensor with the principal moments p1 <= p2
// <= p3 about the centre of mass: p1 >= 0 and p3 <= p1 + p2.
//   missed share  s = (p3 - p1 - p2) / p3, or -p1/p3 where that is more                                        (1)
//   repair        p1, p2 += max((p3 - p1 - p2) / 2, -p1):  p3 and the axes stay, nothing turns more easily     (2)
// Links that move without mass: if they carry no mass, the motion of all others is the same without their joint, which
// is fixed at its start, with a note. Other massless links have no equation of motion of their own.
#pragma once

#include "urdf/placement.h"
#include "urdf/robot.h"
#include "urdf/tree.h"

namespace slew::urdf {

// Permitted changes that make the file a machine; every change is listed.
struct Repairs {
  bool is_repairing = false;  // tensors by (2), up to this share
  double share = 1;           // s of (1), at most
  bool is_merging = false;    // fixes joints of links that move without mass, or without inertia about their axis
};

// Call after find_starts(). Changes go to `changes`, properties without effect to the robot's notes. Reports links that
// are not repaired, with the option that repairs them.
void settle_mass_properties(Robot& robot, RootMount mount, const Repairs& repairs, std::vector<Note>& changes,
                            const ReportProblem& report_problem);

}  // namespace slew::urdf
