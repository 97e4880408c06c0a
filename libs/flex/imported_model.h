// SPDX-License-Identifier: Apache-2.0
// Models of other finite element codes: mass and stiffness as Matrix Market files beside a table of the nodes.
//
// The table has one line a node, in the order of the matrices' rows, words between white space, commas or semicolons:
//   id x y z freedoms          whole number, m, m, m, 3 (ux uy uz) or 6 (ux uy uz rx ry rz)
// after optional lines that begin with # and one optional line of names that begins with `id`. Units are SI, or those
// of `units` (model_units.h), which turn positions and matrices into SI.
// The model's nodes are those of the table in ascending id, for any order of the rows.
// Checked, each with the found and the expected value: square matrices of one size, that of the nodes' freedoms
// together; symmetry; no negative stiffness or mass; K R = 0 for the six rigid motions R of the table, and no other
// motion without stiffness; one mass in x, y and z; a radius of gyration within the extent of the nodes. These find
// matrices with supports, and nodes in another order than the rows; lengths, wave speed and density (model_units.h)
// find those in other units. Card: docs/models/flex_craig_bampton.md.
#pragma once

#include <filesystem>
#include <string>

#include "flex/fe_model.h"
#include "flex/model_units.h"

namespace slew::flex {

struct ImportDef {
  std::string name = "Body";
  std::filesystem::path mass, stiffness, nodes;
  ModelUnits units = ModelUnits::m_kg_s;
};

// Throws InputError. Allocates; factorises both matrices.
[[nodiscard]] FeModel import_model(const ImportDef& def);

// The same from matrices in memory; rows in the order of `nodes`, whose `first` is ignored. Throws InputError.
[[nodiscard]] FeModel model_of_matrices(const std::string& name, std::vector<FeNode> nodes, const SparseMatrix& M,
                                        const SparseMatrix& K, ModelUnits units = ModelUnits::m_kg_s);

// The three files of a model, as import_model() reads them. Throws InputError when one cannot be written, or when the
// model has freedoms besides those of its nodes.
void export_model(const FeModel& model, const ImportDef& files);

}  // namespace slew::flex
