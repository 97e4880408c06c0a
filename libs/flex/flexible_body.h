// SPDX-License-Identifier: Apache-2.0
// Description of a flexible body: materials and sections by name, nodes, elements, and its reduction.
//
// Either a beam (a line of nodes, or nodes by id) or the matrices of another finite element code. Conversion to
// numbers: model_of() and reduction_of(), then reduce() of reduction.h. File format: docs/howto/flexible-model.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/problem.h"
#include "flex/beam.h"
#include "flex/model_units.h"
#include "flex/reduction.h"

namespace slew::flex {

struct NamedMaterial {
  std::string name;
  Material material;
};

struct StressPointDef {
  double y = 0, z = 0;         // m, from the centroid
  double torsion_modulus = 0;  // m3; 0: no shear stress
};

struct NamedSection {
  std::string name;
  SectionDef section;
  double shear_factor = 0;                         // along y and z; 0: Cowper's, for a given section rigid in shear
  double shear_factor_y = 0, shear_factor_z = 0;   // the same along one axis; 0: as shear_factor
  std::vector<StressPointDef> stress_points = {};  // points of a given section
};

// Nodes with the ids 1 to `nodes` at equal distances.
struct NodeLineDef {
  Triple start{}, end{};   // m, body frame
  std::int64_t nodes = 0;  // 2 or more; 0: no line
};

// One element, or several in a row.
struct ElementChainDef {
  std::vector<double> through;  // ids, two or more
  std::string section;          // empty: that of FlexibleBodyDef
  std::string material;
  Triple y_axis{};  // 0: that of FlexibleBodyDef
};

// Files of imported_model.h; not absolute: from the description's folder.
struct MatrixFilesDef {
  std::string mass, stiffness, nodes;
  ModelUnits units = ModelUnits::m_kg_s;
  [[nodiscard]] bool is_given() const noexcept { return !nodes.empty(); }
};

struct BodyReductionDef {
  Attachment attachment = Attachment::clamped;
  std::vector<double> clamped_nodes = {};    // ids; empty: the first node
  std::vector<double> interface_nodes = {};  // ids; empty: the last node; free: the first and the last
  std::int64_t fixed_interface_modes = 10;
  GeometricStiffening stiffening = GeometricStiffening::none;
  EigenMethod eigen_method = EigenMethod::automatic;
};

struct FlexibleBodyDef {
  std::string model, prefix;  // parts of the files' names
  std::string description;
  std::vector<NamedMaterial> materials;
  std::vector<NamedSection> sections;
  std::string material;  // default of the elements; may be empty if there is one
  std::string section;
  NodeLineDef line;
  std::vector<BeamNodeDef> nodes;         // without a line; the first is the root, the last the tip
  std::vector<ElementChainDef> elements;  // empty: a chain through the nodes
  Triple y_axis = {0, 1, 0};
  MassKind mass_matrix = MassKind::consistent;
  RotaryInertia rotary_inertia = RotaryInertia::with;
  MatrixFilesDef matrices;
  BodyReductionDef reduction;
};

// All problems, as far as one does not hide another, with paths as in a description ("sections.Box.wall",
// "elements[0].through", "reduction.clamped_nodes"). Imported matrices are not read.
[[nodiscard]] Problems check_flexible_body(const FlexibleBodyDef& def);

// Problems of the reduction with the model's nodes and freedoms; paths as above.
[[nodiscard]] Problems check_reduction(const FlexibleBodyDef& def, const FeModel& model);

// folder: that of the description. Throws InputError: problems of check_flexible_body(), or of the import. Allocates.
[[nodiscard]] FeModel model_of(const FlexibleBodyDef& def, const std::filesystem::path& folder);
// Pre-condition: check_reduction() found no problem.
[[nodiscard]] ReductionDef reduction_of(const FlexibleBodyDef& def);

}  // namespace slew::flex
