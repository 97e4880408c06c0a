// SPDX-License-Identifier: Apache-2.0
#include "contact/sweep.h"

#include <algorithm>
#include <cmath>

namespace slew::contact {

using math::Vec3;

namespace {

Pose between(const Pose& from, const Pose& to, double s) noexcept {
  return {from.p_WF + (to.p_WF - from.p_WF) * s, s < 0.5 ? from.R_WF : to.R_WF};
}

}  // namespace

class Sweeper {
 public:
  Sweeper(const ContactModel& model, std::size_t pair) noexcept
      : model_(model),
        pair_(pair),
        a_(model.shapes_[model.pairs_[pair].shape_a]),
        b_(model.shapes_[model.pairs_[pair].shape_b]) {}

  [[nodiscard]] Meeting run(std::span<const Pose> from, std::span<const Pose> to, ContactSet& set) const noexcept {
    if (is_clear(from, set) && is_clear(to, set)) return {};
    const Vec3 start = apart(from), path = apart(to) - start;
    Meeting meeting{.travel = norm(path)};
    if (!may_meet(start, path)) return meeting;
    const double piece = model_.pairs_[pair_].half_thickness;
    const double pieces = meeting.travel > piece ? std::ceil(meeting.travel / piece) : 1.0;
    if (!(pieces <= kMostLooks)) {
      meeting.kind = Meeting::Kind::too_fast;
      return meeting;
    }
    for (int i = 1; i <= static_cast<int>(pieces); ++i) {
      const double s = i / pieces;
      model_.find_pair(pair_, between(from[a_.frame], to[a_.frame], s), between(from[b_.frame], to[b_.frame], s), set);
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
  const ContactModel::Shape &a_, &b_;
};

Meeting sweep(const ContactModel& model, std::size_t pair, std::span<const Pose> from, std::span<const Pose> to,
              ContactSet& scratch) noexcept {
  return Sweeper(model, pair).run(from, to, scratch);
}

std::span<const ManifoldPoint> points_at_end(const ContactModel& model, std::size_t pair, const Meeting& meeting,
                                             std::span<const Pose> to, ContactSet& scratch) noexcept {
  return Sweeper(model, pair).points_at_end(meeting, to, scratch);
}

}  // namespace slew::contact
