// Mass properties of a robot's links, judged as what moves as one.
//
// Links that fixed joints hold together are one body: a link whose own mass properties no body has (a dummy base of a
// milligram with a tensor of its own) is taken together with the others of its group, and the sum is judged. What the
// root's group weighs has no effect where the root is fixed to Ground. The rule of a tensor with the principal moments
// p1 <= p2 <= p3 about the centre of mass: p1 >= 0 and p3 <= p1 + p2.
//   missed share  s = (p3 - p1 - p2) / p3, or -p1/p3 where that is more                                        (1)
//   repair        p1, p2 += max((p3 - p1 - p2) / 2, -p1):  p3 and the axes stay, nothing turns more easily     (2)
// Links that move without mass: where nothing with mass hangs on them the motion of all others is the same without
// their joint, which is fixed at its start, with a note. Others have no equation of motion of their own.
#pragma once

#include "urdf/placement.h"
#include "urdf/robot.h"
#include "urdf/tree.h"

namespace slew::urdf {

// What may be changed so that the file becomes a machine; every change is listed.
struct Repairs {
  bool is_repairing = false;  // tensors by (2), up to this share
  double share = 1;           // s of (1), at most
  bool is_merging = false;    // joints of what moves without mass, or without inertia about its axis, are fixed
};

// After find_starts(). Changes go to `changes`, what has no effect to the robot's notes. Complains about links that
// are not repaired, with the option that would.
void settle_mass_properties(Robot& robot, RootMount mount, const Repairs& repairs, std::vector<Note>& changes,
                            const ReportProblem& report_problem);

}  // namespace slew::urdf
