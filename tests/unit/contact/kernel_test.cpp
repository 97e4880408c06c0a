// SPDX-License-Identifier: Apache-2.0
// Contact points of simple positions, against a drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace kernel_test {

using math::Mat3;
using math::Vec3;
using namespace testing;

class Touch {
 public:
  Touch(const ShapeDef& a, const ShapeDef& b, Pose pose_a, Pose pose_b = {})
      : model_(build(two_shapes(a, b))), set_(model_) {
    const Pose poses[] = {pose_b, pose_a};
    find_contacts(model_, poses, set_);
  }
  [[nodiscard]] std::span<const ContactPoint> points() const { return set_.points(); }

 private:
  ContactModel model_;
  ContactSet set_;
};

void expect_point(const ContactPoint& point, Vec3 p_W, Vec3 n_W, double depth) {
  EXPECT_LT(norm(point.p_W - p_W), 1e-12) << point.p_W.x() << " " << point.p_W.y() << " " << point.p_W.z();
  EXPECT_LT(norm(point.n_W - n_W), 1e-12) << point.n_W.x() << " " << point.n_W.y() << " " << point.n_W.z();
  EXPECT_NEAR(point.depth, depth, 1e-12);
}

constexpr double kDeep = 0.01;

TEST(SpherePlane, TouchesBelowItsCentre) {
  const Touch touch(sphere(0.5), plane(), {.p_WF = {1, 2, 0.5 - kDeep}});
  ASSERT_EQ(touch.points().size(), 1u);
  expect_point(touch.points()[0], {1, 2, -kDeep / 2}, {0, 0, 1}, kDeep);
  EXPECT_EQ(touch.points()[0].share, 1);
  EXPECT_TRUE(Touch(sphere(0.5), plane(), {.p_WF = {0, 0, 0.5 + 1e-9}}).points().empty());
}

// the pair's order decides whose side the normal is on
TEST(PlaneSphere, HasTheNormalOfTheOtherSide) {
  ContactDef def = two_shapes(sphere(0.5), plane());
  std::swap(def.pairs[0].shape_a, def.pairs[0].shape_b);
  const ContactModel model = build(def);
  ContactSet set(model);
  const Pose poses[] = {{}, {.p_WF = {0, 0, 0.49}}};
  find_contacts(model, poses, set);
  ASSERT_EQ(set.points().size(), 1u);
  expect_point(set.points()[0], {0, 0, -0.005}, {0, 0, -1}, 0.01);
}

TEST(SphereSphere, TouchesOnTheLineOfCentres) {
  const Touch touch(sphere(0.5), sphere(0.3), {.p_WF = {0.8 - kDeep, 0, 0}});
  ASSERT_EQ(touch.points().size(), 1u);
  expect_point(touch.points()[0], {0.3 - kDeep / 2, 0, 0}, {1, 0, 0}, kDeep);
  // centres on each other: an axis of B
  const Touch inside(sphere(0.5), sphere(0.3), {});
  ASSERT_EQ(inside.points().size(), 1u);
  EXPECT_NEAR(inside.points()[0].depth, 0.8, 1e-12);
}

TEST(SphereBox, TouchesFaceEdgeCornerAndFindsTheWayOut) {
  const ShapeDef b = box(2, 4, 6);
  const auto only = [&](Vec3 centre) {
    const Touch touch(sphere(0.5), b, {.p_WF = centre});
    EXPECT_EQ(touch.points().size(), 1u);
    return touch.points().empty() ? ContactPoint{} : touch.points()[0];
  };
  expect_point(only({0.2, 0.3, 3.5 - kDeep}), {0.2, 0.3, 3 - kDeep / 2}, {0, 0, 1}, kDeep);
  const double e = 1 / std::sqrt(2.0), c = 1 / std::sqrt(3.0);
  expect_point(only(Vec3(1, 2, 0.5) + Vec3(e, e, 0) * (0.5 - kDeep)), Vec3(1, 2, 0.5) - Vec3(e, e, 0) * (kDeep / 2),
               {e, e, 0}, kDeep);
  expect_point(only(Vec3(-1, 2, 3) + Vec3(-c, c, c) * (0.5 - kDeep)), Vec3(-1, 2, 3) - Vec3(-c, c, c) * (kDeep / 2),
               {-c, c, c}, kDeep);
  // centre inside, 0.2 below the face at x = 1
  expect_point(only({0.8, 0, 0}), {0.8 - 0.5 + 0.35, 0, 0}, {1, 0, 0}, 0.7);
}

TEST(SphereCapsule, TouchesItsSideAndItsEnd) {
  const ShapeDef capsule = rounded(ShapeType::capsule, 0.2, 2);
  const Touch side(sphere(0.5), capsule, {.p_WF = {0.7 - kDeep, 0, 0.4}});
  ASSERT_EQ(side.points().size(), 1u);
  expect_point(side.points()[0], {0.2 - kDeep / 2, 0, 0.4}, {1, 0, 0}, kDeep);
  const Touch end(sphere(0.5), capsule, {.p_WF = {0, 0, -1.7 + kDeep}});
  ASSERT_EQ(end.points().size(), 1u);
  expect_point(end.points()[0], {0, 0, -1.2 + kDeep / 2}, {0, 0, -1}, kDeep);
}

TEST(CapsuleCapsule, TouchesCrossedInOnePointAndAlongsideInTwo) {
  const ShapeDef capsule = rounded(ShapeType::capsule, 0.2, 2);
  const Touch crossed(capsule, capsule, {{0.4 - kDeep, 0.3, 0.1}, math::rotation_x(M_PI / 2)});
  ASSERT_EQ(crossed.points().size(), 1u);
  expect_point(crossed.points()[0], {0.2 - kDeep / 2, 0, 0.1}, {1, 0, 0}, kDeep);
  const Touch alongside(capsule, capsule, {.p_WF = {0.4 - kDeep, 0, 0.5}});
  ASSERT_EQ(alongside.points().size(), 2u);
  expect_point(alongside.points()[0], {0.2 - kDeep / 2, 0, -0.5}, {1, 0, 0}, kDeep);
  expect_point(alongside.points()[1], {0.2 - kDeep / 2, 0, 1}, {1, 0, 0}, kDeep);
  const Touch end_to_end(capsule, capsule, {.p_WF = {0, 0, 2.4 - kDeep}});
  ASSERT_EQ(end_to_end.points().size(), 1u);
  expect_point(end_to_end.points()[0], {0, 0, 1.2 - kDeep / 2}, {0, 0, 1}, kDeep);
}

TEST(CapsuleBox, LiesOnTwoPointsStandsOnOneAndHangsOverAnEdge) {
  const ShapeDef capsule = rounded(ShapeType::capsule, 0.2, 1), table = box(2, 2, 2);
  const Mat3 lying = math::rotation_y(M_PI / 2);  // axis along x
  const Touch flat(capsule, table, {{0, 0.3, 1.2 - kDeep}, lying});
  ASSERT_EQ(flat.points().size(), 2u);
  expect_point(flat.points()[0], {-0.5, 0.3, 1 - kDeep / 2}, {0, 0, 1}, kDeep);
  expect_point(flat.points()[1], {0.5, 0.3, 1 - kDeep / 2}, {0, 0, 1}, kDeep);
  const Touch over_the_edge(capsule, table, {{0.8, 0.3, 1.2 - kDeep}, lying});
  ASSERT_EQ(over_the_edge.points().size(), 2u);
  expect_point(over_the_edge.points()[1], {1, 0.3, 1 - kDeep / 2}, {0, 0, 1}, kDeep);
  const Touch upright(capsule, table, {.p_WF = {0, 0, 1.7 - kDeep}});
  ASSERT_EQ(upright.points().size(), 1u);
  expect_point(upright.points()[0], {0, 0, 1 - kDeep / 2}, {0, 0, 1}, kDeep);
  // pushed in until its axis is 0.1 below the face
  const Touch deep(capsule, table, {{0, 0, 0.9}, lying});
  ASSERT_EQ(deep.points().size(), 1u);
  EXPECT_NEAR(deep.points()[0].depth, 0.3, 1e-12);
  EXPECT_NEAR(deep.points()[0].n_W.z(), 1, 1e-12);
}

TEST(BoxPlane, StandsOnFourCornersAndTipsOntoTwoAndOne) {
  const ShapeDef b = box(1, 2, 3);
  const Touch flat(b, plane(), {.p_WF = {0, 0, 1.5 - kDeep}});
  ASSERT_EQ(flat.points().size(), 4u);
  for (const ContactPoint& point : flat.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-14);
    EXPECT_NEAR(point.share, 0.25, 1e-12);
    EXPECT_NEAR(std::fabs(point.p_W.x()), 0.5, 1e-14);
    EXPECT_NEAR(std::fabs(point.p_W.y()), 1, 1e-14);
  }
  const Mat3 tipped = math::rotation_x(0.3);
  const double lowest = std::cos(0.3) * 1.5 + std::sin(0.3) * 1;
  EXPECT_EQ(Touch(b, plane(), {{0, 0, lowest - kDeep}, tipped}).points().size(), 2u);
  const Mat3 corner = math::rotation_x(0.3) * math::rotation_y(0.2);
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach += Vec3(0.5, 1, 1.5)[k] * std::fabs(corner(2, k));
  const Touch one(b, plane(), {{0, 0, reach - kDeep}, corner});
  ASSERT_EQ(one.points().size(), 1u);
  EXPECT_NEAR(one.points()[0].depth, kDeep, 1e-12);
}

TEST(CapsulePlane, LiesOnTwoEnds) {
  const ShapeDef capsule = rounded(ShapeType::capsule, 0.2, 2);
  EXPECT_EQ(Touch(capsule, plane(), {{0, 0, 0.2 - kDeep}, math::rotation_x(M_PI / 2)}).points().size(), 2u);
  const Touch upright(capsule, plane(), {.p_WF = {0, 0, 1.2 - kDeep}});
  ASSERT_EQ(upright.points().size(), 1u);
  expect_point(upright.points()[0], {0, 0, -kDeep / 2}, {0, 0, 1}, kDeep);
}

TEST(CylinderPlane, StandsOnFourPointsOfItsRimAndLiesOnTwo) {
  const ShapeDef cylinder = rounded(ShapeType::cylinder, 0.2, 2);
  for (const double turned : {0.0, M_PI}) {
    const Touch upright(cylinder, plane(), {{0, 0, 1 - kDeep}, math::rotation_y(turned)});
    ASSERT_EQ(upright.points().size(), 4u);
    Vec3 middle;
    for (const ContactPoint& point : upright.points()) {
      EXPECT_NEAR(point.depth, kDeep, 1e-12);
      EXPECT_NEAR(std::hypot(point.p_W.x(), point.p_W.y()), 0.2, 1e-12);
      middle += point.p_W;
    }
    EXPECT_NEAR(std::hypot(middle.x(), middle.y()), 0, 1e-12);
  }
  const Touch lying(cylinder, plane(), {{0, 0, 0.2 - kDeep}, math::rotation_x(M_PI / 2)});
  ASSERT_EQ(lying.points().size(), 2u);
  for (const ContactPoint& point : lying.points()) EXPECT_NEAR(point.depth, kDeep, 1e-12);
  // tipped: the lowest point of the rim by geometry
  const double angle = 0.4, reach = std::cos(angle) * 1 + std::sin(angle) * 0.2;
  const Touch tipped(cylinder, plane(), {{0, 0, reach - kDeep}, math::rotation_y(angle)});
  ASSERT_EQ(tipped.points().size(), 1u);
  EXPECT_NEAR(tipped.points()[0].depth, kDeep, 1e-12);
}

TEST(ConvexMeshPlane, StandsOnWhatIsBelow) {
  const Touch touch(box_mesh(1, 2, 3), plane(), {.p_WF = {0, 0, 1.5 - kDeep}});
  ASSERT_EQ(touch.points().size(), 4u);
  for (const ContactPoint& point : touch.points()) EXPECT_NEAR(point.depth, kDeep, 1e-12);
}

TEST(BoxBox, OnALargerOneStandsOnItsFourCorners) {
  const Touch touch(box(1, 1, 1), box(4, 4, 2), {{0.3, 0.2, 1.5 - kDeep}, math::rotation_z(0.4)});
  ASSERT_EQ(touch.points().size(), 4u);
  for (const ContactPoint& point : touch.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-12);
    EXPECT_NEAR(point.p_W.z(), 1 - kDeep / 2, 1e-12);
    EXPECT_LT(norm(point.n_W - Vec3(0, 0, 1)), 1e-12);
    const Vec3 away = point.p_W - Vec3(0.3, 0.2, 0);
    EXPECT_NEAR(std::hypot(away.x(), away.y()), std::sqrt(0.5), 1e-12);
  }
}

TEST(BoxBox, OfEqualSizeTurnedByAnEighthTouchesInAnOctagon) {
  const Touch touch(box(1, 1, 1), box(1, 1, 1), {{0, 0, 1 - kDeep}, math::rotation_z(M_PI / 4)});
  ASSERT_EQ(touch.points().size(), 8u);
  double shares = 0;
  for (const ContactPoint& point : touch.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-12);
    EXPECT_NEAR(std::max(std::fabs(point.p_W.x()), std::fabs(point.p_W.y())), 0.5, 1e-12);
    shares += point.share;
  }
  EXPECT_NEAR(shares, 1, 1e-14);
}

TEST(BoxBox, EdgeOnEdgeTouchesInOnePoint) {
  // two bars on their edges, crossed
  const Mat3 lower = math::rotation_x(M_PI / 4), upper = math::rotation_z(M_PI / 2) * math::rotation_x(M_PI / 4);
  const double reach = std::sqrt(0.5);
  const Touch touch(box(10, 1, 1), box(10, 1, 1), {{0.5, 0.25, 2 * reach - kDeep}, upper}, {{}, lower});
  ASSERT_EQ(touch.points().size(), 1u);
  expect_point(touch.points()[0], {0.5, 0, reach - kDeep / 2}, {0, 0, 1}, kDeep);
}

TEST(BoxBox, ApartHasNoContact) {
  EXPECT_TRUE(Touch(box(1, 1, 1), box(1, 1, 1), {.p_WF = {0, 0, 1 + 1e-9}}).points().empty());
  // bounding spheres overlap, boxes do not
  EXPECT_TRUE(Touch(box(1, 1, 1), box(1, 1, 1), {{1.3, 0, 0}, math::rotation_z(0.2)}).points().empty());
}

TEST(CylinderOnBox, StandsOnItsRimAndLiesOnALine) {
  const ShapeDef cylinder = rounded(ShapeType::cylinder, 0.5, 2), table = box(4, 4, 2);
  const Touch upright(cylinder, table, {.p_WF = {0.1, 0.2, 2 - kDeep}});
  ASSERT_EQ(upright.points().size(), 8u);
  for (const ContactPoint& point : upright.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-12);
    EXPECT_NEAR(point.n_W.z(), 1, 1e-12);
    EXPECT_NEAR(std::hypot(point.p_W.x() - 0.1, point.p_W.y() - 0.2), 0.5, 1e-12);
  }
  const Touch lying(cylinder, table, {{0.1, 0.2, 1.5 - kDeep}, math::rotation_x(M_PI / 2)});
  ASSERT_EQ(lying.points().size(), 2u);
  for (const ContactPoint& point : lying.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-12);
    EXPECT_NEAR(std::fabs(point.p_W.y() - 0.2), 1, 1e-12);
  }
  // across the edge of a beam on its corner: where the lines cross
  const Touch crossed(cylinder, box(1, 4, 1), {{0, 0.3, std::sqrt(0.5) + 0.5 - kDeep}, math::rotation_y(M_PI / 2)},
                      {{}, math::rotation_y(M_PI / 4)});
  ASSERT_EQ(crossed.points().size(), 1u);
  EXPECT_LT(norm(crossed.points()[0].p_W - Vec3(0, 0.3, std::sqrt(0.5) - kDeep / 2)), 1e-4);
  EXPECT_NEAR(crossed.points()[0].depth, kDeep, 1e-9);
}

TEST(CylinderOnCylinder, TouchesAlongsideInTwoPointsAndCrossedInOne) {
  const ShapeDef cylinder = rounded(ShapeType::cylinder, 0.2, 2);
  const Touch alongside(cylinder, cylinder, {.p_WF = {0.4 - kDeep, 0, 0.5}});
  ASSERT_EQ(alongside.points().size(), 2u);
  double low = 1, high = -1;
  for (const ContactPoint& point : alongside.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-9);
    EXPECT_NEAR(point.n_W.x(), 1, 1e-9);
    low = std::min(low, point.p_W.z());
    high = std::max(high, point.p_W.z());
  }
  EXPECT_NEAR(low, -0.5, 1e-4);
  EXPECT_NEAR(high, 1, 1e-4);
  const Touch crossed(cylinder, cylinder, {{0.4 - kDeep, 0.3, 0.1}, math::rotation_x(M_PI / 2)});
  ASSERT_EQ(crossed.points().size(), 1u);
  EXPECT_NEAR(crossed.points()[0].depth, kDeep, 1e-9);
  EXPECT_LT(norm(crossed.points()[0].p_W - Vec3(0.2 - kDeep / 2, 0, 0.1)), 1e-4);
}

TEST(SphereCylinder, TouchesSideEndAndRim) {
  const ShapeDef ball = sphere(0.3), cylinder = rounded(ShapeType::cylinder, 0.5, 2);
  const auto expect_one = [&](Vec3 centre, Vec3 p_W, Vec3 n_W, double depth) {
    const Touch touch(ball, cylinder, {.p_WF = centre});
    ASSERT_EQ(touch.points().size(), 1u);
    expect_point(touch.points()[0], p_W, n_W, depth);
  };
  expect_one({0.8 - kDeep, 0, 0.4}, {0.5 - kDeep / 2, 0, 0.4}, {1, 0, 0}, kDeep);
  expect_one({0.2, 0.1, -1.3 + kDeep}, {0.2, 0.1, -1 + kDeep / 2}, {0, 0, -1}, kDeep);
  const Vec3 out(std::sqrt(0.5), 0, std::sqrt(0.5));
  expect_one(Vec3(0.5, 0, 1) + out * (0.3 - kDeep), Vec3(0.5, 0, 1) - out * (kDeep / 2), out, kDeep);
  // inside: out over what is nearer
  expect_one({0, 0.4, 0}, {0, 0.3, 0}, {0, 1, 0}, 0.4);
  expect_one({0, 0, 0.8}, {0, 0, 0.75}, {0, 0, 1}, 0.5);
  EXPECT_TRUE(Touch(ball, cylinder, {.p_WF = Vec3(0.5, 0, 1) + out * (0.3 + 1e-9)}).points().empty());
}

// faces, edges, corners and inside of the box that the mesh is
TEST(SphereConvexMesh, TouchesAsItDoesTheBox) {
  for (const Vec3& centre : {Vec3(0.2, 0.3, 1.5 + 0.3 - kDeep), Vec3(-0.6, 0.3, 1.6), Vec3(0.6, -1.1, -1.6),
                             Vec3(0.1, 0.7, 1.0), Vec3(0.3, 0, 0)}) {
    const Touch mesh(sphere(0.3), box_mesh(1, 2, 3), {.p_WF = centre});
    const Touch own(sphere(0.3), box(1, 2, 3), {.p_WF = centre});
    ASSERT_EQ(mesh.points().size(), 1u);
    ASSERT_EQ(own.points().size(), 1u);
    expect_point(mesh.points()[0], own.points()[0].p_W, own.points()[0].n_W, own.points()[0].depth);
  }
}

TEST(ConvexMeshOnBox, StandsLikeTheBoxThatItIs) {
  const Pose pose{{0.3, 0.2, 1.5 - kDeep}, math::rotation_z(0.4)};
  const Touch mesh(box_mesh(1, 1, 1), box(4, 4, 2), pose), own(box(1, 1, 1), box(4, 4, 2), pose);
  ASSERT_EQ(mesh.points().size(), own.points().size());
  for (const ContactPoint& point : mesh.points()) {
    EXPECT_NEAR(point.depth, kDeep, 1e-12);
    EXPECT_TRUE(std::any_of(own.points().begin(), own.points().end(),
                            [&](const ContactPoint& other) { return norm(other.p_W - point.p_W) < 1e-12; }));
  }
}

// Equal boxes on each other, shifted and turned by what rounding does: corners of the common face double, and the
// centre of the normal forces stays where it was.
class CentreOfPressure : public ::testing::TestWithParam<std::pair<const char*, ShapeDef (*)(double, double, double)>> {
};
INSTANTIATE_TEST_SUITE_P(All, CentreOfPressure,
                         ::testing::Values(std::pair{"box", &box}, std::pair{"convex_mesh", &box_mesh}),
                         [](const auto& test) { return test.param.first; });

TEST_P(CentreOfPressure, OfEqualFacesDoesNotDependOnRounding) {
  for (const double edge : {1.0, 5e-4}) {
    const ShapeDef cube = GetParam().second(edge, edge, edge);
    std::size_t most = 0, least = 100;
    for (int i = 0; i < 200; ++i) {
      const auto rounding = [i](int k) { return 1e-15 * ((7 * i * k + 3 * i + k) % 11 - 5); };
      const Pose pose{Vec3(rounding(1), rounding(2), 1 - kDeep) * edge,
                      math::rotation_xyz({rounding(3), rounding(4), rounding(5)})};
      const Touch touch(cube, cube, pose);
      Vec3 centre;
      for (const ContactPoint& point : touch.points()) centre += point.p_W * point.share;
      EXPECT_LT(std::hypot(centre.x(), centre.y()), 1e-12 * edge);
      most = std::max(most, touch.points().size());
      least = std::min(least, touch.points().size());
    }
    EXPECT_LT(least, most) << "no corner was doubled: nothing was tested";
  }
}

TEST(BoxOnTriangles, AcrossTheirCommonEdgePressesInItsMiddle) {
  // two squares of two triangles each; the box stands across the line between them, with points on every edge
  ShapeDef ground = flat_field(3, 2, 2);
  const Touch touch(box(1, 1, 1), ground, {.p_WF = {1.9, 1.2, 0.5 - kDeep}});
  ASSERT_GT(touch.points().size(), 4u);
  Vec3 centre;
  for (const ContactPoint& point : touch.points()) centre += point.p_W * point.share;
  EXPECT_NEAR(centre.x(), 1.9, 1e-9);
  EXPECT_NEAR(centre.y(), 1.2, 1e-9);
}

}  // namespace kernel_test
}  // namespace slew::contact
