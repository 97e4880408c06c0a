// Start positions and speeds that fit all joints, and the rows of cut joints that are independent. Internal to the
// library.
#pragma once

#include <string>
#include <vector>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"

namespace slew::multibody {

inline constexpr double kFrameTolerance = 1e-6;  // m, rad: the scene's numbers have six digits and more

// What the start leaves open.
struct AssemblyReport {
  struct Row {
    int joint = 0;         // Model::joints
    std::string what;      // describe() of its row
    double violation = 0;  // m or 1
    std::string gear{};    // its name, where the row is a gear's
  };
  struct Speed {
    std::string joint;
    double wanted = 0, found = 0;  // rad/s or m/s
  };
  std::vector<Row> open;        // rows that the start does not fit, worse than kFrameTolerance
  std::vector<Row> held_twice;  // rows that prescribed motions and loops already imply
  std::vector<Speed> speeds;    // given by the scene, but the loops do not allow them
  bool is_settled = true;       // false: flexible bodies find no rest under the start's load
};

// Rows of a cut joint that the tree and the cuts before it imply are taken out of the model: planar loops in space,
// doubled hinges. A row is left out when it is dependent in several positions near the start; one that depends on the
// others at the start alone (a singular position) stays. Then start_q and start_u are moved onto all joints, in the
// metric of the masses. Speeds that the scene gives are kept, and those of modes, which are zero: the loops close by
// the bodies' rigid motion. The others follow.
[[nodiscard]] AssemblyReport assemble(Model& model);

// build_model() with what assemble() found.
[[nodiscard]] Model build_model(const MechanicsDef& mechanics, std::span<const std::string> rows,
                                AssemblyReport& report);

// The same of a scene whose bodies are those of with_nodes() already, and whose segmented bodies are left out.
[[nodiscard]] Model build_expanded_model(const MechanicsDef& expanded, AssemblyReport& report);

}  // namespace slew::multibody
