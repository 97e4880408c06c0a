// A force at a point of a body, or a torque on it, of given magnitude and direction.
//
//   F(t) = s (F_0 + F_table(t)) d,   d unit, fixed in the body or in Ground                          (1)
// s is 1, or what an input gives, held over a step of the session.
// A torque has no point. The table is a monotone cubic over time that holds its last values.
// Card: docs/models/multibody_point_loads.md.
#pragma once

#include <string>

#include "math/monotone_cubic.h"
#include "multibody/forces/element_defs.h"
#include "multibody/forces/wrench.h"

namespace slew::multibody {

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

}  // namespace slew::multibody
