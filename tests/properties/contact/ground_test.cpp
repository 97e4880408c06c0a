// SPDX-License-Identifier: Apache-2.0
// Triangle meshes and height fields against planes and boxes, whose contacts are known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/allocation_guard.h"
#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace ground_test {

using math::Mat3;
using math::Vec3;
using namespace testing;
using enum ShapeType;

// result of a search, ground in the first frame
std::vector<ContactPoint> contacts(const ShapeDef& a, const ShapeDef& ground, const Pose& pose_a,
                                   const Pose& pose_ground = {}) {
  const ContactModel model = build(two_shapes(a, ground));
  ContactSet set(model);
  const Pose poses[] = {pose_ground, pose_a};
  find_contacts(model, poses, set);
  return {set.points().begin(), set.points().end()};
}

const ContactPoint& deepest(const std::vector<ContactPoint>& points) {
  return *std::max_element(points.begin(), points.end(),
                           [](const ContactPoint& a, const ContactPoint& b) { return a.depth < b.depth; });
}

class Ground : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Mat3 rotation() { return math::rotation_zxz({uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)}); }
  ShapeDef shape(ShapeType type) {
    if (type == sphere) return testing::sphere(uniform(0.2, 1));
    if (type == box) return testing::box(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
    if (type == convex_mesh) return box_mesh(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
    return rounded(type, uniform(0.1, 0.8), uniform(0.2, 2));
  }
  // 10 m x 10 m about the origin, rising with the slope along x; cells of 0.37 m so that seams fall anywhere
  static ShapeDef field(double slope = 0) {
    ShapeDef def = flat_field(28, 28, 0.37);
    def.position = {-5, -5, 0};
    for (std::size_t i = 0; i < def.height_field.heights.size(); ++i) {
      def.height_field.heights[i] = slope * (static_cast<double>(i % 28) * 0.37 - 5);
    }
    return def;
  }
  static ShapeDef solid_box(double x, double y, double z) {
    ShapeDef def = box_mesh(x, y, z);
    def.type = triangle_mesh;
    return def;
  }
  std::mt19937 random_{5};
};

TEST_F(Ground, OfAnEvenHeightFieldActsLikeAPlane) {
  for (const double slope : {0.0, 0.3}) {
    const ShapeDef even = field(slope);
    ShapeDef plane = testing::plane();
    plane.orientation = {M_PI / 2, -std::atan(slope), 0};  // about z, then about the former y
    const Vec3 up = Vec3(-slope, 0, 1) * (1 / std::hypot(slope, 1.0));
    for (const ShapeType type : {sphere, capsule, box, cylinder, convex_mesh}) {
      int touching = 0;
      for (int i = 0; i < 100; ++i) {
        const ShapeDef a = shape(type);
        const double x = uniform(-1, 1);
        const Pose pose{{x, uniform(-1, 1), uniform(0.01, 1) + slope * x}, rotation()};
        const auto on_plane = contacts(a, plane, pose), on_field = contacts(a, even, pose);
        ASSERT_EQ(on_plane.empty(), on_field.empty()) << static_cast<int>(type) << " draw " << i;
        if (on_plane.empty()) continue;
        ++touching;
        ASSERT_LT(norm(on_plane[0].n_W - up), 1e-12);
        ASSERT_NEAR(deepest(on_field).depth, deepest(on_plane).depth, 1e-9) << static_cast<int>(type) << " draw " << i;
        ASSERT_LE(on_field.size(), kMaxPointsPerPair);
        for (const ContactPoint& point : on_field) ASSERT_LT(norm(point.n_W - up), 1e-12);
      }
      EXPECT_GT(touching, 30);
    }
  }
}

TEST_F(Ground, CarriesABoxAtItsCornersAcrossSeams) {
  for (int i = 0; i < 100; ++i) {
    const Pose pose{{uniform(-1, 1), uniform(-1, 1), 0.499}, math::rotation_z(uniform(-3, 3))};
    const auto points = contacts(testing::box(1, 1, 1), field(), pose);
    // where the shares put the load: nowhere near an edge of the box
    Vec3 middle;
    for (const ContactPoint& point : points) {
      ASSERT_NEAR(point.depth, 1e-3, 1e-12);
      middle += point.p_W * point.share;
    }
    ASSERT_LT(std::hypot(middle.x() - pose.p_WF.x(), middle.y() - pose.p_WF.y()), 0.25) << i;
    // and wide enough to stand on
    double widest = 0;
    for (const ContactPoint& p : points) {
      for (const ContactPoint& q : points) widest = std::max(widest, norm(p.p_W - q.p_W));
    }
    ASSERT_GT(widest, 1.0);
  }
}

TEST_F(Ground, OfABoxOfTrianglesActsOnASphereLikeTheBox) {
  int touching = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = uniform(0.5, 2), y = uniform(0.5, 2), z = uniform(0.5, 2);
    const ShapeDef a = testing::sphere(uniform(0.1, 1));
    const Pose pose{{uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}, Mat3::identity()};
    const bool is_inside =
        std::fabs(pose.p_WF.x()) < x / 2 && std::fabs(pose.p_WF.y()) < y / 2 && std::fabs(pose.p_WF.z()) < z / 2;
    if (is_inside) continue;
    const auto on_box = contacts(a, testing::box(x, y, z), pose), on_mesh = contacts(a, solid_box(x, y, z), pose);
    ASSERT_EQ(on_box.size(), on_mesh.size()) << i;
    if (on_box.empty()) continue;
    ++touching;
    ASSERT_NEAR(on_box[0].depth, on_mesh[0].depth, 1e-9);
    ASSERT_LT(norm(on_box[0].n_W - on_mesh[0].n_W), 1e-6);
    ASSERT_LT(norm(on_box[0].p_W - on_mesh[0].p_W), 1e-9);
  }
  EXPECT_GT(touching, 400);
}

TEST_F(Ground, OfABoxOfTrianglesCarriesABoxLikeTheBox) {
  int touching = 0;
  for (int i = 0; i < 4000; ++i) {
    const ShapeDef a = testing::box(uniform(0.3, 1), uniform(0.3, 1), uniform(0.3, 1));
    const Pose pose{{uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}, rotation()};
    const auto on_box = contacts(a, testing::box(2, 2, 2), pose);
    if (on_box.empty() || deepest(on_box).depth > 0.02) continue;
    // where a face of the ground decides
    const Vec3 n = on_box[0].n_W;
    if (std::max({std::fabs(n.x()), std::fabs(n.y()), std::fabs(n.z())}) < 1 - 1e-12) continue;
    const auto on_mesh = contacts(a, solid_box(2, 2, 2), pose);
    ASSERT_FALSE(on_mesh.empty()) << i;
    ASSERT_NEAR(deepest(on_box).depth, deepest(on_mesh).depth, 1e-9) << i;
    for (const ContactPoint& point : on_mesh) ASSERT_LT(norm(point.n_W - n), 1e-9) << i;
    ++touching;
  }
  EXPECT_GT(touching, 30);
}

// a box on the very edge of another is carried upwards, not pushed off sideways by the wall below
TEST_F(Ground, CarriesABoxAtTheEdgeOfATable) {
  for (const double overhang : {0.05, 0.25, 0.45}) {
    const auto points =
        contacts(testing::box(1, 1, 1), solid_box(2, 2, 2), {{0.5 + overhang, 0.1, 1.5 - 1e-3}, Mat3::identity()});
    ASSERT_FALSE(points.empty());
    for (const ContactPoint& point : points) {
      EXPECT_LT(norm(point.n_W - Vec3(0, 0, 1)), 1e-12);
      EXPECT_NEAR(point.depth, 1e-3, 1e-12);
      EXPECT_LT(point.p_W.x(), 1 + 1e-12);
    }
  }
}

TEST_F(Ground, ContactsMoveWithTheGroundAndDoNotAllocate) {
  const ShapeDef flat = field();
  for (const ShapeType type : {sphere, capsule, box, cylinder, convex_mesh}) {
    for (int i = 0; i < 50; ++i) {
      const ContactModel model = build(two_shapes(shape(type), flat));
      ContactSet set(model);
      const Pose pose{{uniform(-1, 1), uniform(-1, 1), uniform(0.01, 0.5)}, rotation()};
      const Mat3 R = rotation();
      const Vec3 p(uniform(-9, 9), uniform(-9, 9), uniform(-9, 9));
      const std::array<Pose, 2> here = {Pose{}, pose}, there = {Pose{p, R}, Pose{p + R * pose.p_WF, R * pose.R_WF}};
      find_contacts(model, here, set);
      const std::vector<ContactPoint> first(set.points().begin(), set.points().end());
      const AllocationGuard guard;
      find_contacts(model, there, set);
      ASSERT_EQ(guard.allocations(), 0u);
      ASSERT_EQ(set.points().empty(), first.empty());
      if (first.empty()) continue;
      const std::vector<ContactPoint> second(set.points().begin(), set.points().end());
      ASSERT_NEAR(deepest(first).depth, deepest(second).depth, 1e-9);
      ASSERT_LT(norm(R * first[0].n_W - second[0].n_W), 1e-9);
    }
  }
}

}  // namespace ground_test
}  // namespace slew::contact
