// SPDX-License-Identifier: Apache-2.0
// `slewring describe SCENE --eigenvalues`: the fastest and the slowest motions of the whole machine about an instant,
// their owners, and the steps that resolve them.
#pragma once

#include <string>

#include "core/json.h"
#include "monolith/linearisation.h"
#include "scene/scene.h"

namespace slew::analysis {

enum class DryFriction { kept, neglected };

struct Eigenvalues {
  double at = 0;  // s
  DryFriction friction = DryFriction::kept;
  monolith::SceneModes machine;        // everything
  monolith::SceneModes explicit_part;  // part for the mechanics' integrator
  std::string formulation, integrator, hydraulics_solver;
  double step = 0, substep = 0;  // s; substep 0: no mechanics
  std::string touching;          // pair of shapes that touch; empty: none
};

// Eigenvalues of the scene's run at a time [s]. Throws Failure.
[[nodiscard]] Eigenvalues find_eigenvalues(const scene::Scene& scene, double at, DryFriction friction);

// count: rows of the fastest, and of the slowest. width [characters]: of the lines of a table; 0: no limit.
[[nodiscard]] std::string report_text(const Eigenvalues& eigenvalues, std::size_t count, std::size_t width = 0);
[[nodiscard]] Json report_json(const Eigenvalues& eigenvalues);

}  // namespace slew::analysis
