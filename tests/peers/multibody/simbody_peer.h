// SPDX-License-Identifier: Apache-2.0
// A MechanicsDef as a mechanism of Simbody (Sherman, Seth, Delp 2011).
//
// Every body of the Def is a body there (simbody_mechanism.h), fixed joints are welds, joints that are cut are
// constraints, static dummies are welded bodies. A cylinder or piston
// on a force is a body of its own without inertia about its axis: it turns about its end's point
// (MobilizedBody::LineOrientation) and its axis is held on the other end's point (Constraint::PointOnLine), so that the
// loop which our recursion eliminates is closed by multipliers there. Force elements act by def_laws.h. Friction and
// limits of joints are left off on both sides: they act through rows.
//
// Not covered: a dummy with neither inertia nor distance from its point.
#pragma once

#include <memory>
#include <vector>

#include "multibody/results/observe.h"
#include "tests/peers/multibody/body_motion.h"

namespace slew::multibody::testing {

class SimbodyPeer {
 public:
  explicit SimbodyPeer(const MechanicsDef& def);
  ~SimbodyPeer();

  // Takes poses and velocities; they must obey the joints.
  void set_motion(const Motions& motions);

  // Poses and velocities now, accelerations under gravity, force elements and the given wrenches, one per body.
  [[nodiscard]] Motions accelerate(const Wrenches& wrenches);

  // What every joint of the Def transmits, in the form of joint_reactions(); after accelerate().
  [[nodiscard]] std::vector<JointReaction> reactions() const;

  [[nodiscard]] Energy energy();

  // Runs for `time` [s] under gravity, force elements and the wrenches last given; local errors below `accuracy`
  // relative to a scale of one rad, m, rad/s, m/s.
  void run(double time, double accuracy);

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace slew::multibody::testing
