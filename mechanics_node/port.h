// An actuator's port as the mechanics compute it.
#pragma once

#include <string>

#include "coupling/line_force.h"

namespace slew::mechanics {

struct Port {
  std::string name;
  double offset = 0, ratio = 1;  // stroke x = offset + ratio * coordinate of the row [m, m or m/rad]
  coupling::LineForceLaw law;
  double z = 0;         // pressure force, the mechanics' copy, without its damping -D (v - v_ref) [N]
  double F = 0;         // pressure force with damping [N]
  double friction = 0;  // at the published instant [N]
  double stop = 0;      // at the published instant [N]

  [[nodiscard]] double stroke(double row_x) const noexcept { return offset + ratio * row_x; }
};

}  // namespace slew::mechanics
