// SPDX-License-Identifier: Apache-2.0
#include "flex/uniform_element.h"

namespace slew::flex {

std::vector<UniformElement> uniform_elements(const FeModel& model) {
  std::vector<UniformElement> rows;
  for (const BeamElement& e : model.elements) {
    const Section& s = e.section;
    const double E = e.youngs_modulus, G = e.shear_modulus;
    rows.push_back({.node1 = model.nodes[e.node1].id,
                    .node2 = model.nodes[e.node2].id,
                    .axial = E * s.area,
                    .torsion = G * s.torsion_constant,
                    .bend_y = E * s.second_moment_y,
                    .bend_z = E * s.second_moment_z,
                    .shear_y = s.shear_factor_y * G * s.area,
                    .shear_z = s.shear_factor_z * G * s.area,
                    .mass = e.density * s.area,
                    .rotary_y = e.density * s.second_moment_y,
                    .rotary_z = e.density * s.second_moment_z,
                    .y = e.axes.c[1]});
  }
  return rows;
}

}  // namespace slew::flex
