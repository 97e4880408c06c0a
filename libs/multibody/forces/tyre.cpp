// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/tyre.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "multibody/forces/build_elements.h"
#include "multibody/forces/force_fields.h"
#include "multibody/forces/stiffness_sum.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

constexpr double kFlatWheel = 0.1;  // sine of the angle between axle and normal at the start

constexpr std::array<std::string_view, 2> kTyreRolling = {"free", "with_body"};

// a free wheel has no longitudinal slip
constexpr ReadBy kReadByDrivenWheel[] = {
    read_by<&TyreDummyDef::rolling, TyreRolling::with_body>("rolling", "rolling: with_body")};

constexpr Field kTyreDummyFields[] = {
    required_body<&TyreDummyDef::relative_to>("relative_to", "body that carries the wheel"),
    field<&TyreDummyDef::position>("position", {.dimension = Dimension::length, .doc = "wheel's centre in the body"}),
    field<&TyreDummyDef::orientation>(
        "orientation", {.dimension = Dimension::angle, .doc = "Euler rotations z, x', z''; the axle is z"}),
    dummy_mass<&TyreDummyDef::mass>("mass of wheel and tyre"),
    field<&TyreDummyDef::inertia>("inertia", {.dimension = Dimension::inertia,
                                              .range = kNotNegative,
                                              .doc = "moments about the centre; Izz of a free wheel has no effect"}),
    field<&TyreDummyDef::rolling>(
        "rolling",
        {.choices = kTyreRolling, .doc = "free: turns on its axle; with_body: driven, braked, or its own body"}),
    field<&TyreDummyDef::radius>("radius", {.dimension = Dimension::length,
                                            .range = kPositive,
                                            .presence = Presence::required,
                                            .doc = "radius without load, at which it also rolls"}),
    field<&TyreDummyDef::ground_normal>("ground_normal", {.doc = "upward normal of the ground, Ground axes"}),
    field<&TyreDummyDef::ground_height>(
        "ground_height",
        {.dimension = Dimension::length, .change = Change::live, .doc = "ground along its normal, from the origin"}),
    field<&TyreDummyDef::stiffness>("stiffness", {.dimension = Dimension::stiffness,
                                                  .range = kPositive,
                                                  .presence = Presence::required,
                                                  .change = Change::live,
                                                  .doc = "spring between wheel and ground"}),
    field<&TyreDummyDef::damping>("damping", {.dimension = Dimension::damping,
                                              .range = kNotNegative,
                                              .change = Change::live,
                                              .doc = "damper, with at most the spring's force"}),
    field<&TyreDummyDef::friction>(
        "friction", {.range = kPositive, .change = Change::live, .doc = "largest slip force over normal force"}),
    field<&TyreDummyDef::longitudinal_slip_slope>("longitudinal_slip_slope",
                                                  {.range = kNotNegative,
                                                   .read_by = kReadByDrivenWheel,
                                                   .doc = "longitudinal force over normal force, per slip"}),
    field<&TyreDummyDef::lateral_slip_slope>(
        "lateral_slip_slope",
        {.range = kNotNegative, .doc = "lateral force over normal force, per tangent of the slip angle"}),
    field<&TyreDummyDef::rolling_resistance>(
        "rolling_resistance",
        {.range = kFraction, .change = Change::live, .doc = "resistance over normal force, also without slip"}),
    field<&TyreDummyDef::slip_speed>(
        "slip_speed",
        {.dimension = Dimension::velocity, .range = kPositive, .doc = "speed below which slip acts as a damper"}),
};

constexpr std::array<std::string_view, 5> kTyreKeys = {"ground_height", "stiffness", "damping", "friction",
                                                       "rolling_resistance"};

constexpr double kFlat = 1e-3;      // a disc that lies flat has no lowest point
constexpr double kNoSlip = 1e-150;  // below it (4) is its limit for G = 0

// Speeds of the wheel over the ground, and what slip is divided by.
struct Rolling {
  Vec3 v_P;
  double forwards = 0, rim = 0;
  double v_e = 0, r_e = 0;
};

Rolling rolling_of(const Tyre& tyre, const LinkMotion& link, const TyreState& state) noexcept {
  Rolling rolling;
  const Vec3 arm = state.Q - state.C;
  const double turning = dot(state.axle, link.w);
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  rolling.v_P = v_C + cross(link.w - state.axle * turning, arm);
  rolling.forwards = dot(rolling.v_P, state.t);
  rolling.rim = tyre.radius * turning;
  rolling.v_e = std::sqrt(rolling.forwards * rolling.forwards + tyre.slip_speed * tyre.slip_speed);
  rolling.r_e = std::sqrt(rolling.rim * rolling.rim + tyre.slip_speed * tyre.slip_speed);
  return rolling;
}

// mu tanh(G/mu)/G of (4)
double slip_share(const Tyre& tyre, const TyreState& state) noexcept {
  const double x = tyre.longitudinal * state.slip, y = tyre.lateral * state.lateral_slip;
  const double G = std::sqrt(x * x + y * y);
  return G > kNoSlip ? tyre.friction * std::tanh(G / tyre.friction) / G : 1.0;
}

// (3) and (4)
void add_slip(const Tyre& tyre, const LinkMotion& link, TyreState& state) noexcept {
  const Rolling rolling = rolling_of(tyre, link, state);
  const double N = state.normal_force;
  state.lateral_slip = -dot(rolling.v_P, state.l) / rolling.v_e;
  if (tyre.rolling == TyreRolling::with_body) {
    state.slip = -(rolling.forwards - rolling.rim) / rolling.v_e;
    state.axle_moment = -tyre.rolling_resistance * N * tyre.radius * rolling.rim / rolling.r_e;
  }
  const double share = slip_share(tyre, state);
  const double x = tyre.longitudinal * state.slip, y = tyre.lateral * state.lateral_slip;
  state.lateral_force = N * share * y;
  state.longitudinal_force = tyre.rolling == TyreRolling::with_body
                                 ? N * share * x
                                 : -tyre.rolling_resistance * N * rolling.forwards / rolling.v_e;
}

// delta' of (1)
double depth_rate(const Tyre& tyre, const TyreState& state, const LinkMotion& link) noexcept {
  const Vec3 n = tyre.normal_W;
  const double b = dot(n, state.axle);
  const double s = std::sqrt(std::max(0.0, 1 - b * b));
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  return -dot(n, v_C) - tyre.radius * b * dot(n, cross(link.w, state.axle)) / s;
}

}  // namespace

TyreState state_of(const Tyre& tyre, const LinkMotion& link) noexcept {
  TyreState state;
  const Vec3 n = tyre.normal_W;
  state.C = link.p + link.R * tyre.c_L;
  state.axle = link.R * tyre.axle_L;
  const double b = dot(n, state.axle);
  const double s = std::sqrt(std::max(0.0, 1 - b * b));
  if (s < kFlat) return state;
  state.Q = state.C - (n - state.axle * b) * (tyre.radius / s);
  state.t = cross(state.axle, n) * (1 / s);
  state.l = cross(n, state.t);
  state.depth = tyre.height - dot(n, state.Q);
  state.depth_rate = depth_rate(tyre, state, link);
  if (!(state.depth > 0)) return state;
  // (2)
  const LimitedForce limited = limited_force(tyre.stiffness * state.depth, tyre.damping * state.depth_rate);
  state.normal_force = limited.force;
  state.springs = limited.springs;
  add_slip(tyre, link, state);
  return state;
}

Wrench wrench_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link) noexcept {
  if (!(state.depth > 0)) return {};
  const Vec3 at_contact = tyre.normal_W * state.normal_force + state.l * state.lateral_force;
  const Vec3 forwards = state.t * state.longitudinal_force;
  if (tyre.rolling == TyreRolling::with_body) {
    return wrench_at(state.Q, link, at_contact + forwards, state.axle * state.axle_moment);
  }
  const Wrench side = wrench_at(state.Q, link, at_contact), hub = wrench_at(state.C, link, forwards);
  return {side.f + hub.f, side.n + hub.n};
}

TyreSlopes slopes_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link, ChangeWeights weights) noexcept {
  TyreSlopes slopes;
  if (!(state.depth > 0)) return slopes;
  slopes.normal =
      state.springs * weights.position * tyre.stiffness + (state.springs == 1 ? weights.rate * tyre.damping : 0.0);
  const Rolling rolling = rolling_of(tyre, link, state);
  const double grip = weights.rate * state.normal_force * slip_share(tyre, state) / rolling.v_e;
  const double resistance = weights.rate * tyre.rolling_resistance * state.normal_force;
  slopes.lateral = grip * tyre.lateral;
  if (tyre.rolling == TyreRolling::with_body) {
    slopes.longitudinal = grip * tyre.longitudinal;
    slopes.axle = resistance * tyre.radius * tyre.radius / rolling.r_e;
  } else {
    slopes.longitudinal = resistance / rolling.v_e;
  }
  return slopes;
}

double stored_energy(const Tyre& tyre, const TyreState& state) noexcept {
  const double depth = std::max(0.0, state.depth);
  return 0.5 * tyre.stiffness * depth * depth;
}

std::span<const Field> tyre_fields() noexcept {
  return kTyreDummyFields;
}

Tyre TyreRow::build(const TyreDummyDef& def, ElementBuilder& builder) {
  const int number = builder.number_of(def.relative_to);
  const Body& body = builder.body_at(number);
  Triple inertia = def.inertia;
  if (def.rolling == TyreRolling::free) inertia[2] = 0;
  builder.add_mass(number, builder.pose_in(builder.pose_at(number), def.position, def.orientation), def.mass, Vec3(),
                   inertia);
  return {.name = def.name,
          .link = body.link,
          .body = number,
          .c_L = builder.in_link(number, def.position),
          .axle_L = body.R_LB * math::rotation_zxz(def.orientation).c[2],
          .normal_W = Vec3(def.ground_normal) * (1 / norm(Vec3(def.ground_normal))),
          .height = def.ground_height,
          .radius = def.radius,
          .stiffness = def.stiffness,
          .damping = def.damping,
          .friction = def.friction,
          .longitudinal = def.longitudinal_slip_slope,
          .lateral = def.lateral_slip_slope,
          .rolling_resistance = def.rolling_resistance,
          .slip_speed = def.slip_speed,
          .rolling = def.rolling};
}

void TyreRow::check(const TyreDummyDef& def, ElementRules& rules) {
  if (rules.check_body(def.name, "relative_to", def.relative_to) && def.relative_to == kGroundName) {
    rules.add(def.name + ".relative_to", "the wheel is on Ground, which does not move", "a body");
  }
  rules.check_direction(def.name + ".ground_normal", def.ground_normal);
  rules.check_inertia(def.name, def.inertia);
}

void TyreRow::check_start(const TyreDummyDef& def, ElementStartRules& rules) {
  const Vec3 axle = rules.pose_of(def.relative_to).R * math::rotation_zxz(def.orientation).c[2];
  const Vec3 normal(def.ground_normal);
  if (norm(cross(axle, normal)) > kFlatWheel * norm(normal)) return;
  rules.add(def.name + ".orientation", "the axle stands on the ground at the start",
            "an axle, z of the dummy's frame, along the ground");
}

void TyreRow::add_stiffness(const Tyre& tyre, StiffnessSum& sum) noexcept {
  const LinkMotion& link = sum.motion()[static_cast<std::size_t>(tyre.link)];
  const TyreState state = state_of(tyre, link);
  if (tyre.link == 0 || !(state.depth > 0)) return;
  const TyreSlopes slopes = slopes_of(tyre, state, link, sum.weights());
  const Mat3 forwards = outer(state.t, state.t) * slopes.longitudinal;
  Mat3 at_ground = outer(tyre.normal_W, tyre.normal_W) * slopes.normal + outer(state.l, state.l) * slopes.lateral;
  if (tyre.rolling == TyreRolling::with_body) {
    at_ground += forwards;
  } else {
    sum.add_relative(0, tyre.link, state.C, {forwards, {}, {}});
  }
  sum.add_relative(0, tyre.link, state.Q, {at_ground, {}, outer(state.axle, state.axle) * slopes.axle});
}

void TyreRow::list_variables(const Tyre& tyre, VariableNames& names) {
  names.add(tyre.name + ".deflection", Dimension::length);
  names.add(tyre.name + ".normal_force", Dimension::force);
  names.add(tyre.name + ".longitudinal_force", Dimension::force);
  names.add(tyre.name + ".lateral_force", Dimension::force);
  names.add(tyre.name + ".slip", Dimension::none);
  names.add(tyre.name + ".slip_angle", Dimension::angle);
}

void TyreRow::read_variables(const Tyre& tyre, std::span<const LinkMotion> motion, double /*time*/,
                             VariableSink& sink) noexcept {
  const TyreState state = state_of(tyre, motion[static_cast<std::size_t>(tyre.link)]);
  for (const double value : {std::fmax(0.0, state.depth), state.normal_force, state.longitudinal_force,
                             state.lateral_force, state.slip, std::atan(state.lateral_slip)}) {
    sink.put(value);
  }
}

std::span<const std::string_view> TyreRow::value_keys(const Tyre& /*tyre*/) noexcept {
  return kTyreKeys;
}

double* TyreRow::value(Tyre& tyre, std::size_t index) noexcept {
  double* const values[] = {&tyre.height, &tyre.stiffness, &tyre.damping, &tyre.friction, &tyre.rolling_resistance};
  return values[index];
}

}  // namespace slew::multibody
