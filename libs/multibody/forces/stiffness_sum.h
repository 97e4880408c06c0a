// SPDX-License-Identifier: Apache-2.0
// What a force kind adds its stiffness and damping to: an implicit step's matrix over the speeds of all links.
//
// What an element's force loses by a change u of the speeds, A u = (position K + rate D) u, is added between points and
// frames of links. A kind leaves out the parts that would make the sum indefinite (pushes, falling tables): the sum
// stays symmetric and positive semi-definite. Equations: formulations/link_stiffness.h, whose source has the functions.
#pragma once

#include <span>

#include "multibody/forces/frame_pair.h"

namespace slew::multibody {

class LinkMatrix;
struct Workspace;

class StiffnessSum {
 public:
  // pull_weight: of the pull of a force across the arm at which it acts; 0: pulls are left out.
  StiffnessSum(const Workspace& ws, ChangeWeights weights, double pull_weight, LinkMatrix& matrix) noexcept
      : ws_(ws), weights_(weights), pull_weight_(pull_weight), matrix_(matrix) {}

  [[nodiscard]] ChangeWeights weights() const noexcept { return weights_; }
  [[nodiscard]] double pull_weight() const noexcept { return pull_weight_; }
  [[nodiscard]] std::span<const LinkMotion> motion() const noexcept;  // of all links

  // A between two points of the same or of two links, at s [m] from their origins.
  void add_points(int link_a, math::Vec3 s_a, int link_b, math::Vec3 s_b, const math::Mat3& A) noexcept;
  // A between two points (Ground), each of which is seen from the other.
  void add_stretch(int link1, math::Vec3 P1, int link2, math::Vec3 P2, const math::Mat3& A) noexcept;
  // A over the motion of link 2 against link 1, the point at P [m, Ground].
  void add_relative(int link1, int link2, math::Vec3 P, const PairMatrix& A) noexcept;
  // slopes over the deflection of two frames, and the pull of the force that is there.
  void add_frames(const FramePair& frames, const Deflection& deflection, const SixBySix& slopes,
                  const Six& force) noexcept;

 private:
  const Workspace& ws_;
  ChangeWeights weights_;
  double pull_weight_;
  LinkMatrix& matrix_;
};

}  // namespace slew::multibody
