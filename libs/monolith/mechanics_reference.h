// SPDX-License-Identifier: Apache-2.0
// Mechanics alone, to tight tolerances: the reference for formulations, integrators and steps.
//
//   q' = coordinate rates,   u' = f(P(q, u)),   P: nearest state on the loops                                (1)
// in joint coordinates under CVODE's BDF (stiff_solver.h). Joints of the tree hold by themselves; cut joints are closed
// by P (multibody::project) before every evaluation, and every 50 ms in the solver's own values, with a restart. Forces
// are those of the elements, and friction and limits of joints; their corners cost many small steps. Bristles of joint
// friction are states, with the rates of joint_law.h. Not for real time.
// A second reference shares neither coordinates nor equations nor solver with this one: body_reference.h.
//
// Not covered: hydraulics and their ports (monolith.h), formulations and steps of the scene, prescribed motions whose
// acceleration jumps, contacts: their memory (impact speeds, bristles that move from point to point) changes at the
// ends of steps.
#pragma once

#include <span>
#include <vector>

#include "core/status.h"
#include "monolith/stiff_solver.h"
#include "multibody/model/defs.h"
#include "multibody/model/model.h"
#include "multibody/model/state.h"

namespace slew::monolith {

enum class ReferenceEquations : unsigned char {
  joint_coordinates,  // (1) under CVODE
  body_coordinates    // body_reference.h under IDA
};

struct MechanicsReferenceOptions {
  ReferenceEquations equations = ReferenceEquations::joint_coordinates;
  double relative_tolerance = 1e-10;
  double absolute_tolerance = 1e-11;  // rad, m, rad/s, m/s
};

struct MechanicsReference {
  multibody::Model model;                // rows: multibody::joint_rows()
  std::vector<multibody::State> states;  // by output time, in joint coordinates of the model
  SolverStatistics statistics;
};

// States of the mechanism at the given times [s, rising, the first at least 0 = the scene's start]. Pre-condition:
// validate() found nothing. Errors: a pair of shapes is tested for contact (bad_input); the solver gave up (diverged),
// with the time; earlier states are kept.
[[nodiscard]] Status integrate_mechanics(const multibody::MechanicsDef& mechanics, std::span<const double> times,
                                         const MechanicsReferenceOptions& options, MechanicsReference& result);

}  // namespace slew::monolith
