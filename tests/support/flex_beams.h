// SPDX-License-Identifier: Apache-2.0
// Beams that the tests of libs/flex share, and short ways to their figures.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "flex/beam.h"
#include "flex/input_error.h"
#include "flex/reduction.h"

namespace slew::flex::testing {

inline Material steel(double youngs_modulus = 2.1e11, double density = 7850) {
  return {.youngs_modulus = youngs_modulus, .poisson_ratio = 0.3, .shear_modulus = 0, .density = density};
}

inline SectionDef square(double side) {
  return {.shape = SectionShape::solid_rectangle, .width = side, .height = side};
}

inline BeamDef straight(SectionDef section, Material material, Triple end, int nodes, Triple start = {0, 0, 0}) {
  BeamDef def;
  def.sections = {section};
  def.materials = {material};
  def.nodes = line_of_nodes(start, end, nodes);
  return def;
}

// case B01: 2 m, 0.1 m square, steel, k = 5/6; torsion with the polar moment, as its reference has it
inline BeamDef cantilever_b01(int elements, Shear shear = Shear::timoshenko) {
  SectionDef section = square(0.1);
  section.shear = shear;
  section.shear_factor_y = section.shear_factor_z = 5.0 / 6;
  return straight(section, steel(), {2, 0, 0}, elements + 1);
}

// jib boom of the crane (thesis, chapter 3.2): 6.5 m along -x, 300 mm square, wall 2.139 mm
inline BeamDef jib_boom(int nodes = 20, double youngs_modulus = 2e11) {
  BeamDef def = straight({.shape = SectionShape::hollow_rectangle, .width = 0.3, .height = 0.3, .wall = 2.139e-3},
                         steel(youngs_modulus, 7700), {-6.5, 0.02904, 0.1507}, nodes, {0, 0.02904, 0.1507});
  def.name = "Truck_JibBoom";
  return def;
}

inline ReductionDef with_modes(int count, Attachment attachment = Attachment::clamped) {
  ReductionDef def;
  def.modes.attachment = attachment;
  def.modes.fixed_interface_modes = count;
  return def;
}

// The same with its internal freedoms held: elements of two nodes, as other codes export them.
inline FeModel at_nodes(FeModel model) {
  const int rows = 6 * static_cast<int>(model.nodes.size());
  model.M = SparseMatrix(model.M.topLeftCorner(rows, rows));
  model.K = SparseMatrix(model.K.topLeftCorner(rows, rows));
  const auto hold = [](ElementFreedoms& freedoms) { std::fill(freedoms.begin() + kNodalFreedoms, freedoms.end(), -1); };
  for (BeamElement& element : model.elements) hold(element.freedoms);
  for (MassSample& sample : model.samples) hold(sample.freedoms);
  return model;
}

// text of the error that the call throws; empty when it throws none
template <typename Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline double hertz(double omega) {
  return omega / (2 * M_PI);
}

}  // namespace slew::flex::testing
