// SPDX-License-Identifier: Apache-2.0
#include "contact/contact_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "contact/find_named.h"
#include "contact/kernels.h"
#include "core/check.h"
#include "math/rotation.h"

namespace slew::contact {
namespace {

using math::Mat3;
using math::Vec3;

template <typename Def>
std::size_t index_of(const std::vector<Def>& defs, const std::string& name) {
  const Def* def = find_named(defs, name);
  SLEW_CHECK(def != nullptr);
  return static_cast<std::size_t>(def - defs.data());
}

bool are_near(const Solid& a, const Solid& b) noexcept {
  const double reach = a.geometry->bounding_radius + b.geometry->bounding_radius;
  if (std::isinf(reach)) return true;
  const Vec3 apart = a.to_world(a.geometry->centre) - b.to_world(b.geometry->centre);
  return dot(apart, apart) < reach * reach;
}

// the same contacts seen from the other shape
void swap_sides(Manifold& points) noexcept {
  for (ManifoldPoint& point : points) point.n_W = -point.n_W;
}

}  // namespace

ContactSet::ContactSet(const ContactModel& model)
    : points_(model.pairs().size() * kMaxPointsPerPair), clearances_(model.pairs().size()) {}

ContactModel build(const ContactDef& def) {
  ContactModel model;
  model.frame_count_ = def.frames.size();
  for (const ShapeDef& shape : def.shapes) {
    model.shapes_.push_back({.geometry = make_geometry(shape),
                             .frame = index_of(def.frames, shape.frame),
                             .p_FS = Vec3(shape.position),
                             .R_FS = math::rotation_zxz(shape.orientation),
                             .extent = 0});
    ContactModel::Shape& built = model.shapes_.back();
    built.extent = norm(built.p_FS + built.R_FS * built.geometry.centre) + built.geometry.bounding_radius;
  }
  for (const PairDef& pair : def.pairs) {
    ContactPair built;
    built.shape_a = index_of(def.shapes, pair.shape_a);
    built.shape_b = index_of(def.shapes, pair.shape_b);
    built.normal = build(pair.normal);
    built.has_friction = pair.friction.has_value();
    if (pair.friction) built.friction = build(*pair.friction);
    built.match_distance = kMatchShare * std::min(model.shapes_[built.shape_a].geometry.bounding_radius,
                                                  model.shapes_[built.shape_b].geometry.bounding_radius);
    built.half_thickness =
        inner_radius(model.shapes_[built.shape_a].geometry) + inner_radius(model.shapes_[built.shape_b].geometry);
    model.pairs_.push_back(built);
  }
  return model;
}

Solid ContactModel::place(const Shape& shape, const Pose& pose) const noexcept {
  return {&shape.geometry, pose.p_WF + pose.R_WF * shape.p_FS, pose.R_WF * shape.R_FS};
}

void ContactModel::find_pair(std::size_t pair, const Pose& frame_a, const Pose& frame_b,
                             ContactSet& set) const noexcept {
  const Shape &shape_a = shapes_[pairs_[pair].shape_a], &shape_b = shapes_[pairs_[pair].shape_b];
  const Solid a = place(shape_a, frame_a), b = place(shape_b, frame_b);
  Manifold& found = set.manifold_;
  found.clear();
  if (!are_near(a, b)) return;
  if (const Kernel kernel = find_kernel(a.geometry->type, b.geometry->type)) {
    kernel(a, b, found);
    return;
  }
  const Kernel kernel = find_kernel(b.geometry->type, a.geometry->type);
  SLEW_ASSERT(kernel != nullptr);
  kernel(b, a, found);
  swap_sides(found);
}

void find_contacts(const ContactModel& model, std::span<const Pose> poses, ContactSet& set) noexcept {
  SLEW_ASSERT(poses.size() == model.frame_count());
  set.count_ = 0;
  for (std::size_t pair = 0; pair < model.pairs_.size(); ++pair) {
    const ContactPair& shapes = model.pairs_[pair];
    const Pose &frame_a = poses[model.frame_of(shapes.shape_a)], &frame_b = poses[model.frame_of(shapes.shape_b)];
    if (model.is_clear(pair, frame_a, frame_b, set)) continue;
    model.find_pair(pair, frame_a, frame_b, set);
    if (set.manifold_.empty()) model.note_clearance(pair, frame_a, frame_b, set);
    reduce(set.manifold_);
    std::array<double, kMaxPointsPerPair> depths{}, areas{}, shares{};
    const std::size_t n = set.manifold_.size();
    for (std::size_t i = 0; i < n; ++i) {
      depths[i] = set.manifold_[i].depth;
      areas[i] = set.manifold_[i].area;
    }
    share_stiffness({depths.data(), n}, {areas.data(), n}, {shares.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      const ManifoldPoint& point = set.manifold_[i];
      set.points_[set.count_++] = {pair, point.p_W, point.n_W, point.depth, shares[i]};
    }
  }
}

}  // namespace slew::contact
