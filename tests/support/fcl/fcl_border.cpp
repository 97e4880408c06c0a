#include "support/fcl/fcl_border.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

namespace slew::contact::fcl_border {

struct Geometries {
  std::vector<std::unique_ptr<fcl::CollisionGeometryd>> shapes;
};

struct Scratch {
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
};

namespace {

std::size_t add(Geometries& geometries, std::unique_ptr<fcl::CollisionGeometryd> shape) {
  shape->computeLocalAABB();
  geometries.shapes.push_back(std::move(shape));
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
  return add(geometries, std::make_unique<fcl::Sphered>(radius));
}

std::size_t add_box(Geometries& geometries, double x, double y, double z) {
  return add(geometries, std::make_unique<fcl::Boxd>(x, y, z));
}

std::size_t add_cylinder(Geometries& geometries, double radius, double length) {
  return add(geometries, std::make_unique<fcl::Cylinderd>(radius, length));
}

std::size_t add_capsule(Geometries& geometries, double radius, double length) {
  return add(geometries, std::make_unique<fcl::Capsuled>(radius, length));
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

}  // namespace slew::contact::fcl_border
