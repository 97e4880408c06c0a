// SPDX-License-Identifier: Apache-2.0
#include "multibody/model/parameters.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/index.h"
#include "multibody/joints/joint_axes.h"

namespace slew::multibody {
namespace {

template <typename Law>
struct Member {
  std::string_view key;
  double Law::*value;
};

constexpr std::array<Member<ElementLaw>, 5> kLineMembers = {{{"spring_constant", &ElementLaw::spring},
                                                             {"damping_constant", &ElementLaw::damping},
                                                             {"free_length", &ElementLaw::free},
                                                             {"end_spring_constant", &ElementLaw::end_spring},
                                                             {"end_damping_constant", &ElementLaw::end_damping}}};
constexpr std::array<Member<ElementLaw>, 5> kAngleMembers = {{{"spring_constant", &ElementLaw::spring},
                                                              {"damping_constant", &ElementLaw::damping},
                                                              {"free_angle", &ElementLaw::free},
                                                              {"end_spring_constant", &ElementLaw::end_spring},
                                                              {"end_damping_constant", &ElementLaw::end_damping}}};
constexpr std::array<Member<JointLaw>, 4> kJointMembers = {{{"coulomb_friction", &JointLaw::coulomb},
                                                            {"viscous_friction", &JointLaw::viscous},
                                                            {"limit_stiffness", &JointLaw::limit_stiffness},
                                                            {"limit_damping", &JointLaw::limit_damping}}};
constexpr std::array<std::string_view, 3> kGravityKeys = {"gravity.x", "gravity.y", "gravity.z"};

template <typename Law, std::size_t N>
int member_index(const std::array<Member<Law>, N>& members, std::string_view key) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    if (members[i].key == key) return static_cast<int>(i);
  }
  return -1;
}

std::optional<Parameter> find_gravity(std::string_view key) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (kGravityKeys[at(axis)] == key) return Parameter{ParameterKind::gravity, axis, 0};
  }
  return std::nullopt;
}

std::optional<Parameter> member_of(ParameterKind kind, std::size_t element, int member) noexcept {
  if (member < 0) return std::nullopt;
  return Parameter{kind, static_cast<int>(element), member};
}

// the kinds of forces follow the others
ElementValue element_value(Parameter p) noexcept {
  return {static_cast<int>(p.kind) - static_cast<int>(ParameterKind::force), p.element, p.member};
}

double& law_value(Model& model, Parameter p) noexcept {
  if (p.kind >= ParameterKind::force) return value_of(model.elements, element_value(p));
  switch (p.kind) {
    case ParameterKind::line_law:
      return model.lines[at(p.element)].law.*kLineMembers[at(p.member)].value;
    case ParameterKind::angle_law:
      return model.angles[at(p.element)].law.*kAngleMembers[at(p.member)].value;
    default:
      return model.rows[at(p.element)].law.*kJointMembers[at(p.member)].value;
  }
}

}  // namespace

std::optional<Parameter> find_parameter(const Model& model, std::string_view path) noexcept {
  const std::size_t dot = path.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const std::string_view element = path.substr(0, dot), key = path.substr(dot + 1);
  if (element == "mechanics") return find_gravity(key);
  if (const int body = find_body(model, element); body > 0) {
    // mass and inertia of a flexible body are those of its modes
    const bool is_flexible = std::any_of(model.parts.begin(), model.parts.end(),
                                         [body](const FlexiblePart& part) { return part.body == body; }) ||
                             std::any_of(model.segmented.begin(), model.segmented.end(),
                                         [&](const SegmentedPart& part) { return part.name == element; });
    if (key != "mass" || is_flexible) return std::nullopt;
    return Parameter{ParameterKind::body_mass, body, 0};
  }
  for (std::size_t i = 0; i < model.lines.size(); ++i) {
    if (model.lines[i].name == element) return member_of(ParameterKind::line_law, i, member_index(kLineMembers, key));
  }
  for (std::size_t i = 0; i < model.angles.size(); ++i) {
    if (model.angles[i].name == element)
      return member_of(ParameterKind::angle_law, i, member_index(kAngleMembers, key));
  }
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const Row& row = model.rows[i];
    const bool is_ball = row.kind == RowKind::ball && row.number == 0 && !key.starts_with("limit_");
    const bool has_law = row.kind == RowKind::joint || is_ball;
    if (!has_law || model.joints[at(row.element)].name != element) continue;
    const std::string_view suffix = suffix_of(model.joints[at(row.element)].type, row.number);
    if (!key.ends_with(suffix)) continue;
    const int member = member_index(kJointMembers, key.substr(0, key.size() - suffix.size()));
    if (member >= 0) return member_of(ParameterKind::joint_law, i, member);
  }
  const ElementValue value = find_value(model.elements, element, key);
  const int kind = static_cast<int>(ParameterKind::force) + value.kind;
  return member_of(static_cast<ParameterKind>(kind), static_cast<std::size_t>(value.element), value.member);
}

bool has_parameter(const Model& model, Parameter p) noexcept {
  const auto is_below = [&p](std::size_t elements, std::size_t members) {
    return p.element >= 0 && at(p.element) < elements && p.member >= 0 && at(p.member) < members;
  };
  switch (p.kind) {
    case ParameterKind::body_mass:
      return p.element > 0 && is_below(model.bodies.size(), 1) && model.bodies[at(p.element)].lumped >= 0;
    case ParameterKind::line_law:
      return is_below(model.lines.size(), kLineMembers.size());
    case ParameterKind::angle_law:
      return is_below(model.angles.size(), kAngleMembers.size());
    case ParameterKind::joint_law:
      return is_below(model.rows.size(), kJointMembers.size());
    case ParameterKind::gravity:
      return is_below(kGravityKeys.size(), 1);
    case ParameterKind::force:
      break;
  }
  return has_value(model.elements, element_value(p));
}

bool is_linear_force(ParameterKind kind) noexcept {
  auto number = static_cast<int>(ParameterKind::force);
  bool is_linear = false;
  for_each_force_kind([&](auto row) {
    if (static_cast<int>(kind) == number++) is_linear = row.kIsLinear;
  });
  return is_linear;
}

std::size_t parameter_count(const Model& model) noexcept {
  const auto joint_rows =
      static_cast<std::size_t>(std::count_if(model.rows.begin(), model.rows.end(), [](const Row& row) {
        return row.kind == RowKind::joint || row.kind == RowKind::ball;
      }));
  const std::size_t moving_bodies = model.bodies.size() - 1;  // [0] is Ground
  return kGravityKeys.size() + moving_bodies + model.lines.size() * kLineMembers.size() +
         model.angles.size() * kAngleMembers.size() + joint_rows * kJointMembers.size() + value_count(model.elements);
}

double get_parameter(const Model& model, Parameter parameter) noexcept {
  switch (parameter.kind) {
    case ParameterKind::body_mass:
      return model.lumped[at(model.bodies[at(parameter.element)].lumped)].mass;
    case ParameterKind::gravity:
      return model.gravity[parameter.element];
    default:
      return law_value(const_cast<Model&>(model), parameter);
  }
}

void set_parameter(Model& model, Parameter parameter, double value) noexcept {
  switch (parameter.kind) {
    case ParameterKind::body_mass:
      set_body_mass(model, parameter.element, value);
      break;
    case ParameterKind::gravity: {
      Triple g = model.gravity.array();
      g[at(parameter.element)] = value;
      model.gravity = math::Vec3(g);
      break;
    }
    default:
      law_value(model, parameter) = value;
      mark_used_elements(model);
      break;
  }
}

void set_body_mass(Model& model, int body, double mass) noexcept {
  LumpedMass& part = model.lumped[at(model.bodies[at(body)].lumped)];
  part.mass = mass;
  if (part.link > 0) lump_link(model, part.link);
}

}  // namespace slew::multibody
