// SPDX-License-Identifier: Apache-2.0
// Start positions and speeds that fit all joints, and the rows of cut joints that are independent. Internal to the
// library.
#pragma once

#include <string>
#include <vector>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

inline constexpr double kFrameTolerance = 1e-6;  // m, rad: the scene's numbers have six digits and more

// Result of the assembly: rows and speeds that the start violates.
struct AssemblyReport {
  struct Row {
    int joint = 0;         // Model::joints
    std::string what;      // describe() of its row
    double violation = 0;  // m or 1
    std::string gear{};    // name of the gear, if the row belongs to one
  };
  struct Speed {
    std::string joint;
    double wanted = 0, found = 0;  // rad/s or m/s
  };
  // A row that depends on others at the start alone: the loop is in a singular position.
  struct Singular {
    std::string joint;        // or gear, that closes the loop
    std::string others;       // names of the loop's other joints
    bool is_at_rest = false;  // no joint of the loop moves
    bool goes_on = true;      // false: the loop cannot go on with the start's speeds
  };
  std::vector<Row> open;        // rows that the start violates by more than kFrameTolerance
  std::vector<Row> held_twice;  // rows that prescribed motions and loops already imply
  std::vector<Row> locking;     // gears whose ratio leaves no motion to either joint; `what` names joint 1
  std::vector<Speed> speeds;    // speeds of the scene that the loops do not allow
  std::vector<Singular> singular;
  bool is_settled = true;  // false: flexible bodies find no rest under the start's load
};

// Removes rows of a cut joint that the tree and the cuts before it imply: planar loops in space, doubled hinges. A row
// is removed if it is dependent in several positions near the start; a row that is dependent at the start alone (a
// singular position) stays. Then start_q and start_u are moved onto all joints, in the metric of the masses. Speeds
// that the scene gives are kept, and those of modes, which are zero: the loops close by the bodies' rigid motion. The
// others follow.
[[nodiscard]] AssemblyReport assemble(Model& model);

// build_model() with the result of assemble().
[[nodiscard]] Model build_model(const MechanicsDef& mechanics, std::span<const std::string> rows,
                                AssemblyReport& report);

// The same for a scene after with_nodes(), without its segmented bodies.
[[nodiscard]] Model build_expanded_model(const MechanicsDef& expanded, AssemblyReport& report);

}  // namespace slew::multibody
