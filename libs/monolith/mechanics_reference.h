// Mechanics alone, to tight tolerances: what a formulation, an integrator and a step are judged against.
//
//   q' = coordinate rates,   u' = f(P(q, u)),   P: nearest state on the loops                                (1)
// in joint coordinates under CVODE's BDF (stiff_solver.h). Joints of the tree hold by themselves; cut joints are closed
// by P (multibody::project) before every evaluation, and every 50 ms in the solver's own values, from which it then
// goes on anew. Forces are those of the elements, and friction and limits of joints; their corners cost many small
// steps. Not for real time.
//
// What it does not cover: hydraulics and their ports (monolith.h), formulations and steps of the scene.
#pragma once

#include <span>
#include <vector>

#include "core/status.h"
#include "monolith/stiff_solver.h"
#include "multibody/defs.h"
#include "multibody/model.h"
#include "multibody/state.h"

namespace slew::monolith {

struct MechanicsReferenceOptions {
  double relative_tolerance = 1e-10;
  double absolute_tolerance = 1e-11;  // rad, m, rad/s, m/s
};

struct MechanicsReference {
  multibody::Model model;                // rows: multibody::joint_rows()
  std::vector<multibody::State> states;  // by output time, in joint coordinates of the model
  SolverStatistics statistics;
};

// States of the mechanism at the given times [s, rising, the first at least 0 = the scene's start]. Pre-condition:
// validate() found nothing. Error (diverged): CVODE gave up, with the time; the states before are there.
[[nodiscard]] Status integrate_mechanics(const multibody::MechanicsDef& mechanics, std::span<const double> times,
                                         const MechanicsReferenceOptions& options, MechanicsReference& result);

}  // namespace slew::monolith
