// SPDX-License-Identifier: Apache-2.0
#include "multibody/model/model.h"

#include <cstddef>

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

template <typename Element>
int index_of(const std::vector<Element>& elements, std::string_view name) noexcept {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

int find_body(const Model& model, std::string_view name) noexcept {
  return index_of(model.bodies, name);
}

int find_joint(const Model& model, std::string_view name) noexcept {
  return index_of(model.joints, name);
}

int find_row(const Model& model, std::string_view name) noexcept {
  for (int row = 0; row < model.row_count(); ++row) {
    if (row_name(model, row) == name) return row;
  }
  return -1;
}

std::string_view row_name(const Model& model, int row) noexcept {
  return model.rows[static_cast<std::size_t>(row)].name;
}

bool has_effect(const ElementLaw& law) noexcept {
  return law.spring != 0 || law.damping != 0 || law.end_spring != 0 || !law.spring_curve.empty() ||
         !law.damper_curve.empty();
}

void mark_used_elements(Model& model) noexcept {
  for (LineElement& line : model.lines) line.is_used = line.law.is_active = has_effect(line.law);
  for (AngleElement& element : model.angles) element.law.is_active = has_effect(element.law);
  for (const CoupledMass& coupled : model.coupled) model.lines[static_cast<std::size_t>(coupled.line)].is_used = true;
  for (const Row& row : model.rows) {
    const auto element = static_cast<std::size_t>(row.element);
    if (row.kind == RowKind::length) model.lines[element].is_used = true;
    if (row.kind == RowKind::angle) model.angles[element].has_row = true;
  }
}

namespace {

void lump_nothing(Link& link) noexcept {
  link.mass = 0;
  link.h_L = Vec3();
  link.I_L = Mat3();
}

void lump_part(const LumpedMass& part, Link& link) noexcept {
  // inertia scales with the mass; then from the part's centre to the link's origin
  const double share = part.reference_mass > 0 ? part.mass / part.reference_mass : 0;
  const Mat3 c = math::skew(part.c_L);
  Mat3 I = link.I_L;
  I += part.I_c * share;
  I -= (c * c) * part.mass;
  link.I_L = I;
  link.h_L += part.c_L * part.mass;
  link.mass += part.mass;
}

}  // namespace

void lump_link(Model& model, int link) noexcept {
  Link& lumped = model.links[static_cast<std::size_t>(link)];
  lump_nothing(lumped);
  for (const LumpedMass& part : model.lumped) {
    if (part.link == link) lump_part(part, lumped);
  }
}

void lump_links(Model& model) noexcept {
  for (std::size_t link = 1; link < model.links.size(); ++link) lump_nothing(model.links[link]);
  for (const LumpedMass& part : model.lumped) {
    if (part.link > 0) lump_part(part, model.links[static_cast<std::size_t>(part.link)]);
  }
}

}  // namespace slew::multibody
