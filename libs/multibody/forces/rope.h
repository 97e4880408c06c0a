// SPDX-License-Identifier: Apache-2.0
// A wire rope over points on bodies: one tension all along it, over frictionless pulleys without radius.
//
//   L = sum |P_k+1 - P_k|,   s = L - L_0,   T = T_s + min(T_s, max(-T_s, T_d)) while s > 0, else 0    (1)
//   T_s = k s or the table at s,   T_d = d L' or the table at L',   k = EA/L_0 where EA is given
// The damper carries at most what the spring does: the tension begins and ends at zero without a jump, never pushes,
// and the damper only takes energy. On point k acts T (e_k,k+1 + e_k,k-1), e the unit vectors towards its neighbours.
//
// Not covered: mass, bending and sag of the rope, friction and inertia of pulleys; the speed at which L_0 is changed
// does not enter the damper. Card: docs/models/multibody_rope.md.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "math/monotone_cubic.h"
#include "multibody/forces/force_row.h"
#include "multibody/forces/limited_damper.h"

namespace slew::multibody {

// Rope over points[k] on bodies[k].
struct RopeDef {
  std::string name{};
  std::vector<std::string> bodies{};
  std::vector<Triple> points{};  // m, each in its body's frame
  double free_length = 0;        // m
  double stiffness = 0;          // N/m, of the whole rope
  double axial_rigidity = 0;     // N, E times A: stiffness = axial_rigidity / free_length
  double damping_constant = 0;   // N s/m
  Table spring_table{};          // m of stretch, N; goes on with its last slope
  Table damper_table{};          // m/s, N; never falls beyond its ends
};

struct RopePoint {
  int link = 0, body = 0;
  math::Vec3 p_L;  // m, in the link
};

struct Rope {
  std::string name;
  std::vector<RopePoint> points;  // from one end to the other, two or more
  double free_length = 0;         // L_0 [m], > 0
  double spring = 0;              // k [N/m], of the whole rope; 0: by rigidity or table
  double rigidity = 0;            // EA [N]
  double damping = 0;             // d [N s/m]
  math::MonotoneCubic spring_curve, damper_curve;
};

struct RopeState {
  double length = 0;   // L [m]
  double rate = 0;     // L' [m/s]
  double slack = 0;    // max(0, L_0 - L) [m]
  double tension = 0;  // T [N]
  int springs = 0;     // LimitedForce
};

// motion: of all links.
[[nodiscard]] RopeState state_of(const Rope& rope, std::span<const LinkMotion> motion) noexcept;
[[nodiscard]] double stored_energy(const Rope& rope, const RopeState& state) noexcept;  // J

// Slopes of the tension over L and L', where they rise.
struct RopeSlopes {
  double stiffness = 0;  // N/m
  double damping = 0;    // N s/m
};
[[nodiscard]] RopeSlopes slopes_of(const Rope& rope, const RopeState& state) noexcept;

// Points and the unit vector from point k to point k + 1, Ground; zero where both are in one place.
[[nodiscard]] math::Vec3 position_of(const Rope& rope, std::size_t k, std::span<const LinkMotion> motion) noexcept;
[[nodiscard]] math::Vec3 direction(math::Vec3 from, math::Vec3 to) noexcept;

// On the link of point k, by the tension of state_of().
[[nodiscard]] Wrench wrench_on(const Rope& rope, std::size_t k, double tension,
                               std::span<const LinkMotion> motion) noexcept;

[[nodiscard]] std::span<const Field> rope_fields() noexcept;

struct RopeRow : ForceRow<Rope> {
  struct Defs {
    std::vector<RopeDef> ropes;
  };
  struct Elements {
    std::vector<Rope> ropes;
  };
  static constexpr auto kElements = &Elements::ropes;
  static constexpr std::tuple kTypes{
      ForceType{"forces", "rope", "wire rope over points of bodies", rope_fields, &Defs::ropes}};

  static Rope build(const RopeDef& def, ElementBuilder& builder);
  static void check(const RopeDef& def, ElementRules& rules);
  static void check_start(const RopeDef& def, ElementStartRules& rules);
  static std::string obstacle_of_change(const RopeDef& def, const Field& field);
  static void visit_points(RopeDef& def, const VisitPoint& visit);

  template <typename Add>
  static void for_each_wrench(const Rope& rope, std::span<const LinkMotion> motion, double /*time*/,
                              Add&& add) noexcept {
    const double tension = state_of(rope, motion).tension;
    if (tension == 0) return;
    for (std::size_t k = 0; k < rope.points.size(); ++k) {
      add(rope.points[k].link, rope.points[k].body, wrench_on(rope, k, tension, motion));
    }
  }
  static double energy(const Rope& rope, std::span<const LinkMotion> motion) noexcept {
    return stored_energy(rope, state_of(rope, motion));
  }

  static constexpr bool kHasSlopes = true;
  static void add_stiffness(const Rope& rope, StiffnessSum& sum) noexcept;
  template <typename Couple>
  static void for_each_coupling(const Rope& rope, Couple&& couple) {
    for (std::size_t a = 0; a < rope.points.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) couple(rope.points[a].link, rope.points[b].link);
    }
  }
  static constexpr bool kHasStops = true;
  static StopMotion stop_of(const Rope& rope, std::span<const LinkMotion> motion) noexcept {
    const RopeState state = state_of(rope, motion);
    const double stretch = state.length - rope.free_length;
    return {state.springs, stretch, state.rate, stretch, state.rate};
  }
  static double curve_force(const Rope& rope, double stretch) noexcept {
    return stretch > 0 && !rope.spring_curve.empty() ? math::value_at(rope.spring_curve, stretch) : 0;
  }

  static void list_variables(const Rope& rope, VariableNames& names);
  static void read_variables(const Rope& rope, std::span<const LinkMotion> motion, double time,
                             VariableSink& sink) noexcept;
  static std::span<const std::string_view> value_keys(const Rope& rope) noexcept;
  static double* value(Rope& rope, std::size_t index) noexcept;
};

}  // namespace slew::multibody
