#include "multibody/formulations/link_stiffness.h"

#include <algorithm>

#include "core/index.h"
#include "multibody/forces/element_law.h"
#include "multibody/formulations/passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

class Adding {
 public:
  Adding(const Model& model, const Workspace& ws, ChangeWeights weights, Stiffness which, LinkMatrix& matrix) noexcept
      : model_(model),
        ws_(ws),
        weights_(weights),
        pull_weight_(which == Stiffness::with_pulls ? weights.position : 0),
        matrix_(matrix) {}

  void add_all() noexcept {
    for (std::size_t i = 0; i < model_.lines.size(); ++i) {
      if (model_.lines[i].law.is_active) add_line(model_.lines[i], ws_.lines[i]);
    }
    for (std::size_t i = 0; i < model_.angles.size(); ++i) {
      if (model_.angles[i].law.is_active) add_angle(model_.angles[i], ws_.angles[i]);
    }
    for (const Bushing& bushing : model_.elements.bushings) {
      const Deflection d = deflection(bushing.frames);
      add_frames(bushing.frames, d, slopes_of(bushing, d, weights_), force_of(bushing, d));
    }
    for (const Beam& beam : model_.elements.beams) {
      const Deflection d = deflection(beam.frames);
      add_frames(beam.frames, d, slopes_of(beam, weights_), force_of(beam, d));
    }
    for (const Rope& rope : model_.elements.ropes) add_rope(rope);
    for (const Tyre& tyre : model_.elements.tyres) add_tyre(tyre);
  }

 private:
  [[nodiscard]] const LinkMotion& motion(int link) const noexcept { return ws_.motion[at(link)]; }
  [[nodiscard]] Deflection deflection(const FramePair& frames) const noexcept {
    return deflection_of(frames, motion(frames.link1), motion(frames.link2));
  }

  void add_line(const LineElement& line, const LineMotion& m) noexcept {
    const ElementSlopes slopes = slopes_of(line.law, m.length, m.rate, m.rate);
    const double along = weights_.position * std::max(0.0, slopes.stiffness) +
                         weights_.rate * std::max(0.0, slopes.end_damping + slopes.damping);
    // a pull holds the line straight
    const double pull = std::max(0.0, -force_of(line.law, m.length, m.rate, m.rate));
    const Mat3 e = outer(m.e, m.e);
    const Mat3 A = e * along + (Mat3::identity() - e) * (pull_weight_ * pull / m.length);
    add_stretch(line.link1, m.P1, line.link2, m.P2, A);
  }

  // between two points, each of which is seen from the other
  void add_stretch(int link1, Vec3 P1, int link2, Vec3 P2, const Mat3& A) noexcept {
    const Vec3 s1 = P1 - motion(link1).p, s2 = P2 - motion(link2).p;
    add_points(link1, s1, link1, s1, A, matrix_);
    add_points(link2, s2, link2, s2, A, matrix_);
    add_points(link1, s1, link2, s2, A * -1.0, matrix_);
    add_points(link2, s2, link1, s1, A * -1.0, matrix_);
  }

  void add_angle(const AngleElement& element, const AngleMotion& m) noexcept {
    // without a spring the angle is neither evaluated nor needed
    const bool is_sprung = has_spring(element.law);
    const ElementSlopes slopes =
        slopes_of(element.law, is_sprung ? m.angle : 0, is_sprung ? m.rate : 0, damper_speed(element, ws_));
    const Vec3 axis = motion(element.link1).R * element.axis;
    RelativeMatrix A{{}, {}, outer(axis, axis) * (weights_.rate * std::max(0.0, slopes.damping))};
    if (is_sprung) {
      A.ww += outer(m.n, m.n) *
              (weights_.position * std::max(0.0, slopes.stiffness) + weights_.rate * std::max(0.0, slopes.end_damping));
    }
    add_relative(ws_, element.link1, element.link2, motion(element.link2).p, A, matrix_);
  }

  void add_frames(const FramePair& frames, const Deflection& d, const SixBySix& slopes, const Six& force) noexcept {
    const PairMatrix A = matrix_of(d, slopes);
    add_relative(ws_, frames.link1, frames.link2, d.P2, {A.vv, A.vw, A.ww}, matrix_);
    const Vec3 F = d.R_W1 * Vec3(force[0], force[1], force[2]);
    add_pull(frames.link1, d.P2 - motion(frames.link1).p, -F, pull_weight_, matrix_);
    add_pull(frames.link2, d.P2 - motion(frames.link2).p, F, pull_weight_, matrix_);
  }

  // gradient of the length by the point
  [[nodiscard]] Vec3 gradient(const Rope& rope, std::size_t k) const noexcept {
    const Vec3 P = position_of(rope, k, ws_.motion);
    Vec3 g;
    if (k > 0) g += direction(position_of(rope, k - 1, ws_.motion), P);
    if (k + 1 < rope.points.size()) g += direction(position_of(rope, k + 1, ws_.motion), P);
    return g;
  }

  void add_rope(const Rope& rope) noexcept {
    const RopeState state = state_of(rope, ws_.motion);
    const RopeSlopes slopes = slopes_of(rope, state);
    const double along = weights_.position * slopes.stiffness + weights_.rate * slopes.damping;
    const auto arm = [&](std::size_t k) { return position_of(rope, k, ws_.motion) - motion(rope.points[k].link).p; };
    for (std::size_t a = 0; a < rope.points.size() && along > 0; ++a) {
      for (std::size_t b = 0; b < rope.points.size(); ++b) {
        add_points(rope.points[a].link, arm(a), rope.points[b].link, arm(b),
                   outer(gradient(rope, a), gradient(rope, b)) * along, matrix_);
      }
    }
    for (std::size_t k = 0; k + 1 < rope.points.size() && state.tension > 0; ++k) {
      const Vec3 P1 = position_of(rope, k, ws_.motion), P2 = position_of(rope, k + 1, ws_.motion);
      const Vec3 e = direction(P1, P2);
      if (dot(e, e) == 0) continue;
      const Mat3 across = Mat3::identity() - outer(e, e);
      add_stretch(rope.points[k].link, P1, rope.points[k + 1].link, P2,
                  across * (pull_weight_ * state.tension / norm(P2 - P1)));
    }
  }

  void add_tyre(const Tyre& tyre) noexcept {
    const TyreState state = state_of(tyre, motion(tyre.link));
    if (tyre.link == 0 || !(state.depth > 0)) return;
    const TyreSlopes slopes = slopes_of(tyre, state, motion(tyre.link), weights_);
    const Mat3 forwards = outer(state.t, state.t) * slopes.longitudinal;
    Mat3 at_ground = outer(tyre.normal_W, tyre.normal_W) * slopes.normal + outer(state.l, state.l) * slopes.lateral;
    if (tyre.rolling == TyreRolling::with_body) {
      at_ground += forwards;
    } else {
      add_relative(ws_, 0, tyre.link, state.C, {forwards, {}, {}}, matrix_);
    }
    add_relative(ws_, 0, tyre.link, state.Q, {at_ground, {}, outer(state.axle, state.axle) * slopes.axle}, matrix_);
  }

  const Model& model_;
  const Workspace& ws_;
  ChangeWeights weights_;
  double pull_weight_;
  LinkMatrix& matrix_;
};

}  // namespace

void add_stiffness(const Model& model, const Workspace& ws, ChangeWeights weights, LinkMatrix& matrix,
                   Stiffness which) noexcept {
  Adding(model, ws, weights, which, matrix).add_all();
}

void add_pull(int link, Vec3 s, Vec3 F, double weight, LinkMatrix& matrix) noexcept {
  const double pull = dot(F, s);
  if (link == 0 || !(pull > 0)) return;
  SpatialBlock block{};
  add_to_block((Mat3::identity() - outer(s, s) * (1 / dot(s, s))) * (weight * pull), 3, 3, block);
  matrix.add(link, link, block);
}

}  // namespace slew::multibody
