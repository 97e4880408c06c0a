// SPDX-License-Identifier: Apache-2.0
// Stiffness and damping of the force elements over the speeds of the links, which an implicit step adds to the masses.
// Internal to the library.
//
// A change u of the links' speeds moves their coordinates by `position/rate` times as much. The resulting loss of the
// elements' forces, A u = (position K + rate D) u, is added here, block by block:
//   spring-dampers, bushings, beams   J^T A J, A the law's slopes over its coordinates, tables included          (1)
//   ropes                             slopes of the tension over the length, between all links of the rope       (2)
//   tyres                             normal force by its slopes, slip by its secants                            (3)
// and the pull of a force F across the arm s at which it acts on a link, (F . s)(1 - s s^T/s^2), where it is positive;
// of a line and of a rope across each of their stretches. Parts that would make the sum indefinite (pushes, falling
// tables) are omitted: the sum stays symmetric and positive semi-definite. Contacts: contact_stiffness.h.
#pragma once

#include "multibody/formulations/link_matrix.h"

namespace slew::multibody {

// Selected terms: all, or those without strain in a rigid motion of all links together. A force fixed to the links
// turns with them; its pull alone would resist that turn.
enum class Stiffness { with_pulls, of_strain };

// (1) to (3) at the motion in ws; needs update_elements().
void add_stiffness(const Model& model, const Workspace& ws, ChangeWeights weights, LinkMatrix& matrix,
                   Stiffness which = Stiffness::with_pulls) noexcept;

// Stiffness of a link's turn about its origin by a force F at s from it.
void add_pull(int link, math::Vec3 s, math::Vec3 F, double weight, LinkMatrix& matrix) noexcept;

// Calls couple(link1, link2) for the links of every element.
template <typename Couple>
void for_each_element_coupling(const Model& model, Couple&& couple) {
  for (const LineElement& line : model.lines) couple(line.link1, line.link2);
  for (const AngleElement& angle : model.angles) couple(angle.link1, angle.link2);
  for_each_force_kind([&](auto row) {
    for (const auto& element : elements_of(row, model.elements)) row.for_each_coupling(element, couple);
  });
}
// The same, and for those of every pair of shapes that may touch.
template <typename Couple>
void for_each_coupling(const Model& model, Couple&& couple) {
  for_each_element_coupling(model, couple);
  if (model.contact == nullptr) return;
  for (const contact::ContactPair& pair : model.contact->model.pairs()) {
    const auto link_of = [&](std::size_t shape) {
      return model.contact->frames[model.contact->model.frame_of(shape)].link;
    };
    couple(link_of(pair.shape_a), link_of(pair.shape_b));
  }
}

}  // namespace slew::multibody
