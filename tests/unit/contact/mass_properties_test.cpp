// SPDX-License-Identifier: Apache-2.0
// Mass properties of meshes against the formulas of the solids.
#include "contact/mass_properties.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "contact/mesh_check.h"
#include "contact/mesh_overlap.h"
#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace mass_properties_test {

using math::Mat3;
using math::Vec3;
using namespace testing;

constexpr double kDensity = 7850;  // kg/m3, steel

MeshDef moved(MeshDef mesh, const Mat3& R, Vec3 p) {
  for (Triple& v : mesh.vertices) v = (p + R * Vec3(v)).array();
  return mesh;
}

void expect_inertia(const Mat3& I, const Mat3& expected, double tolerance) {
  const double scale = expected(0, 0) + expected(1, 1) + expected(2, 2);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(I(i, j), expected(i, j), tolerance * scale) << i << j;
  }
}

Mat3 box_inertia(double m, double x, double y, double z) {
  return Mat3::diagonal(m / 12 * (y * y + z * z), m / 12 * (x * x + z * z), m / 12 * (x * x + y * y));
}

TEST(MassProperties, OfABoxAreItsFormulasWhereverItIs) {
  const MeshDef box = box_mesh(1, 2, 3).mesh;
  const double m = 6 * kDensity;
  for (const double far : {0.0, 10.0, 1e5}) {
    const Mat3 R = math::rotation_zxz({0.3, 0.7, -1.1});
    const Vec3 p = Vec3(1, -2, 0.5) * far;
    const MassProperties of_box = mass_properties(moved(box, R, p), kDensity);
    // positions of 1e5 m have 1e-11 m left
    const double tolerance = far > 1e4 ? 1e-10 : 1e-13;
    EXPECT_NEAR(of_box.volume, 6, 6 * tolerance);
    EXPECT_NEAR(of_box.mass, m, m * tolerance);
    EXPECT_LT(norm(of_box.centre - p), tolerance * 10 + 1e-15 * norm(p));
    expect_inertia(of_box.inertia, R * box_inertia(m, 1, 2, 3) * transpose(R), tolerance);
  }
}

// corner at the origin, legs along the axes: volume abc/6, centre at a quarter, textbook inertia
TEST(MassProperties, OfATetrahedronAreItsFormulas) {
  const double a = 1, b = 2, c = 3;
  MeshDef mesh;
  mesh.vertices = {{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  ASSERT_FALSE(find_closed_fault(mesh).has_value());
  const MassProperties p = mass_properties(mesh, kDensity);
  const double m = kDensity * a * b * c / 6;
  EXPECT_NEAR(p.mass, m, m * 1e-14);
  EXPECT_LT(norm(p.centre - Vec3(a, b, c) * 0.25), 1e-15 * 10);
  // integrals of x^2 and x y over it: m a^2/10, m a b/20, about the corner; then Steiner
  const double xx = m * a * a * (0.1 - 1.0 / 16), yy = m * b * b * (0.1 - 1.0 / 16), zz = m * c * c * (0.1 - 1.0 / 16);
  const double xy = m * a * b * (0.05 - 1.0 / 16), xz = m * a * c * (0.05 - 1.0 / 16),
               yz = m * b * c * (0.05 - 1.0 / 16);
  expect_inertia(p.inertia, {Vec3(yy + zz, -xy, -xz), Vec3(-xy, xx + zz, -yz), Vec3(-xz, -yz, xx + yy)}, 1e-14);
}

// two boxes that overlap nowhere count as one body; a box turned inside out is a hole
TEST(MassProperties, AddUpAndSubtract) {
  MeshDef bars = box_mesh(2, 1, 1).mesh;
  append(bars, moved(box_mesh(2, 1, 1).mesh, Mat3::identity(), {4, 0, 0}));
  const MassProperties two = mass_properties(bars, kDensity);
  const double m = 2 * kDensity;
  EXPECT_NEAR(two.mass, 2 * m, 1e-13 * m);
  EXPECT_LT(norm(two.centre - Vec3(2, 0, 0)), 1e-13);
  expect_inertia(two.inertia, box_inertia(m, 2, 1, 1) * 2 + Mat3::diagonal(0, 2 * m * 4, 2 * m * 4), 1e-13);

  MeshDef hollow = box_mesh(2, 2, 2).mesh, hole = box_mesh(1, 1, 1).mesh;
  for (auto& t : hole.triangles) std::swap(t[0], t[1]);
  append(hollow, hole);
  ASSERT_FALSE(find_closed_fault(hollow).has_value());
  const MassProperties shell = mass_properties(hollow, kDensity);
  EXPECT_NEAR(shell.volume, 7, 1e-13);
  expect_inertia(shell.inertia, box_inertia(8 * kDensity, 2, 2, 2) - box_inertia(kDensity, 1, 1, 1), 1e-13);
}

// J/A = r^2 (2 + cos(2 pi/n))/6; a cylinder in the limit, with an error of 1/n^2
TEST(MassProperties, OfAPrismAreExactAndThoseOfACylinderInTheLimit) {
  const double r = 0.4, h = 1.5;
  double before = 0;
  for (const std::uint32_t n : {6U, 12U, 24U, 48U}) {
    const MeshDef mesh = prism(n, r, h);
    ASSERT_FALSE(find_convex_fault(mesh).has_value()) << find_convex_fault(mesh)->what;
    const MassProperties p = mass_properties(mesh, kDensity);
    const double m = kDensity * h * n / 2 * r * r * std::sin(2 * M_PI / n);
    const double J = m * r * r / 6 * (2 + std::cos(2 * M_PI / n));
    EXPECT_NEAR(p.mass, m, 1e-13 * m);
    expect_inertia(p.inertia, Mat3::diagonal(J / 2 + m * h * h / 12, J / 2 + m * h * h / 12, J), 1e-13);
    const double of_cylinder = kDensity * M_PI * r * r * h;
    const double gap = (of_cylinder - p.mass) / of_cylinder;
    if (before > 0) {
      EXPECT_NEAR(before / gap, 4, 0.2);
    }
    before = gap;
  }
}

// an octahedron refined on the unit sphere: mass and inertia of a ball with an error of 1/4 a refinement
MeshDef octahedron() {
  MeshDef mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

// each triangle parted into four, the new vertices on the unit ball
MeshDef refined(const MeshDef& mesh) {
  MeshDef finer;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(finer.vertices.size());
    for (std::size_t k = 0; k < 3; ++k) finer.vertices.push_back(mesh.vertices[t[k]]);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 half = Vec3(mesh.vertices[t[k]]) + Vec3(mesh.vertices[t[(k + 1) % 3]]);
      finer.vertices.push_back((half * (1 / norm(half))).array());
    }
    for (const auto& part : {std::array{0U, 3U, 5U}, {3U, 1U, 4U}, {5U, 4U, 2U}, {3U, 4U, 5U}}) {
      finer.triangles.push_back({first + part[0], first + part[1], first + part[2]});
    }
  }
  return finer;
}

TEST(MassProperties, OfARefinedOctahedronBecomeThoseOfABall) {
  MeshDef mesh = octahedron();
  double before = 0;
  for (int level = 0; level < 5; ++level) {
    mesh = refined(mesh);
    const MassProperties p = mass_properties(mesh, 1);
    const double ball = 4 * M_PI / 3;
    const double gap = 1 - p.inertia(0, 0) / (0.4 * ball);
    if (level > 1) {
      EXPECT_NEAR(before / gap, 4, 0.3);
    }
    before = gap;
    EXPECT_LT(norm(p.centre), 1e-13);
  }
  EXPECT_LT(before, 0.01);
}

// ---- solids that touch, triangles without area ----------------------------------------------------------------------

// vertices at one place become one, as read_mesh() has it
MeshDef welded(const MeshDef& mesh) {
  MeshDef out;
  std::map<Triple, std::uint32_t> index;
  for (const auto& t : mesh.triangles) {
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Triple& p = mesh.vertices[t[k]];
      const auto [at, is_new] = index.insert({p, static_cast<std::uint32_t>(out.vertices.size())});
      if (is_new) out.vertices.push_back(p);
      triangle[k] = at->second;
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

MeshDef two_boxes(Vec3 apart) {
  MeshDef both = box_mesh(1, 2, 3).mesh;
  append(both, moved(box_mesh(1, 2, 3).mesh, Mat3::identity(), apart));
  return welded(both);
}

TEST(SolidCheck, TakesSolidsThatTouchAtAFaceAnEdgeOrAVertex) {
  for (const Vec3 apart : {Vec3(1, 0, 0), Vec3(1, 2, 0), Vec3(1, 2, 3)}) {
    const MeshDef both = two_boxes(apart);
    ASSERT_LT(both.vertices.size(), 16U) << "they touch";
    const auto fault = find_solid_fault(both);
    ASSERT_FALSE(fault.has_value()) << fault->what;
    const MassProperties p = mass_properties(both, kDensity);
    EXPECT_NEAR(p.volume, 12, 1e-12);
    EXPECT_LT(norm(p.centre - apart * 0.5), 1e-13);
    const Vec3 d = apart * 0.5;
    const Mat3 far = Mat3::diagonal(dot(d, d), dot(d, d), dot(d, d)) - outer(d, d);
    const double m = 6 * kDensity;
    expect_inertia(p.inertia, (box_inertia(m, 1, 2, 3) + far * m) * 2, 1e-13);
  }
}

TEST(SolidCheck, TakesTrianglesWithoutArea) {
  MeshDef box = box_mesh(1, 2, 3).mesh;
  // an edge is split on one side only, which a triangle without area closes
  const auto [a, b, c] = box.triangles[0];
  const auto middle = static_cast<std::uint32_t>(box.vertices.size());
  box.vertices.push_back(((Vec3(box.vertices[a]) + Vec3(box.vertices[b])) * 0.5).array());
  box.triangles[0] = {a, middle, c};
  box.triangles.push_back({middle, b, c});
  EXPECT_TRUE(find_solid_fault(box).has_value());
  box.triangles.push_back({a, b, middle});
  box.triangles.push_back({a, a, b});
  ASSERT_FALSE(find_solid_fault(box).has_value());
  ASSERT_TRUE(find_closed_fault(box).has_value()) << "contact has stronger conditions";
  const MassProperties p = mass_properties(box, kDensity);
  EXPECT_NEAR(p.volume, 6, 1e-13);
  expect_inertia(p.inertia, box_inertia(6 * kDensity, 1, 2, 3), 1e-13);
}

TEST(SolidCheck, RefusesWhatEnclosesNothingOrTurnsWrongly) {
  MeshDef open = box_mesh(1, 2, 3).mesh;
  open.triangles.pop_back();
  EXPECT_NE(find_solid_fault(open)->what.find("it is not closed"), std::string::npos);
  MeshDef turned = box_mesh(1, 2, 3).mesh;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_NE(find_solid_fault(turned)->what.find("turn differently"), std::string::npos);
  // a second part inside out beside a larger one would take its volume away; within it, it is a hole
  const auto with_reversed = [](Vec3 at) {
    MeshDef mesh = box_mesh(4, 4, 4).mesh, small = moved(box_mesh(1, 1, 1).mesh, Mat3::identity(), at);
    for (auto& t : small.triangles) std::swap(t[0], t[1]);
    append(mesh, small);
    return mesh;
  };
  EXPECT_FALSE(find_solid_fault(with_reversed({0.5, 0, 0})).has_value());
  const auto beside = find_solid_fault(with_reversed({5, 0, 0}));
  ASSERT_TRUE(beside.has_value());
  EXPECT_NE(beside->what.find("is inside out, and no other part surrounds it"), std::string::npos);
}

// ---- solids that overlap -------------------------------------------------------------------------------------------

// boxes of 1 x 2 x 3 m share (1 - |x|)(2 - |y|)(3 - |z|), whichever way both are turned
TEST(DoubledVolume, OfTwoBoxesIsThatOfTheirCommonBox) {
  for (const Vec3 apart : {Vec3(0.5, 0, 0), Vec3(0.9, -1.5, 0.2), Vec3(0.99, 0, 0), Vec3(0, 1.96, 0),
                           Vec3(0.3, 0.2, -2.7), Vec3(0, 0, 0)}) {
    const double common = (1 - std::fabs(apart[0])) * (2 - std::fabs(apart[1])) * (3 - std::fabs(apart[2]));
    for (const double turn : {0.0, 0.4, 1.3}) {
      SCOPED_TRACE(std::to_string(common) + " m3, turned by " + std::to_string(turn));
      const MeshDef both = moved(two_boxes(apart), math::rotation_zxz({turn, 2 * turn, -turn}), {3, -2, 100});
      EXPECT_NEAR(find_doubled_volume(both).volume, common, 0.02 * common);
      const auto fault = find_solid_fault(both);
      ASSERT_TRUE(fault.has_value());
      EXPECT_NE(fault->what.find("its solids overlap"), std::string::npos) << fault->what;
    }
  }
}

TEST(DoubledVolume, OfThreeBoxesCountsEachSurplus) {
  // 0.5 m apart along x: two common slices of 0.5 m3 x 6, none of all three
  MeshDef mesh = two_boxes({0.5, 0, 0});
  append(mesh, moved(box_mesh(1, 2, 3).mesh, Mat3::identity(), {1, 0, 0}));
  EXPECT_NEAR(find_doubled_volume(mesh).volume, 6, 0.05);
  // all at one place: 6 m3 that count three times
  MeshDef thrice = box_mesh(1, 2, 3).mesh;
  for (int i = 0; i < 2; ++i) append(thrice, box_mesh(1, 2, 3).mesh);
  EXPECT_NEAR(find_doubled_volume(thrice).volume, 12, 1e-9);
}

// a ball of 0.5 m within a box, and one that sticks out of it by half
TEST(DoubledVolume, OfABallInABoxIsTheBallsWithin) {
  MeshDef ball = octahedron();
  for (int level = 0; level < 4; ++level) ball = refined(ball);
  for (Triple& v : ball.vertices) v = (Vec3(v) * 0.5).array();
  const double volume = mass_properties(ball, 1).volume;
  for (const double x : {0.0, 2.0}) {
    MeshDef mesh = box_mesh(4, 4, 4).mesh;
    append(mesh, moved(ball, Mat3::identity(), {x, 0, 0}));
    EXPECT_NEAR(find_doubled_volume(mesh).volume, x > 0 ? volume / 2 : volume, 0.03 * volume);
    EXPECT_TRUE(find_solid_fault(mesh).has_value());
  }
  // inside out it is a hole, where it lies within the box
  for (auto& t : ball.triangles) std::swap(t[0], t[1]);
  MeshDef hole = box_mesh(4, 4, 4).mesh;
  append(hole, ball);
  EXPECT_EQ(find_doubled_volume(hole).volume, 0);
}

TEST(DoubledVolume, OfThinPlatesAndBarsIsFoundInAnyDirection) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 plate(1, 1, 1), bar(0.01, 0.01, 0.01);
    plate.lanes[axis] = 1e-3;
    bar.lanes[axis] = 1;
    for (const Vec3& size : {plate, bar}) {
      SCOPED_TRACE(axis);
      // beside a small box, far away, so that the box around all is five times as large
      MeshDef mesh = moved(box_mesh(0.01, 0.01, 0.01).mesh, Mat3::identity(), {4, 4, 4});
      for (int i = 0; i < 2; ++i) append(mesh, box_mesh(size[0], size[1], size[2]).mesh);
      const double volume = size[0] * size[1] * size[2];
      EXPECT_GT(find_doubled_volume(mesh).volume, 0.3 * volume);
      EXPECT_TRUE(find_solid_fault(mesh).has_value());
    }
  }
}

// touching, at any attitude, with vertices of single precision
TEST(DoubledVolume, OfSolidsThatTouchIsNothing) {
  for (const Vec3 apart : {Vec3(1, 0, 0), Vec3(1, 2, 0), Vec3(1, 2, 3), Vec3(0, 2, 1.3), Vec3(1, 0.7, -0.4)}) {
    for (const double turn : {0.0, 0.4, 1.3}) {
      MeshDef both = moved(two_boxes(apart), math::rotation_zxz({turn, 2 * turn, -turn}), {3, -2, 10});
      for (Triple& v : both.vertices) {
        for (double& x : v) x = static_cast<float>(x);
      }
      EXPECT_LT(find_doubled_volume(both).volume, 1e-5);
      EXPECT_FALSE(find_solid_fault(both).has_value());
    }
  }
}

// ---- sheets ---------------------------------------------------------------------------------------------------------

TEST(ShellProperties, OfAPlateAreItsFormulas) {
  // 2 x 3 m in the plane z = 0.5, 4 mm thick, its triangles turning either way
  MeshDef plate;
  plate.vertices = {{0, 0, 0.5}, {2, 0, 0.5}, {2, 3, 0.5}, {0, 3, 0.5}};
  plate.triangles = {{0, 1, 2}, {0, 3, 2}};
  const MassProperties p = shell_properties(plate, 0.004, kDensity);
  const double m = 6 * 0.004 * kDensity;
  EXPECT_NEAR(p.mass, m, 1e-13 * m);
  EXPECT_LT(norm(p.centre - Vec3(1, 1.5, 0.5)), 1e-14);
  expect_inertia(p.inertia, Mat3::diagonal(m * 9 / 12, m * 4 / 12, m * 13 / 12), 1e-13);
}

TEST(ShellProperties, OfARefinedOctahedronBecomeThoseOfAHollowBall) {
  MeshDef mesh = octahedron();
  double before = 0;
  for (int level = 0; level < 5; ++level) {
    mesh = refined(mesh);
    const MassProperties p = shell_properties(mesh, 0.01, 1);
    const double m = 4 * M_PI * 0.01, gap = 1 - p.inertia(0, 0) / (2 * m / 3);
    if (level > 1) {
      EXPECT_NEAR(before / gap, 4, 0.3);
    }
    before = gap;
    EXPECT_LT(norm(p.centre), 1e-13);
  }
  EXPECT_LT(before, 0.01);
}

}  // namespace mass_properties_test
}  // namespace slew::contact
