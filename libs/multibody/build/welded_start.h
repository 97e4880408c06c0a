// SPDX-License-Identifier: Apache-2.0
// Start poses and speeds of segmented bodies in a mechanism whose joints hold more of them than their roots, or that
// has loops. They start undeformed, with the poses and speeds of the mechanism in which every segmented body is rigid.
// Its loops close by rigid motion alone; the lumps follow. Internal to the library.
#pragma once

#include <optional>
#include <vector>

#include "multibody/build/assembly.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

struct WeldedStart {
  std::vector<Pose> poses;          // by body; Ground's is the first
  std::vector<math::Vec3> v_WB;     // m/s, of the body's origin
  std::vector<math::Vec3> w_WB;     // rad/s
  std::vector<double> modal_speed;  // modal speeds of all flexible parts, in the order of the parts
  AssemblyReport report;            // report of the rigid mechanism
};

// None: no body is segmented, or they are open chains that follow their roots (straighten_segments()). expanded: the
// scene after with_nodes(); tree: of it. Allocates.
[[nodiscard]] std::optional<WeldedStart> welded_start(const MechanicsDef& expanded, const std::vector<TreeEdge>& tree);

// Writes the speeds of the rigid mechanism to start_u of the model, and its assembly's report to that of the model.
// Pre-condition: start_q has the poses of the welded start.
void take_over(const WeldedStart& welded, Model& model, AssemblyReport& report);

}  // namespace slew::multibody
