#include "contact/contact_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "contact/fcl/fcl_border.h"
#include "contact/kernels.h"
#include "core/check.h"
#include "math/rotation.h"

namespace slew::contact {
namespace {

using math::Mat3;
using math::Vec3;

// convex against convex has one point in FCL, which the faces then widen
constexpr std::size_t kFclContacts = 4;

template <typename Def>
std::size_t index_of(const std::vector<Def>& defs, const std::string& name) {
  const auto found = std::find_if(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
  SLEW_CHECK(found != defs.end());
  return static_cast<std::size_t>(found - defs.begin());
}

bool are_near(const Solid& a, const Solid& b) noexcept {
  const double reach = a.geometry->bounding_radius + b.geometry->bounding_radius;
  if (std::isinf(reach)) return true;
  const Vec3 apart = a.to_world(a.geometry->centre) - b.to_world(b.geometry->centre);
  return dot(apart, apart) < reach * reach;
}

struct PlainPlacement {
  std::array<double, 3> p;
  std::array<double, 9> R;
};

PlainPlacement plain(const Solid& s) noexcept {
  PlainPlacement out{s.p_WS.array(), {}};
  for (std::size_t k = 0; k < 9; ++k) out.R[k] = s.R_WS.c[k / 3][static_cast<int>(k % 3)];
  return out;
}

// the same contacts seen from the other shape
void swap_sides(Manifold& points) noexcept {
  for (ManifoldPoint& point : points) point.n_W = -point.n_W;
}

}  // namespace

struct ContactModel::Fcl {
  fcl_border::Geometries* geometries = fcl_border::create_geometries();
  Fcl() = default;
  ~Fcl() { fcl_border::destroy(geometries); }
  Fcl(const Fcl&) = delete;
  Fcl& operator=(const Fcl&) = delete;
};

struct ContactSet::Fcl {
  fcl_border::Scratch* scratch = fcl_border::create_scratch(kFclContacts);
  Fcl() = default;
  ~Fcl() { fcl_border::destroy(scratch); }
  Fcl(const Fcl&) = delete;
  Fcl& operator=(const Fcl&) = delete;
};

ContactModel::ContactModel() = default;
ContactModel::~ContactModel() = default;
ContactModel::ContactModel(ContactModel&&) noexcept = default;
ContactModel& ContactModel::operator=(ContactModel&&) noexcept = default;

ContactSet::~ContactSet() = default;
ContactSet::ContactSet(ContactSet&&) noexcept = default;
ContactSet& ContactSet::operator=(ContactSet&&) noexcept = default;

ContactSet::ContactSet(const ContactModel& model)
    : points_(model.pairs().size() * kMaxPointsPerPair), clearances_(model.pairs().size()) {
  if (model.asks_fcl()) fcl_ = std::make_unique<Fcl>();
}

void ContactModel::add_to_fcl(const ContactDef& def) {
  fcl_ = std::make_unique<Fcl>();
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const ShapeDef& shape = def.shapes[i];
    fcl_border::Geometries& g = *fcl_->geometries;
    std::size_t& index = shapes_[i].fcl_index;
    switch (shape.type) {
      case ShapeType::sphere:
        index = fcl_border::add_sphere(g, shape.radius);
        break;
      case ShapeType::box:
        index = fcl_border::add_box(g, shape.size[0], shape.size[1], shape.size[2]);
        break;
      case ShapeType::cylinder:
        index = fcl_border::add_cylinder(g, shape.radius, shape.length);
        break;
      case ShapeType::capsule:
        index = fcl_border::add_capsule(g, shape.radius, shape.length);
        break;
      case ShapeType::convex_mesh:
        index = fcl_border::add_convex(g, shape.mesh.vertices[0].data(), shape.mesh.vertices.size(),
                                       shape.mesh.triangles[0].data(), shape.mesh.triangles.size());
        break;
      default:
        break;  // own kernels only
    }
  }
}

ContactModel build(const ContactDef& def) {
  ContactModel model;
  model.frame_count_ = def.frames.size();
  for (const ShapeDef& shape : def.shapes) {
    model.shapes_.push_back({.geometry = make_geometry(shape),
                             .frame = index_of(def.frames, shape.frame),
                             .p_FS = Vec3(shape.position),
                             .R_FS = math::rotation_zxz(shape.orientation),
                             .extent = 0,
                             .fcl_index = 0});
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
    constexpr double kMatch = 0.1;
    built.match_distance = kMatch * std::min(model.shapes_[built.shape_a].geometry.bounding_radius,
                                             model.shapes_[built.shape_b].geometry.bounding_radius);
    built.half_thickness =
        inner_radius(model.shapes_[built.shape_a].geometry) + inner_radius(model.shapes_[built.shape_b].geometry);
    const ShapeType a = def.shapes[built.shape_a].type, b = def.shapes[built.shape_b].type;
    if (find_kernel(a, b) == nullptr && find_kernel(b, a) == nullptr) model.asks_fcl_ = true;
    model.pairs_.push_back(built);
  }
  if (model.asks_fcl_) model.add_to_fcl(def);
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
  if (const Kernel kernel = find_kernel(b.geometry->type, a.geometry->type)) {
    kernel(b, a, found);
    swap_sides(found);
    return;
  }
  const PlainPlacement at_a = plain(a), at_b = plain(b);
  std::array<fcl_border::RawContact, kFclContacts> raw;
  std::size_t count = 0;
  const fcl_border::QueryResult result =
      fcl_border::collide(*fcl_->geometries, *set.fcl_->scratch, shape_a.fcl_index, {at_a.p.data(), at_a.R.data()},
                          shape_b.fcl_index, {at_b.p.data(), at_b.R.data()}, raw.data(), raw.size(), count);
  if (result == fcl_border::QueryResult::failed) ++set.unresolved_;
  if (count == 0) return;
  const Vec3 n_W(raw[0].n_W[0], raw[0].n_W[1], raw[0].n_W[2]);
  clip_faces(supporting_face(a, -n_W), supporting_face(b, n_W), n_W, found);
  // the faces may miss what touches (edge on edge, a slim shape's tip): then FCL's point as well
  constexpr double kMissed = 0.99;
  const bool is_found = std::any_of(found.begin(), found.end(),
                                    [&](const ManifoldPoint& point) { return point.depth > kMissed * raw[0].depth; });
  if (!is_found) found.push_back({Vec3(raw[0].p_W[0], raw[0].p_W[1], raw[0].p_W[2]), n_W, raw[0].depth});
}

void find_contacts(const ContactModel& model, std::span<const Pose> poses, ContactSet& set) noexcept {
  SLEW_ASSERT(poses.size() == model.frame_count());
  set.count_ = 0;
  set.unresolved_ = 0;
  for (std::size_t pair = 0; pair < model.pairs_.size(); ++pair) {
    const ContactPair& shapes = model.pairs_[pair];
    const Pose &frame_a = poses[model.frame_of(shapes.shape_a)], &frame_b = poses[model.frame_of(shapes.shape_b)];
    if (model.is_clear(pair, frame_a, frame_b, set)) continue;
    model.find_pair(pair, frame_a, frame_b, set);
    if (set.manifold_.empty()) model.note_clearance(pair, frame_a, frame_b, set);
    reduce(set.manifold_);
    std::array<double, kMaxPointsPerPair> depths{}, shares{};
    const std::size_t n = set.manifold_.size();
    for (std::size_t i = 0; i < n; ++i) depths[i] = set.manifold_[i].depth;
    share_stiffness({depths.data(), n}, {shares.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      const ManifoldPoint& point = set.manifold_[i];
      set.points_[set.count_++] = {pair, point.p_W, point.n_W, point.depth, shares[i]};
    }
  }
}

}  // namespace slew::contact
