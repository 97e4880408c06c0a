#include "coupling/line_force.h"

namespace slew::coupling {

LineForceLaw::LineForceLaw(const LineForceDef& def)
    : def_(def),
      loss_(1 - def.efficiency),
      seal_slope_(def.seal_friction / def.seal_speed),
      has_friction_((!def.friction_curve.empty() && def.efficiency != 1) || def.seal_friction > 0 ||
                    def.viscous_friction > 0) {
  const Table& curve = def_.friction_curve;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const bool is_last = i + 1 == curve.size();
    const double slope = is_last ? 0 : (curve[i + 1][1] - curve[i][1]) / (curve[i + 1][0] - curve[i][0]);
    segments_.push_back({curve[i][0], curve[i][1], slope});
  }
}

double LineForceLaw::friction(double F, double v) const noexcept {
  return friction_at(F, v).force;
}

double LineForceLaw::stop_force(double x, double v) const noexcept {
  return stop_at(x, v).force;
}

}  // namespace slew::coupling
