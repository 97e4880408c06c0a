// SPDX-License-Identifier: Apache-2.0
// The passes of an implicit stage (integrators.h, equations (2) and (4)). Internal to the library.
#pragma once

#include <span>

#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/integrators.h"

namespace slew::multibody {

// A stage's part of (2) beside u* and d.
struct Stage {
  double tau = 0, sigma = 0;  // s
  double time = 0;            // s, from the start of the sub-step
};

struct StageContext {
  const Model& model;
  const BodyModel& body;
  Moving moving;
  Workspace& ws;
  BodyWorkspace& bws;
  StageWorkspace& stages;

  [[nodiscard]] std::span<double> u() const noexcept { return moving.bodies ? moving.bodies->u : moving.joints.u; }
  [[nodiscard]] std::span<double> q() const noexcept { return moving.bodies ? moving.bodies->q : moving.joints.q; }
};

// Coordinates and motion for the present speeds; joint coordinates where bodies are integrated.
void place(const StageContext& at, double sigma) noexcept;

// Adds the accelerations by the speeds' rates to those of the motion.
void add_accelerations(const StageContext& at, std::span<const double> rate) noexcept;

// Right side of (4), with lambda of stages.multipliers, into bws.solution; evaluates elements, inertia and joints'
// rows. Needs place(), and the time of the stage in ws.
void find_residual(const StageContext& at, const Stage& stage) noexcept;

// delta of (4) in joint coordinates by the recursion, whose inertias take tau D + tau sigma K: into stages.step, and by
// link into ws.delta_a, ws.delta_alpha over tau. Needs place(), and the time of the stage in ws. False: the stiffness
// does not follow the tree (tree_matrix.h), or the position is near a singular one; ws needs place() again.
[[nodiscard]] bool find_step_in_tree(const StageContext& at, const Stage& stage) noexcept;

// Left side of (4), after find_residual(); with the pull of the joints when stages.has_pulls. False:
// singular to working precision.
[[nodiscard]] bool factorize_stage(const StageContext& at, const Stage& stage) noexcept;

// Adds the displacement by forces of the rows with these moments [N s2, N m s2] to the stage's base: the response of
// the present factors of (4). Speeds stay; needs place() afterwards.
void add_displacement(const StageContext& at, std::span<const double> moments) noexcept;

// delta of bws.solution in the integrated speeds.
void read_step(const StageContext& at, std::span<double> step) noexcept;

}  // namespace slew::multibody
