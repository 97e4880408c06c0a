// SPDX-License-Identifier: Apache-2.0
// Bodies and joints of a MechanicsDef in Simbody: a mobilizer for every joint of the tree, constraints for every joint
// that is cut, under gravity alone.
//
// The tree is ours (topology.h). A cut joint is put together from constraints of Simbody's own:
//   spherical Ball, fixed Weld, spherical_spherical Rod, in_plane PointInPlane, in_line PointOnLine,
//   perpendicular ConstantAngle; universal Ball + ConstantAngle, revolute Ball + 2 ConstantAngle,
//   cylindrical PointOnLine + 2 ConstantAngle, prismatic PointOnLine + ConstantOrientation,
//   revolute_spherical Rod + PointInPlane, revolute_revolute Rod + 2 PointInPlane + ConstantAngle
//   (of parallel hinges Rod + PointInPlane + 2 ConstantAngle)
#pragma once

#include <vector>

#include "multibody/model/topology.h"
#include "tests/peers/multibody/simbody_frames.h"

namespace slew::multibody::testing {

struct SimbodyMechanism {
  explicit SimbodyMechanism(const MechanicsDef& mechanics);

  [[nodiscard]] SimTK::MobilizedBody& mobilized(std::size_t body) { return matter.updMobilizedBody(bodies[body]); }

  // constraints of a joint of the Def
  struct CutJoint {
    std::size_t joint = 0;
    std::vector<SimTK::ConstraintIndex> constraints;
  };

  MechanicsDef def;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  std::vector<SimTK::MobilizedBodyIndex> bodies;  // by body, [0] is Ground
  std::vector<TreeEdge> edges;
  std::vector<CutJoint> cuts;

 private:
  void add_body(const TreeEdge& edge);
  void add_cut(std::size_t number, const JointFrames& start);
};

}  // namespace slew::multibody::testing
