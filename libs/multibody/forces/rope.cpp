#include "multibody/forces/rope.h"

#include <algorithm>
#include <cstddef>

namespace slew::multibody {
namespace {

using math::Vec3;

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

}  // namespace slew::multibody
