// SPDX-License-Identifier: Apache-2.0
// A force at a point of a body, or a torque on it, of given magnitude and direction.
//
//   F(t) = s (F_0 + F_table(t)) d,   d unit, fixed in the body or in Ground                          (1)
// s is 1, or what an input gives, held over a step of the session.
// A torque has no point. The table is a monotone cubic over time that holds its last values.
// Card: docs/models/multibody_point_loads.md.
#pragma once

#include <string>

#include "math/monotone_cubic.h"
#include "multibody/forces/force_row.h"

namespace slew::multibody {

// Axes that a load's direction keeps.
enum class LoadAxes : int { body, ground };

// Force at a point of a body: F = (force + force_table(t)) direction.
struct PointForceDef {
  std::string name{};
  std::string body{};
  Triple point{};             // m, body frame
  Triple direction{1, 0, 0};  // of any length but 0, in `axes`
  LoadAxes axes = LoadAxes::body;
  double force = 0;     // N
  Table force_table{};  // s, N; holds its last values
};

// Torque on a body: M = (torque + torque_table(t)) direction.
struct PointTorqueDef {
  std::string name{};
  std::string body{};
  Triple direction{1, 0, 0};
  LoadAxes axes = LoadAxes::body;
  double torque = 0;     // N m
  Table torque_table{};  // s, N m; holds its last values
};

enum class LoadKind : std::uint8_t { force, torque };

struct PointLoad {
  std::string name;
  LoadKind kind = LoadKind::force;
  LoadAxes axes = LoadAxes::body;
  int link = 0, body = 0;
  math::Vec3 p_L;        // m, point in the link
  math::Vec3 direction;  // d, unit, link axes or Ground axes
  double constant = 0;   // F_0 [N or N m]
  double signal = 1;     // s
  math::MonotoneCubic table;
};

// s (F_0 + F_table) at a time [s]; [N or N m].
[[nodiscard]] double magnitude_of(const PointLoad& load, double time) noexcept;

[[nodiscard]] Wrench wrench_of(const PointLoad& load, const LinkMotion& link, double time) noexcept;

[[nodiscard]] std::span<const Field> point_force_fields() noexcept;
[[nodiscard]] std::span<const Field> point_torque_fields() noexcept;

struct PointLoadRow : ForceRow<PointLoad> {
  struct Defs {
    std::vector<PointForceDef> point_forces;
    std::vector<PointTorqueDef> point_torques;
  };
  struct Elements {
    std::vector<PointLoad> loads;  // forces, then torques
  };
  static constexpr auto kElements = &Elements::loads;
  static constexpr std::tuple kTypes{
      ForceType{"forces", "point_force", "force of given size at a point of a body", point_force_fields,
                &Defs::point_forces},
      ForceType{"forces", "point_torque", "torque of given size on a body", point_torque_fields, &Defs::point_torques}};

  static PointLoad build(const PointForceDef& def, ElementBuilder& builder);
  static PointLoad build(const PointTorqueDef& def, ElementBuilder& builder);
  static void check(const PointForceDef& def, ElementRules& rules);
  static void check(const PointTorqueDef& def, ElementRules& rules);
  static void visit_points(PointForceDef& def, const VisitPoint& visit) { visit(def.body, &def.point); }
  static void visit_points(PointTorqueDef& def, const VisitPoint& visit) { visit(def.body, nullptr); }

  template <typename Add>
  static void for_each_wrench(const PointLoad& load, std::span<const LinkMotion> motion, double time,
                              Add&& add) noexcept {
    add(load.link, load.body, wrench_of(load, motion[static_cast<std::size_t>(load.link)], time));
  }
  static bool depends_on_time(const PointLoad& load) noexcept { return !load.table.empty(); }

  static void list_variables(const PointLoad& load, VariableNames& names);
  static void read_variables(const PointLoad& load, std::span<const LinkMotion> motion, double time,
                             VariableSink& sink) noexcept;
  static std::span<const std::string_view> value_keys(const PointLoad& load) noexcept;
  static double* value(PointLoad& load, std::size_t /*index*/) noexcept { return &load.constant; }
};

}  // namespace slew::multibody
