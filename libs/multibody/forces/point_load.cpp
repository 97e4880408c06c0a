#include "multibody/forces/point_load.h"

namespace slew::multibody {

double magnitude_of(const PointLoad& load, double time) noexcept {
  return load.signal * (load.constant + (load.table.empty() ? 0.0 : math::value_at(load.table, time)));
}

Wrench wrench_of(const PointLoad& load, const LinkMotion& link, double time) noexcept {
  const math::Vec3 d = load.axes == LoadAxes::body ? link.R * load.direction : load.direction;
  const math::Vec3 F = d * magnitude_of(load, time);
  if (load.kind == LoadKind::torque) return {math::Vec3(), F};
  return {F, cross(link.R * load.p_L, F)};
}

}  // namespace slew::multibody
