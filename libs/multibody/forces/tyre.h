// SPDX-License-Identifier: Apache-2.0
// Forces of a plane on a wheel: a thin disc of radius R with its centre C and its axle on a body.
//
// n: normal of the plane n . x = h, a: axle, b = n . a, s = sqrt(1 - b^2). The disc's lowest point and its depth are
//   Q = C + R d,   d = -(n - b a)/s,   delta = h - n . Q,   delta' = -n . v_C - R b (n . a')/s        (1)
//   N = k delta + min(k delta, max(-k delta, c delta')) while delta > 0, else 0, along n at Q         (2)
// The damper carries at most what the spring does, so that N never pulls and begins without a jump. In the plane, with
// t = a x n/s, where a wheel of positive speed about its axle rolls, l = n x t along the axle, v_P the velocity of Q on
// a wheel that does not turn, and Omega the wheel's speed,
//   v_e = sqrt((v_P . t)^2 + v_0^2),   kappa = -(v_P . t - R Omega)/v_e,   sigma = -(v_P . l)/v_e     (3)
//   G = sqrt((C_x kappa)^2 + (C_y sigma)^2),   [F_x F_y] = N mu tanh(G/mu)/G [C_x kappa  C_y sigma]   (4)
// A wheel that turns with its body has Omega = a . w and its F_x acts at Q; with r = R Omega the moment
// -f N R r/sqrt(r^2 + v_0^2) about the axle resists. A free wheel has kappa = 0 and no moment about its axle;
// f N (v_P . t)/v_e holds C back. Every part but k takes energy only.
//
// Source: combined slip as one vector that a saturating function limits, as in Pacejka 2012, chapter 3 (similarity of
// pure slips), with tanh for the brush model's parabola. Not covered: spin inertia of a free wheel, relaxation length,
// aligning torque, camber thrust; below v_0 slip is a damper and a parked wheel creeps (card: docs/models/
// multibody_tyre.md). A wheel whose axle is along the normal (s < 1e-3) has no force.
#pragma once

#include <string>
#include <vector>

#include "multibody/forces/force_row.h"
#include "multibody/forces/limited_damper.h"

namespace slew::multibody {

// Whether a tyre's wheel turns with the body that carries it.
enum class TyreRolling : int { free, with_body };

// Wheel with its mass and the forces of the ground on it. Dummy's frame: origin in the wheel's centre, z along the
// axle.
struct TyreDummyDef {
  std::string name{};
  std::string relative_to{};  // body
  Triple position{};          // m, wheel's centre in the body
  Triple orientation{};       // rad, Euler z-x'-z''
  double mass = 0;            // kg
  Triple inertia{};           // kg m2 about the centre, dummy's frame; Izz has no effect on a wheel that turns freely
  TyreRolling rolling = TyreRolling::free;
  double radius = 0;                    // m, without load
  Triple ground_normal{0, 1, 0};        // of any length but 0, Ground axes
  double ground_height = 0;             // m, of the plane along its normal, from Ground's origin
  double stiffness = 0;                 // N/m
  double damping = 0;                   // N s/m
  double friction = 0.8;                // largest friction over normal force
  double longitudinal_slip_slope = 10;  // friction over normal force, per slip
  double lateral_slip_slope = 10;       // the same per tangent of the slip angle
  double rolling_resistance = 0;        // share of the normal force
  double slip_speed = 0.1;              // m/s, below which slip is a damper
};

struct Tyre {
  std::string name;
  int link = 0, body = 0;
  math::Vec3 c_L;                        // m, wheel's centre in the link
  math::Vec3 axle_L;                     // unit
  math::Vec3 normal_W;                   // n, unit, Ground axes
  double height = 0;                     // h [m]
  double radius = 0;                     // R [m]
  double stiffness = 0, damping = 0;     // k [N/m], c [N s/m]
  double friction = 0;                   // mu
  double longitudinal = 0, lateral = 0;  // C_x, C_y
  double rolling_resistance = 0;         // f
  double slip_speed = 0;                 // v_0 [m/s]
  TyreRolling rolling = TyreRolling::free;
};

struct TyreState {
  math::Vec3 C, Q;                // m, Ground
  math::Vec3 t, l, axle;          // unit, Ground axes
  double depth = 0;               // delta [m], negative in the air
  double depth_rate = 0;          // delta' [m/s]
  double normal_force = 0;        // N [N]
  int springs = 0;                // LimitedForce of (2)
  double longitudinal_force = 0;  // F_x [N]; of a free wheel its resistance
  double lateral_force = 0;       // F_y [N]
  double axle_moment = 0;         // N m, on the wheel about its axle
  double slip = 0;                // kappa
  double lateral_slip = 0;        // sigma
};

[[nodiscard]] TyreState state_of(const Tyre& tyre, const LinkMotion& link) noexcept;
[[nodiscard]] Wrench wrench_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link) noexcept;
// Directions in which the ground holds the wheel: a force A (s, e) . u on the velocity of the point at Q or C along e,
// and about the axle; position K + rate D of (2), the secant of (4) over the speed.
struct TyreSlopes {
  double normal = 0;        // along n at Q
  double lateral = 0;       // along l at Q
  double longitudinal = 0;  // along t, at Q (with_body) or at C
  double axle = 0;          // about the axle
};
[[nodiscard]] TyreSlopes slopes_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link,
                                   ChangeWeights weights) noexcept;
[[nodiscard]] double stored_energy(const Tyre& tyre, const TyreState& state) noexcept;  // k delta^2/2 [J]

[[nodiscard]] std::span<const Field> tyre_fields() noexcept;

struct TyreRow : ForceRow<Tyre> {
  struct Defs {
    std::vector<TyreDummyDef> tyre_dummies;
  };
  struct Elements {
    std::vector<Tyre> tyres;
  };
  static constexpr auto kElements = &Elements::tyres;
  static constexpr std::tuple kTypes{ForceType{
      "dummies", "tyre", "wheel with mass and the forces of a plane ground on it", tyre_fields, &Defs::tyre_dummies}};

  static Tyre build(const TyreDummyDef& def, ElementBuilder& builder);
  static void check(const TyreDummyDef& def, ElementRules& rules);
  static void check_start(const TyreDummyDef& def, ElementStartRules& rules);
  static void visit_points(TyreDummyDef& def, const VisitPoint& visit) { visit(def.relative_to, &def.position); }

  template <typename Add>
  static void for_each_wrench(const Tyre& tyre, std::span<const LinkMotion> motion, double /*time*/,
                              Add&& add) noexcept {
    const LinkMotion& link = motion[static_cast<std::size_t>(tyre.link)];
    const TyreState state = state_of(tyre, link);
    if (state.depth > 0) add(tyre.link, tyre.body, wrench_of(tyre, state, link));
  }
  static double energy(const Tyre& tyre, std::span<const LinkMotion> motion) noexcept {
    return stored_energy(tyre, state_of(tyre, motion[static_cast<std::size_t>(tyre.link)]));
  }

  static constexpr bool kHasSlopes = true;
  static void add_stiffness(const Tyre& tyre, StiffnessSum& sum) noexcept;
  static constexpr bool kHasStops = true;
  static StopMotion stop_of(const Tyre& tyre, std::span<const LinkMotion> motion) noexcept {
    const TyreState state = state_of(tyre, motion[static_cast<std::size_t>(tyre.link)]);
    return {state.springs, state.depth, state.depth_rate, state.depth, state.depth_rate};
  }

  static void list_variables(const Tyre& tyre, VariableNames& names);
  static void read_variables(const Tyre& tyre, std::span<const LinkMotion> motion, double time,
                             VariableSink& sink) noexcept;
  static std::span<const std::string_view> value_keys(const Tyre& tyre) noexcept;
  static double* value(Tyre& tyre, std::size_t index) noexcept;
};

}  // namespace slew::multibody
