// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/rope.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "multibody/forces/build_elements.h"
#include "multibody/forces/stiffness_sum.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

constexpr double kWinchRamp = 1.0;   // s
constexpr double kSamePoint = 1e-6;  // m, as joint frames

constexpr Field kRopeFields[] = {
    field<&RopeDef::bodies>("bodies", {.presence = Presence::required,
                                       .reference = "body",
                                       .doc = "body of each point, from end to end of the rope"}),
    field<&RopeDef::points>(
        "points", {.dimension = Dimension::length, .presence = Presence::required, .doc = "points, each in its body"}),
    field<&RopeDef::free_length>("free_length", {.dimension = Dimension::length,
                                                 .range = kPositive,
                                                 .presence = Presence::required,
                                                 .change = Change::live,
                                                 .ramp = kWinchRamp,
                                                 .doc = "length below which the rope is slack"}),
    field<&RopeDef::stiffness>("stiffness", {.dimension = Dimension::stiffness,
                                             .range = kNotNegative,
                                             .change = Change::live,
                                             .doc = "spring of the rope"}),
    field<&RopeDef::axial_rigidity>("axial_rigidity", {.dimension = Dimension::force,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "E A, instead of stiffness: E A / free_length"}),
    field<&RopeDef::damping_constant>("damping_constant",
                                      {.dimension = Dimension::damping,
                                       .range = kNotNegative,
                                       .change = Change::live,
                                       .doc = "damper of the rope, with at most the spring's force"}),
    field<&RopeDef::spring_table>("spring_table", {.dimension = Dimension::length,
                                                   .value_dimension = Dimension::force,
                                                   .range = kNotNegative,
                                                   .doc = "tension over stretch from [0, 0], instead of stiffness"}),
    field<&RopeDef::damper_table>("damper_table",
                                  {.dimension = Dimension::velocity,
                                   .value_dimension = Dimension::force,
                                   .doc = "force over the rate of length, instead of a damping_constant"}),
};

constexpr std::array<std::string_view, 4> kRopeKeys = {"free_length", "stiffness", "axial_rigidity",
                                                       "damping_constant"};

// points nearer than this have no direction between them; a rope does not pull there
constexpr double kShortest = 1e-12;  // m

struct PointMotion {
  Vec3 P, v;
};

const LinkMotion& link_of(const RopePoint& point, std::span<const LinkMotion> motion) noexcept {
  return motion[static_cast<std::size_t>(point.link)];
}

PointMotion motion_of(const RopePoint& point, std::span<const LinkMotion> motion) noexcept {
  const LinkMotion& link = link_of(point, motion);
  const Vec3 s = link.R * point.p_L;
  return {link.p + s, link.v + cross(link.w, s)};
}

double spring_tension(const Rope& rope, double stretch) noexcept {
  if (!rope.spring_curve.empty()) return math::value_at(rope.spring_curve, stretch);
  return (rope.rigidity > 0 ? rope.rigidity / rope.free_length : rope.spring) * stretch;
}

double damper_tension(const Rope& rope, double rate) noexcept {
  return rope.damper_curve.empty() ? rope.damping * rate : math::value_at(rope.damper_curve, rate);
}

// gradient of the length by the point
Vec3 length_gradient(const Rope& rope, std::size_t k, std::span<const LinkMotion> motion) noexcept {
  const Vec3 P = position_of(rope, k, motion);
  Vec3 g;
  if (k > 0) g += direction(position_of(rope, k - 1, motion), P);
  if (k + 1 < rope.points.size()) g += direction(position_of(rope, k + 1, motion), P);
  return g;
}

}  // namespace

Vec3 direction(Vec3 from, Vec3 to) noexcept {
  const Vec3 d = to - from;
  const double length = norm(d);
  return length > kShortest ? d * (1 / length) : Vec3();
}

Vec3 position_of(const Rope& rope, std::size_t k, std::span<const LinkMotion> motion) noexcept {
  return motion_of(rope.points[k], motion).P;
}

RopeState state_of(const Rope& rope, std::span<const LinkMotion> motion) noexcept {
  RopeState state;
  PointMotion near = motion_of(rope.points.front(), motion);
  for (std::size_t k = 1; k < rope.points.size(); ++k) {
    const PointMotion far = motion_of(rope.points[k], motion);
    state.length += norm(far.P - near.P);
    state.rate += dot(direction(near.P, far.P), far.v - near.v);
    near = far;
  }
  const double stretch = state.length - rope.free_length;
  state.slack = std::max(0.0, -stretch);
  if (!(stretch > 0)) return state;
  const LimitedForce limited = limited_force(spring_tension(rope, stretch), damper_tension(rope, state.rate));
  state.tension = limited.force;
  state.springs = limited.springs;
  return state;
}

RopeSlopes slopes_of(const Rope& rope, const RopeState& state) noexcept {
  if (state.springs == 0) return {};
  const double stretch = state.length - rope.free_length;
  const double spring =
      rope.spring_curve.empty() ? spring_tension(rope, 1) : math::slope_at(rope.spring_curve, stretch);
  const double damper = rope.damper_curve.empty() ? rope.damping : math::slope_at(rope.damper_curve, state.rate);
  return {state.springs * std::max(0.0, spring), state.springs == 1 ? std::max(0.0, damper) : 0.0};
}

double stored_energy(const Rope& rope, const RopeState& state) noexcept {
  const double stretch = std::max(0.0, state.length - rope.free_length);
  if (!rope.spring_curve.empty()) return math::integral_to(rope.spring_curve, stretch);
  return 0.5 * spring_tension(rope, stretch) * stretch;
}

Wrench wrench_on(const Rope& rope, std::size_t k, double tension, std::span<const LinkMotion> motion) noexcept {
  const Vec3 P = motion_of(rope.points[k], motion).P;
  Vec3 pull;
  if (k > 0) pull += direction(P, motion_of(rope.points[k - 1], motion).P);
  if (k + 1 < rope.points.size()) pull += direction(P, motion_of(rope.points[k + 1], motion).P);
  return wrench_at(P, link_of(rope.points[k], motion), pull * tension);
}

std::span<const Field> rope_fields() noexcept {
  return kRopeFields;
}

Rope RopeRow::build(const RopeDef& def, ElementBuilder& builder) {
  Rope rope{.name = def.name,
            .points = {},
            .free_length = def.free_length,
            .spring = def.stiffness,
            .rigidity = def.axial_rigidity,
            .damping = def.damping_constant,
            .spring_curve = math::monotone_cubic(def.spring_table, math::Ends::not_falling),
            .damper_curve = math::monotone_cubic(def.damper_table, math::Ends::not_falling)};
  for (std::size_t k = 0; k < def.points.size(); ++k) {
    const int body = builder.number_of(def.bodies[k]);
    rope.points.push_back({builder.body_at(body).link, body, builder.in_link(body, def.points[k])});
  }
  return rope;
}

void RopeRow::check(const RopeDef& def, ElementRules& rules) {
  for (const std::string& body : def.bodies) rules.check_body(def.name, "bodies", body);
  if (def.points.size() < 2 || def.bodies.size() != def.points.size()) {
    rules.add_broken_reference(def.name + ".points",
                               fmt::format("there are {} points for {} bodies", def.points.size(), def.bodies.size()),
                               "two points or more, and a body for each");
  } else if (std::count(def.bodies.begin(), def.bodies.end(), def.bodies.front()) ==
             static_cast<std::ptrdiff_t>(def.bodies.size())) {
    rules.add(def.name + ".bodies", fmt::format("all points are on '{}'", def.bodies.front()), "two bodies or more");
  }
  const int springs = (def.stiffness > 0) + (def.axial_rigidity > 0) + !def.spring_table.empty();
  if (springs != 1) {
    rules.add(def.name, springs == 0 ? "the rope has no spring" : "the rope has several springs",
              "one of stiffness, axial_rigidity and spring_table");
  }
  if (def.damping_constant > 0 && !def.damper_table.empty()) {
    rules.add(def.name + ".damper_table", "the rope has a damping_constant as well", "one of the two");
  }
  rules.check_table(def.name + ".spring_table", def.spring_table, TableUse::rope_spring);
  rules.check_table(def.name + ".damper_table", def.damper_table, TableUse::damper);
}

void RopeRow::check_start(const RopeDef& def, ElementStartRules& rules) {
  const auto place = [&](std::size_t k) {
    const Pose& pose = rules.pose_of(def.bodies[k]);
    return pose.p + pose.R * Vec3(def.points[k]);
  };
  for (std::size_t k = 1; k < def.points.size(); ++k) {
    if (norm(place(k) - place(k - 1)) > kSamePoint) continue;
    rules.add(def.name + ".points", fmt::format("points {} and {} coincide at the start", k, k + 1),
              "neighbours that stay apart");
  }
}

// A rope has one spring and one damper.
std::string RopeRow::obstacle_of_change(const RopeDef& def, const Field& field) {
  if (field.key == "damping_constant" && !def.damper_table.empty()) return "the rope has a damper_table";
  const bool is_spring = field.key == "stiffness" || field.key == "axial_rigidity";
  if (!is_spring || (field.key == "stiffness" ? def.stiffness : def.axial_rigidity) > 0) return {};
  return std::string("the rope has its spring by ") + (!def.spring_table.empty() ? "spring_table"
                                                       : def.stiffness > 0       ? "stiffness"
                                                                                 : "axial_rigidity");
}

void RopeRow::visit_points(RopeDef& def, const VisitPoint& visit) {
  for (std::size_t k = 0; k < std::min(def.bodies.size(), def.points.size()); ++k) visit(def.bodies[k], &def.points[k]);
}

void RopeRow::add_stiffness(const Rope& rope, StiffnessSum& sum) noexcept {
  const std::span<const LinkMotion> motion = sum.motion();
  const RopeState state = state_of(rope, motion);
  const RopeSlopes slopes = slopes_of(rope, state);
  const double along = sum.weights().position * slopes.stiffness + sum.weights().rate * slopes.damping;
  const auto arm = [&](std::size_t k) { return position_of(rope, k, motion) - link_of(rope.points[k], motion).p; };
  for (std::size_t a = 0; a < rope.points.size() && along > 0; ++a) {
    for (std::size_t b = 0; b < rope.points.size(); ++b) {
      sum.add_points(rope.points[a].link, arm(a), rope.points[b].link, arm(b),
                     outer(length_gradient(rope, a, motion), length_gradient(rope, b, motion)) * along);
    }
  }
  for (std::size_t k = 0; k + 1 < rope.points.size() && state.tension > 0; ++k) {
    const Vec3 P1 = position_of(rope, k, motion), P2 = position_of(rope, k + 1, motion);
    const Vec3 e = direction(P1, P2);
    if (dot(e, e) == 0) continue;
    const Mat3 across = Mat3::identity() - outer(e, e);
    sum.add_stretch(rope.points[k].link, P1, rope.points[k + 1].link, P2,
                    across * (sum.pull_weight() * state.tension / norm(P2 - P1)));
  }
}

void RopeRow::list_variables(const Rope& rope, VariableNames& names) {
  names.add(rope.name + ".length", Dimension::length);
  names.add(rope.name + ".rate", Dimension::velocity);
  names.add(rope.name + ".slack", Dimension::length);
  names.add(rope.name + ".tension", Dimension::force);
}

void RopeRow::read_variables(const Rope& rope, std::span<const LinkMotion> motion, double /*time*/,
                             VariableSink& sink) noexcept {
  const RopeState state = state_of(rope, motion);
  for (const double value : {state.length, state.rate, state.slack, state.tension}) sink.put(value);
}

std::span<const std::string_view> RopeRow::value_keys(const Rope& /*rope*/) noexcept {
  return kRopeKeys;
}

double* RopeRow::value(Rope& rope, std::size_t index) noexcept {
  double* const values[] = {&rope.free_length, &rope.spring, &rope.rigidity, &rope.damping};
  return values[index];
}

}  // namespace slew::multibody
