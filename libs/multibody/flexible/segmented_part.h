// SPDX-License-Identifier: Apache-2.0
// A body of finite segments in the mechanism: links that move independently, and the beams between them.
//
// The lumps' links are floating ones, with the pose in Ground as coordinates, except the root's and those held by
// joints of the scene; all elasticity is in the elements (elements/beam.h), so that no pass depends on segments.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "multibody/flexible/deflection.h"
#include "multibody/flexible/segmented_def.h"

namespace slew::multibody {

struct Model;
struct Workspace;

struct SegmentedPart {
  std::string name;                            // name of the body
  std::vector<int> bodies{};                   // Model::bodies, by lump
  std::size_t first_beam = 0;                  // ElementSet::beams, one for each connector
  double length = 0;                           // m, of all connectors
  bool is_free = false;                        // no joint holds a lump other than the root: its static equilibrium can
                                               // be computed
  SegmentStart start = SegmentStart::at_rest;  // start selected by the scene
  std::shared_ptr<const SegmentChain> source{};
};

// Beyond it eq. 29 of a connector is off by half a percent (theta^2/8).
inline constexpr double kLargestBend = 0.2;  // rad

// Displacement of the lumps and nodes from a rigid body that moves with the root [m], root's frame.
// After a motion in ws. None of these allocates.
[[nodiscard]] math::Vec3 tip_deflection(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept;
[[nodiscard]] LargestDeflection largest_deflection(const Model& model, const SegmentedPart& part,
                                                   const Workspace& ws) noexcept;
[[nodiscard]] double strain_energy(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept;

struct LargestBend {
  std::size_t connector = 0;
  double angle = 0;  // rad, between its ends
};
[[nodiscard]] LargestBend largest_bend(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept;

// Appends the parts and their beams; the bodies are those of with_nodes().
void add_segments(const struct MechanicsDef& mechanics, Model& model);

// Sets q and u of the lumps to the undeformed chain that moves with the root. Pre-condition: start_q of the joints
// stands.
void straighten_segments(const Model& model, std::span<double> q, std::span<double> u);

// Puts chains at rest in the pose that the joints have at the start, in the connectors' relative coordinates x:
//   R_1^T sum F = 0,   R_1^T sum M = 0     of all loads beyond each connector, about its far end           (1)
//   x <- x + K_b^-1 (1) of each connector, and if that does not shrink by half, Newton's method             (2)
// with gravity, springs, constant loads and the beams themselves, all joints held; row forces are not in it. Chains
// that are not selected, and all that are not free, keep their start. False: no rest is found, as beyond a buckling
// load; the chains stay straight. selected: by Model::segmented.
[[nodiscard]] bool settle_segments(Model& model, const std::vector<bool>& selected);

}  // namespace slew::multibody
