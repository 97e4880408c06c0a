// SPDX-License-Identifier: Apache-2.0
#include "sensors/fcl_border.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/utility.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <fcl/narrowphase/distance.h>

#include "sensors/convex_distance.h"

namespace slew::sensors::fcl_border {

// A sphere is a point with a radius, a capsule a line with one. Distances are searched between these cores, which is
// exact; the search between round surfaces ends 1e-5 m off, and FCL's sphere has wrong nearest points with triangles.
struct Core {
  std::shared_ptr<fcl::CollisionGeometryd> shape;  // of other shapes the shape itself
  double radius = 0;                               // m
};

struct Geometries {
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;
  std::vector<Core> cores;  // by shape
};

struct Scratch {
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
};

namespace {

using Surface = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<fcl::CollisionGeometryd> line(double length) {
  auto shape = std::make_shared<fcl::Capsuled>(0, length);
  shape->computeLocalAABB();
  return shape;
}

std::size_t add(Geometries& geometries, std::shared_ptr<fcl::CollisionGeometryd> shape, Core core = {}) {
  shape->computeLocalAABB();
  if (!core.shape) core.shape = shape;
  geometries.shapes.push_back(std::move(shape));
  geometries.cores.push_back(std::move(core));
  return geometries.shapes.size() - 1;
}

std::vector<fcl::Vector3d> points(const double* vertices, std::size_t count) {
  std::vector<fcl::Vector3d> out;
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]);
  return out;
}

fcl::Transform3d transform(const Placement& placement) {
  fcl::Transform3d tf = fcl::Transform3d::Identity();
  tf.linear() = Eigen::Map<const fcl::Matrix3d>(placement.R_W);
  tf.translation() = Eigen::Map<const fcl::Vector3d>(placement.p_W);
  return tf;
}

bool is_finite(const RawContact& c) {
  double sum = c.depth;
  for (int k = 0; k < 3; ++k) sum += c.p_W[k] + c.n_W[k];
  return std::isfinite(sum);
}

}  // namespace

Geometries* create_geometries() {
  return new Geometries;
}

void destroy(Geometries* geometries) noexcept {
  delete geometries;
}

Scratch* create_scratch(std::size_t max_contacts) {
  auto scratch = std::make_unique<Scratch>();
  scratch->request.enable_contact = true;
  scratch->request.num_max_contacts = max_contacts;
  scratch->request.gjk_solver_type = fcl::GJKSolverType::GST_LIBCCD;
  return scratch.release();
}

void destroy(Scratch* scratch) noexcept {
  delete scratch;
}

std::size_t add_sphere(Geometries& geometries, double radius) {
  return add(geometries, std::make_shared<fcl::Sphered>(radius), {line(0), radius});
}

std::size_t add_box(Geometries& geometries, double x, double y, double z) {
  return add(geometries, std::make_unique<fcl::Boxd>(x, y, z));
}

std::size_t add_cylinder(Geometries& geometries, double radius, double length) {
  return add(geometries, std::make_unique<fcl::Cylinderd>(radius, length));
}

std::size_t add_capsule(Geometries& geometries, double radius, double length) {
  return add(geometries, std::make_shared<fcl::Capsuled>(radius, length), {line(length), radius});
}

std::size_t add_plane(Geometries& geometries) {
  return add(geometries, std::make_unique<fcl::Halfspaced>(fcl::Vector3d::UnitZ(), 0.0));
}

std::size_t add_convex(Geometries& geometries, const double* vertices, std::size_t vertex_count,
                       const std::uint32_t* triangles, std::size_t triangle_count) {
  auto corners = std::make_shared<const std::vector<fcl::Vector3d>>(points(vertices, vertex_count));
  // FCL's list of faces: number of corners, then the corners
  auto faces = std::make_shared<std::vector<int>>();
  for (std::size_t i = 0; i < triangle_count; ++i) {
    faces->push_back(3);
    for (std::size_t k = 0; k < 3; ++k) faces->push_back(static_cast<int>(triangles[3 * i + k]));
  }
  return add(geometries, std::make_unique<fcl::Convexd>(corners, static_cast<int>(triangle_count), faces));
}

std::size_t add_surface(Geometries& geometries, const double* vertices, std::size_t vertex_count,
                        const std::uint32_t* triangles, std::size_t triangle_count) {
  std::vector<fcl::Triangle> faces;
  for (std::size_t i = 0; i < triangle_count; ++i) {
    faces.emplace_back(triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]);
  }
  auto model = std::make_unique<Surface>();
  model->beginModel(static_cast<int>(triangle_count), static_cast<int>(vertex_count));
  model->addSubModel(points(vertices, vertex_count), faces);
  model->endModel();
  return add(geometries, std::move(model));
}

QueryResult collide(const Geometries& geometries, Scratch& scratch, std::size_t a, Placement of_a, std::size_t b,
                    Placement of_b, RawContact* out, std::size_t capacity, std::size_t& count) noexcept {
  count = 0;
  try {
    const fcl::CollisionGeometryd *first = geometries.shapes[a].get(), *second = geometries.shapes[b].get();
    scratch.result.clear();
    fcl::collide(first, transform(of_a), second, transform(of_b), scratch.request, scratch.result);
    const std::size_t found = scratch.result.numContacts();
    for (std::size_t i = 0; i < std::min(found, capacity); ++i) {
      const fcl::Contactd& contact = scratch.result.getContact(i);
      // FCL swaps its two shapes when it has the pair in the other order only; its normal points from o1 to o2
      const bool is_swapped = contact.o1 != first;
      const double sign = is_swapped ? 1.0 : -1.0;
      RawContact raw{};
      for (int k = 0; k < 3; ++k) {
        raw.p_W[k] = contact.pos[k];
        raw.n_W[k] = sign * contact.normal[k];
      }
      raw.depth = contact.penetration_depth;
      if (!is_finite(raw)) {
        count = 0;
        return QueryResult::failed;
      }
      if (raw.depth > 0) out[count++] = raw;
    }
    return found > capacity ? QueryResult::more_than_fit : QueryResult::fine;
  } catch (...) {
    count = 0;
    return QueryResult::failed;
  }
}

// ---- groups ---------------------------------------------------------------------------------------------------

namespace {

using fcl::Vector3d;

constexpr double kFarthest = 1e100;   // m, from the origin
constexpr double kTolerance = 1e-10;  // m, beyond the boxes of shapes that may touch

// A shape of a group at its place; the objects of FCL, which are cores, point to it.
struct Member {
  std::unique_ptr<fcl::CollisionObjectd> object;
  const fcl::CollisionGeometryd* shape = nullptr;
  double radius = 0;  // m, of the shape about its core
  std::size_t group = 0, number = 0, frame = 0;
};

struct Group {
  std::vector<Member> members;  // all but planes
  std::vector<Member> planes;
  double largest_radius = 0;
  std::vector<std::pair<bool, std::size_t>> order;  // by number: is a plane, index
};

bool is_plane(const fcl::CollisionGeometryd& shape) {
  return shape.getNodeType() == fcl::GEOM_HALFSPACE;
}

const Member& member_of(const fcl::CollisionObjectd* object) {
  return *static_cast<const Member*>(object->getUserData());
}

bool is_surface(const fcl::CollisionGeometryd& shape) {
  return shape.getObjectType() == fcl::OT_BVH;
}

template <typename Points>
Vector3d farthest_of(const Points& points, const Vector3d& d) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].dot(d) > points[best].dot(d)) best = i;
  }
  return points[best];
}

// The point of a core that is farthest along d, in its own axes.
Vector3d farthest_point(const fcl::Boxd& box, const Vector3d& d) {
  return 0.5 * box.side.cwiseProduct(d.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; }));
}

Vector3d farthest_point(const fcl::Capsuled& line, const Vector3d& d) {
  return {0, 0, d[2] < 0 ? -0.5 * line.lz : 0.5 * line.lz};
}

Vector3d farthest_point(const fcl::Cylinderd& cylinder, const Vector3d& d) {
  const double across = std::hypot(d[0], d[1]), half = 0.5 * cylinder.lz;
  const double scale = across > 0 ? cylinder.radius / across : 0;
  return {scale * d[0], scale * d[1], d[2] < 0 ? -half : half};
}

Vector3d farthest_point(const fcl::Convexd& convex, const Vector3d& d) {
  return farthest_of(convex.getVertices(), d);
}

// Calls visit with the core as what it is: no sphere and no plane.
template <typename Visit>
auto with_convex(const fcl::CollisionGeometryd& shape, const Visit& visit) {
  switch (shape.getNodeType()) {
    case fcl::GEOM_BOX:
      return visit(static_cast<const fcl::Boxd&>(shape));
    case fcl::GEOM_CYLINDER:
      return visit(static_cast<const fcl::Cylinderd&>(shape));
    case fcl::GEOM_CAPSULE:
      return visit(static_cast<const fcl::Capsuled&>(shape));
    default:
      return visit(static_cast<const fcl::Convexd&>(shape));
  }
}

// The point of a core that is farthest against the direction n (unit, world).
Vector3d lowest_point(const fcl::CollisionObjectd& object, const Vector3d& n) {
  const fcl::Transform3d& X = object.getTransform();
  const Vector3d d = -(X.linear().transpose() * n);
  const fcl::CollisionGeometryd& shape = *object.collisionGeometry();
  if (!is_surface(shape)) return X * with_convex(shape, [&](const auto& s) { return farthest_point(s, d); });
  const auto& surface = static_cast<const Surface&>(shape);
  int best = 0;
  for (int i = 1; i < surface.num_vertices; ++i) {
    if (surface.vertices[i].dot(d) > surface.vertices[best].dot(d)) best = i;
  }
  return X * surface.vertices[best];
}

struct Search {
  std::size_t a = 0;  // group; the other one is b
  bool only_overlap = false;
  double radii = 0;  // m, largest of both groups
  double distance = std::numeric_limits<double>::infinity();
  Vector3d p_a = Vector3d::Zero(), p_b = Vector3d::Zero(), n = Vector3d::Zero();
  std::size_t member_a = 0, member_b = 0;

  [[nodiscard]] bool is_done() const { return distance == 0; }
};

// n from y to x
void take(Search& search, const Member& x, const Member& y, double distance, const Vector3d& p_x, const Vector3d& p_y,
          const Vector3d& n) {
  if (!(distance < search.distance)) return;
  const bool is_swapped = x.group != search.a;
  search.distance = distance;
  search.p_a = is_swapped ? p_y : p_x;
  search.p_b = is_swapped ? p_x : p_y;
  search.n = is_swapped ? Vector3d(-n) : n;
  search.member_a = (is_swapped ? y : x).number;
  search.member_b = (is_swapped ? x : y).number;
}

// The shapes themselves overlap.
void search_contact(Search& search, const Member& x, const Member& y) {
  fcl::CollisionRequestd request;
  request.enable_contact = true;
  request.gjk_solver_type = fcl::GJKSolverType::GST_LIBCCD;
  fcl::CollisionResultd result;
  fcl::collide(x.shape, x.object->getTransform(), y.shape, y.object->getTransform(), request, result);
  if (result.numContacts() == 0) return;
  const fcl::Contactd& contact = result.getContact(0);
  // FCL's normal points from o1 to o2
  const double sign = contact.o1 == x.shape ? -1.0 : 1.0;
  const double length = contact.normal.norm();
  take(search, x, y, 0, contact.pos, contact.pos,
       length > 0 ? Vector3d(sign / length * contact.normal) : Vector3d::Zero());
}

// Nearest points of two cores; distance 0: they touch or overlap.
struct CoreDistance {
  double distance = std::numeric_limits<double>::max();  // m
  Vector3d p_x, p_y;
};

ConvexDistance proved(const ConvexDistance& found) {
  if (!found.is_proved) throw std::range_error("no distance");
  return found;
}

// The triangle of a surface that is nearest to a convex shape, by FCL's tree of boxes about the triangles. FCL's own
// search between a triangle and a shape ends too early in one of some 1,500 places.
template <typename Shape>
class SurfaceWalk {
 public:
  // below: m, nothing beyond counts
  SurfaceWalk(const Surface& surface, const Shape& shape, const fcl::Transform3d& X_SF, double below)
      : surface_(surface), shape_(shape), X_SF_(X_SF), found_{below, {}, {}} {
    fcl::computeBV(shape, X_SF.inverse(Eigen::Isometry), box_);
    visit(0);
  }

  // Nearest points: of the surface, of the shape; in the shape's axes.
  [[nodiscard]] const CoreDistance& found() const { return found_; }

 private:
  void visit(int index) {
    const fcl::BVNode<fcl::OBBRSSd>& node = surface_.getBV(index);
    if (node.isLeaf()) return compare(surface_.tri_indices[node.primitiveId()]);
    const auto bound = [&](int child) { return box_.distance(surface_.getBV(child).bv); };
    std::pair<double, int> near{bound(node.leftChild()), node.leftChild()};
    std::pair<double, int> far{bound(node.rightChild()), node.rightChild()};
    if (far.first < near.first) std::swap(near, far);
    for (const auto& [distance, child] : {near, far}) {
      if (distance < found_.distance) visit(child);
    }
  }

  void compare(const fcl::Triangle& triangle) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = X_SF_ * surface_.vertices[triangle[k]];
    const ConvexDistance nearest = proved(find_convex_distance([&](const Vector3d& d) {
      const Vector3d a = farthest_of(corners, d), b = farthest_point(shape_, -d);
      return Difference{a - b, a, b};
    }));
    if (nearest.distance < found_.distance) found_ = {nearest.distance, nearest.on_a, nearest.on_b};
  }

  const Surface& surface_;
  const Shape& shape_;
  fcl::Transform3d X_SF_;  // surface's axes to the shape's
  fcl::OBBRSSd box_;       // about the shape, in the surface's axes
  CoreDistance found_;
};

CoreDistance surface_distance(const Member& surface, const Member& other, double below) {
  const fcl::Transform3d& X_WS = other.object->getTransform();
  const fcl::Transform3d X_SF = X_WS.inverse(Eigen::Isometry) * surface.object->getTransform();
  const CoreDistance found = with_convex(*other.object->collisionGeometry(), [&](const auto& shape) {
    return SurfaceWalk(static_cast<const Surface&>(*surface.shape), shape, X_SF, below).found();
  });
  return {found.distance, X_WS * found.p_x, X_WS * found.p_y};
}

// FCL compares triangles in closed form.
CoreDistance distance_of_surfaces(const Member& x, const Member& y) {
  fcl::DistanceResultd result;
  fcl::distance(x.object.get(), y.object.get(), fcl::DistanceRequestd(true), result);
  return {std::max(result.min_distance, 0.0), result.nearest_points[0], result.nearest_points[1]};
}

CoreDistance convex_distance(const Member& x, const Member& y) {
  const fcl::Transform3d &X_WX = x.object->getTransform(), &X_WY = y.object->getTransform();
  const fcl::Transform3d X_XY = X_WX.inverse(Eigen::Isometry) * X_WY;
  const ConvexDistance found = with_convex(*x.object->collisionGeometry(), [&](const auto& a) {
    return with_convex(*y.object->collisionGeometry(), [&](const auto& b) {
      return proved(find_convex_distance([&](const Vector3d& d) {
        const Vector3d on_a = farthest_point(a, d);
        const Vector3d on_b = X_XY * farthest_point(b, -(X_XY.linear().transpose() * d));
        return Difference{on_a - on_b, on_a, on_b};
      }));
    });
  });
  return {found.distance, X_WX * found.on_a, X_WX * found.on_b};
}

void search_pair(Search& search, const Member& first, const Member& second) {
  if (first.frame == second.frame) return;
  // a surface goes first
  const bool is_exchanged = is_surface(*second.shape) && !is_surface(*first.shape);
  const Member &x = is_exchanged ? second : first, &y = is_exchanged ? first : second;
  const double radii = x.radius + y.radius;
  if (search.only_overlap && radii == 0) return search_contact(search, x, y);
  const double below = search.distance + radii;
  const CoreDistance cores = is_surface(*y.shape)   ? distance_of_surfaces(x, y)
                             : is_surface(*x.shape) ? surface_distance(x, y, below)
                                                    : convex_distance(x, y);
  const double core_distance = cores.distance;
  if (!(core_distance < below)) return;
  const Vector3d c_x = cores.p_x, c_y = cores.p_y;
  if (!(core_distance > 0)) {
    search_contact(search, x, y);
    if (search.is_done()) return;
    // touching to rounding: FCL finds no contact
    return take(search, x, y, 0, c_x, c_y, Vector3d::Zero());
  }
  const Vector3d n = (c_x - c_y) / core_distance;
  const Vector3d p_x = c_x - x.radius * n, p_y = c_y + y.radius * n;
  if (core_distance > radii) return take(search, x, y, core_distance - radii, p_x, p_y, n);
  const Vector3d middle = 0.5 * (p_x + p_y);
  take(search, x, y, 0, middle, middle, n);
}

void search_plane(Search& search, const Member& plane, const Member& other) {
  if (plane.frame == other.frame) return;
  const Vector3d n = plane.object->getTransform().linear().col(2);
  const Vector3d p = lowest_point(*other.object, n) - other.radius * n;
  const double d = n.dot(p - plane.object->getTransform().translation());
  if (d > 0) return take(search, other, plane, d, p, p - d * n, n);
  const Vector3d middle = p - 0.5 * d * n;
  take(search, other, plane, 0, middle, middle, n);
}

bool on_pair(fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* data, double& bound) {
  Search& search = *static_cast<Search*>(data);
  search_pair(search, member_of(first), member_of(second));
  // The boxes of the tree are those of the cores. For overlap alone nothing beyond the radii counts; FCL leaves out
  // boxes that are not nearer than the bound, so it stays above 0.
  bound = (search.only_overlap ? kTolerance : search.distance) + search.radii;
  return search.is_done();
}

using Tree = fcl::DynamicAABBTreeCollisionManagerd;

// A tree that depends on the present places alone: one that is updated would keep a trace of earlier ones, and equally
// near pairs would be found in another order.
void fill(Tree& tree, const Group& group) {
  std::vector<fcl::CollisionObjectd*> objects;
  for (const Member& member : group.members) objects.push_back(member.object.get());
  tree.registerObjects(objects);
  tree.setup();
}

// The squares of these distances are finite too. libccd aborts at others.
bool is_placed(const Group& group) {
  const auto is_finite = [](const Member& member) {
    const fcl::Transform3d& X = member.object->getTransform();
    return X.linear().allFinite() && X.translation().cwiseAbs().maxCoeff() < kFarthest;
  };
  return std::all_of(group.members.begin(), group.members.end(), is_finite) &&
         std::all_of(group.planes.begin(), group.planes.end(), is_finite);
}

void search_groups(Search& search, const Group& a, const Group& b) {
  if (!is_placed(a) || !is_placed(b)) throw std::range_error("a place is not finite");
  for (const auto& [planes, others] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Member& plane : planes->planes) {
      for (const Member& other : others->members) search_plane(search, plane, other);
    }
  }
  if (search.is_done() || a.members.empty() || b.members.empty()) return;
  if (a.members.size() == 1 && b.members.size() == 1) return search_pair(search, a.members[0], b.members[0]);
  Tree tree_a, tree_b;
  fill(tree_a, a);
  fill(tree_b, b);
  search.radii = a.largest_radius + b.largest_radius;
  tree_a.distance(&tree_b, &search, on_pair);
}

}  // namespace

struct Groups {
  const Geometries* geometries = nullptr;
  std::vector<Group> groups;
};

Groups* create_groups(const Geometries& geometries) {
  return new Groups{&geometries, {}};
}

void destroy(Groups* groups) noexcept {
  delete groups;
}

std::size_t add_group(Groups& groups, const std::size_t* shapes, const std::size_t* frames, std::size_t count) {
  Group group;
  for (std::size_t k = 0; k < count; ++k) {
    const fcl::CollisionGeometryd* shape = groups.geometries->shapes[shapes[k]].get();
    const Core& core = groups.geometries->cores[shapes[k]];
    std::vector<Member>& list = is_plane(*shape) ? group.planes : group.members;
    group.order.emplace_back(is_plane(*shape), list.size());
    group.largest_radius = std::max(group.largest_radius, core.radius);
    list.push_back(
        {std::make_unique<fcl::CollisionObjectd>(core.shape), shape, core.radius, groups.groups.size(), k, frames[k]});
  }
  groups.groups.push_back(std::move(group));
  // members have their final places
  for (Member& member : groups.groups.back().members) member.object->setUserData(&member);
  return groups.groups.size() - 1;
}

void place(Groups& groups, std::size_t group, std::size_t k, Placement placement) noexcept {
  Group& g = groups.groups[group];
  const auto [is_in_planes, index] = g.order[k];
  fcl::CollisionObjectd& object = *(is_in_planes ? g.planes : g.members)[index].object;
  object.setTransform(transform(placement));
  object.computeAABB();
}

QueryResult find_nearest(Groups& groups, std::size_t a, std::size_t b, Nearest& nearest) noexcept {
  try {
    Search search{.a = a};
    search_groups(search, groups.groups[a], groups.groups[b]);
    nearest.distance = search.distance;
    nearest.member_a = search.member_a;
    nearest.member_b = search.member_b;
    double sum = search.distance;
    for (int k = 0; k < 3; ++k) {
      nearest.p_a_W[k] = search.p_a[k];
      nearest.p_b_W[k] = search.p_b[k];
      nearest.n_W[k] = search.n[k];
      sum += search.p_a[k] + search.p_b[k] + search.n[k];
    }
    return std::isfinite(sum) ? QueryResult::fine : QueryResult::failed;
  } catch (...) {
    return QueryResult::failed;
  }
}

QueryResult find_overlap(Groups& groups, std::size_t a, std::size_t b, bool& overlaps) noexcept {
  try {
    Search search{.a = a, .only_overlap = true};
    search_groups(search, groups.groups[a], groups.groups[b]);
    overlaps = search.is_done();
    return QueryResult::fine;
  } catch (...) {
    return QueryResult::failed;
  }
}

}  // namespace slew::sensors::fcl_border
