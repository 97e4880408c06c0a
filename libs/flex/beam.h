// SPDX-License-Identifier: Apache-2.0
// A beam structure as definitions, and the finite element model made of it.
//
// Nodes lie anywhere; straight elements join them, in the order of the nodes unless they are listed. Each element has
// its own section, material and direction of the section's y axis. Mass: consistent with the shape functions
// (beam_element.h), by four Gauss points an element, which are exact for it; or lumped, half of an element at each of
// its nodes with the section's second moments, without internal freedoms. Lumped mass has no moment of the element's
// own length: second moments of the solid then are too large by rho A l^3/6 an element along the beam. Card:
// docs/models/flex_beam_elements.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/problem.h"
#include "flex/fe_model.h"
#include "flex/section.h"

namespace slew::flex {

using Triple = std::array<double, 3>;

struct Material {
  double youngs_modulus = 0;   // E [Pa], > 0
  double poisson_ratio = 0.3;  // nu, -1 to 0.5
  double shear_modulus = 0;    // G [Pa]; 0: E/(2 (1 + nu))
  double density = 0;          // rho [kg/m3], > 0
};

struct BeamNodeDef {
  int id = 0;
  Triple position{};  // m, body frame
};

struct BeamElementDef {
  int node1 = 0, node2 = 0;  // ids
  std::size_t section = 0;   // places in BeamDef
  std::size_t material = 0;
  Triple y_axis{};  // any vector in the section's x-y plane on the side of +y; 0: that of BeamDef
};

enum class MassKind : int { consistent, lumped };

struct BeamDef {
  std::string name = "Beam";
  std::vector<Material> materials;
  std::vector<SectionDef> sections;
  std::vector<BeamNodeDef> nodes;        // the first is the root, the last the tip
  std::vector<BeamElementDef> elements;  // empty: a chain through the nodes of the first section and material
  Triple y_axis = {0, 1, 0};             // where it lies along an element, the body's z is taken instead
  MassKind mass = MassKind::consistent;
  // none: mass consistent only, for comparison with Euler's beam. It leaves the sections' inertia out of the bending;
  // the mass integrals of a reduced body (integrals.h) stay those of the solid.
  RotaryInertia rotary_inertia = RotaryInertia::with;
};

// Nodes with the ids 1 to count at equal distances on a line [m, body frame]. Pre-condition: count >= 2.
[[nodiscard]] std::vector<BeamNodeDef> line_of_nodes(Triple start, Triple end, int count);

// All problems, as far as one does not hide another; empty: build_beam() accepts the Def.
[[nodiscard]] Problems check_beam(const BeamDef& def);

// Throws InputError with all problems. Allocates.
[[nodiscard]] FeModel build_beam(const BeamDef& def);

}  // namespace slew::flex
