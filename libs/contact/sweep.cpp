// SPDX-License-Identifier: Apache-2.0
#include "contact/sweep.h"

#include <algorithm>
#include <cmath>

#include "math/rotation.h"

namespace slew::contact {

using math::Mat3;
using math::Vec3;

namespace {

Pose between(const Pose& from, const Pose& to, double s) noexcept {
  return {from.p_WF + (to.p_WF - from.p_WF) * s, s < 0.5 ? from.R_WF : to.R_WF};
}

// from one attitude to another, in Ground axes
struct TurnBetween {
  Vec3 axis;
  double angle = 0;  // rad

  TurnBetween(const Mat3& from, const Mat3& to) noexcept {
    const Mat3 R = to * transpose(from);
    const Vec3 sine = Vec3(R.c[1][2] - R.c[2][1], R.c[2][0] - R.c[0][2], R.c[0][1] - R.c[1][0]) * 0.5;
    const double size = norm(sine);
    angle = std::atan2(size, 0.5 * (R.c[0][0] + R.c[1][1] + R.c[2][2] - 1));
    if (size > 0) axis = sine * (1 / size);
  }
  [[nodiscard]] Mat3 part(double s) const noexcept {
    const Vec3 half = axis * std::sin(0.5 * s * angle);
    return math::rotation_of({std::cos(0.5 * s * angle), half[0], half[1], half[2]});
  }
};

}  // namespace

class Sweeper {
 public:
  Sweeper(const ContactModel& model, std::size_t pair, Turn turn = Turn::at_middle) noexcept
      : model_(model),
        pair_(pair),
        turn_(turn),
        a_(model.shapes_[model.pairs_[pair].shape_a]),
        b_(model.shapes_[model.pairs_[pair].shape_b]) {}

  [[nodiscard]] Meeting run(std::span<const Pose> from, std::span<const Pose> to, ContactSet& set) const noexcept {
    if (is_clear(from, set) && is_clear(to, set)) return {};
    const Vec3 start = apart(from), path = apart(to) - start;
    Meeting meeting{.travel = norm(path)};
    if (!may_meet(start, path)) return meeting;
    const double piece = model_.pairs_[pair_].half_thickness;
    double pieces = meeting.travel > piece ? std::ceil(meeting.travel / piece) : 1.0;
    if (!(pieces <= kMostLooks)) {
      meeting.kind = Meeting::Kind::too_fast;
      return meeting;
    }
    const TurnBetween turn_a(from[a_.frame].R_WF, to[a_.frame].R_WF), turn_b(from[b_.frame].R_WF, to[b_.frame].R_WF);
    const bool is_steady = turn_ == Turn::steady;
    if (is_steady) pieces = std::max(pieces, std::min<double>(kMostLooks, std::ceil(way_of_points(from, to) / piece)));
    const auto pose = [&](std::size_t frame, const TurnBetween& turn, double s) {
      Pose at = between(from[frame], to[frame], s);
      if (is_steady && s < 1) at.R_WF = turn.part(s) * from[frame].R_WF;
      return at;
    };
    for (int i = 1; i <= static_cast<int>(pieces); ++i) {
      const double s = i / pieces;
      model_.find_pair(pair_, pose(a_.frame, turn_a, s), pose(b_.frame, turn_b, s), set);
      if (set.manifold_.empty()) continue;
      meeting.kind = Meeting::Kind::found;
      meeting.n_W = set.manifold_[0].n_W;
      meeting.p_W = set.manifold_[0].p_W;
      meeting.share = s;
      return meeting;
    }
    return meeting;
  }

  [[nodiscard]] std::span<const ManifoldPoint> points_at_end(const Meeting& meeting, std::span<const Pose> to,
                                                             ContactSet& set) const noexcept {
    if (meeting.share < 1) model_.find_pair(pair_, to[a_.frame], to[b_.frame], set);
    return {set.manifold_.begin(), set.manifold_.size()};
  }

 private:
  [[nodiscard]] bool is_clear(std::span<const Pose> poses, const ContactSet& set) const noexcept {
    return model_.is_clear(pair_, poses[a_.frame], poses[b_.frame], set);
  }

  // A's middle seen from B's
  [[nodiscard]] Vec3 apart(std::span<const Pose> poses) const noexcept {
    const auto middle = [&](const ContactModel::Shape& shape) {
      const Solid solid = model_.place(shape, poses[shape.frame]);
      return solid.to_world(shape.geometry.centre);
    };
    return middle(a_) - middle(b_);
  }

  // The most that a point of either shape moves seen from the other, whichever is less [m].
  [[nodiscard]] double way_of_points(std::span<const Pose> from, std::span<const Pose> to) const noexcept {
    const auto seen_from = [&](const ContactModel::Shape& seen, const ContactModel::Shape& other) {
      const auto place = [&](std::span<const Pose> poses) {
        const Pose &s = poses[seen.frame], &o = poses[other.frame];
        return Pose{transpose_multiply(o.R_WF, model_.place(seen, s).to_world(seen.geometry.centre) - o.p_WF),
                    transpose(o.R_WF) * s.R_WF};
      };
      const Pose start = place(from), end = place(to);
      const double angle = TurnBetween(start.R_WF, end.R_WF).angle;
      return norm(end.p_WF - start.p_WF) + (angle > 0 ? angle * seen.geometry.bounding_radius : 0);
    };
    return std::min(seen_from(a_, b_), seen_from(b_, a_));
  }

  // the bounding spheres meet somewhere along the path
  [[nodiscard]] bool may_meet(Vec3 start, Vec3 path) const noexcept {
    const double reach = a_.geometry.bounding_radius + b_.geometry.bounding_radius;
    if (std::isinf(reach)) return true;
    const double length2 = dot(path, path);
    const double s = length2 > 0 ? std::clamp(-dot(start, path) / length2, 0.0, 1.0) : 0.0;
    const Vec3 nearest = start + path * s;
    return dot(nearest, nearest) < reach * reach;
  }

  const ContactModel& model_;
  std::size_t pair_;
  Turn turn_;
  const ContactModel::Shape &a_, &b_;
};

Meeting sweep(const ContactModel& model, std::size_t pair, std::span<const Pose> from, std::span<const Pose> to,
              ContactSet& scratch, Turn turn) noexcept {
  return Sweeper(model, pair, turn).run(from, to, scratch);
}

std::span<const ManifoldPoint> points_at_end(const ContactModel& model, std::size_t pair, const Meeting& meeting,
                                             std::span<const Pose> to, ContactSet& scratch) noexcept {
  return Sweeper(model, pair).points_at_end(meeting, to, scratch);
}

}  // namespace slew::contact
