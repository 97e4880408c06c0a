// SPDX-License-Identifier: Apache-2.0
// The shortest way out of convex shapes against a search over all directions, and where the polytope is degenerate:
// shapes whose faces, edges and middles are in line.
#include "contact/overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/nightly.h"
#include "support/random_shapes.h"

namespace slew::contact {
namespace overlap_test {

using math::Mat3;
using math::Vec3;
using namespace testing;
using enum ShapeType;

struct Placed {
  Geometry a, b;
  Vec3 p_BA;
  Mat3 R_BA = Mat3::identity();

  [[nodiscard]] Overlap find() const { return find_overlap({&a, p_BA, R_BA}, {&b, Vec3(), Mat3::identity()}); }
  // overlap along n, by the reaches of both shapes
  [[nodiscard]] double along(Vec3 n) const {
    return reach({&b, Vec3(), Mat3::identity()}, n) + reach({&a, p_BA, R_BA}, -n);
  }
};

// the least overlap over all directions: points spread over the sphere, the best of them improved by smaller and
// smaller turns
double least_overlap(const Placed& shapes) {
  constexpr int kDirections = 4000, kImproved = 12;
  std::vector<std::pair<double, Vec3>> tried;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, angle = i * M_PI * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vec3 n(r * std::cos(angle), r * std::sin(angle), z);
    tried.emplace_back(shapes.along(n), n);
  }
  std::sort(tried.begin(), tried.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  double least = tried[0].first;
  for (int i = 0; i < kImproved; ++i) {
    auto [depth, n] = tried[static_cast<std::size_t>(i)];
    for (double turn = 0.05; turn > 1e-9;) {
      const Vec3 u = cross(n, std::fabs(n.x()) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)), x = u * (1 / norm(u));
      const Vec3 y = cross(n, x);
      bool is_better = false;
      for (int k = 0; k < 16; ++k) {
        const Vec3 next = n + (x * std::cos(k * M_PI / 8) + y * std::sin(k * M_PI / 8)) * turn;
        const Vec3 unit = next * (1 / norm(next));
        const double there = shapes.along(unit);
        if (there >= depth) continue;
        depth = there;
        n = unit;
        is_better = true;
        break;
      }
      if (!is_better) turn /= 2;
    }
    least = std::min(least, depth);
  }
  return least;
}

class FindOverlap : public RandomShapes {
 protected:
  FindOverlap() : RandomShapes(5) {}
};

constexpr ShapeType kTypes[] = {box, cylinder, capsule, convex_mesh};

TEST_F(FindOverlap, IsTheLeastOverAllDirections) {
  // 30 ms a draw: the search over directions
  const int draws = slew::testing::rounds(1, 12);
  double worst = 0;
  int touching = 0;
  for (const ShapeType a : kTypes) {
    for (const ShapeType b : kTypes) {
      for (int i = 0; i < draws; ++i) {
        const Placed shapes{make_geometry(shape(a)),
                            make_geometry(shape(b)),
                            {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)},
                            rotation()};
        const Overlap overlap = shapes.find();
        const double least = least_overlap(shapes);
        const std::string what = std::to_string(static_cast<int>(a)) + " " + std::to_string(static_cast<int>(b)) +
                                 " draw " + std::to_string(i);
        ASSERT_EQ(overlap.is_found, least > 0) << what << " " << least;
        if (!overlap.is_found) continue;
        ++touching;
        // the search over directions may end on a ridge, never below the truth; round shapes deep in each other have
        // nearly as short ways out on all sides
        EXPECT_LT(overlap.depth, least + (overlap.has_settled ? 1e-9 : 1e-6)) << what;
        EXPECT_NEAR(overlap.depth, shapes.along(overlap.n_W), 1e-12) << what;
        worst = std::max(worst, least - overlap.depth);
      }
    }
  }
  EXPECT_GT(touching, 5 * draws);
  RecordProperty("worst_of_the_search", std::to_string(worst));
}

// shallow, as loads press: the depth is right to a part of itself
TEST_F(FindOverlap, OfAShallowTouchIsRightToAPercentOfItsDepth) {
  for (const ShapeType a : kTypes) {
    for (const ShapeType b : kTypes) {
      for (int i = 0; i < 50; ++i) {
        Placed shapes{make_geometry(shape(a)),
                      make_geometry(shape(b)),
                      {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)},
                      rotation()};
        const Overlap deep = shapes.find();
        if (!deep.is_found || (a == capsule && b == capsule)) continue;
        constexpr double kDepth = 1e-5;
        shapes.p_BA += deep.n_W * (deep.depth - kDepth);
        const Overlap shallow = shapes.find();
        ASSERT_TRUE(shallow.is_found);
        EXPECT_NEAR(shallow.depth, kDepth, 1e-2 * kDepth) << static_cast<int>(a) << " " << static_cast<int>(b) << i;
      }
    }
  }
}

// every shape on every other with axes, faces, edges and middles in line
TEST_F(FindOverlap, SettlesWhereEverythingIsInLine) {
  const ShapeDef shapes[] = {testing::box(1, 1, 1), box_mesh(1, 1, 1), rounded(cylinder, 0.5, 1),
                             rounded(capsule, 0.25, 0.5)};
  for (const ShapeDef& a : shapes) {
    for (const ShapeDef& b : shapes) {
      if (a.type == capsule && b.type == capsule) continue;  // ball on ball: drawn, not searched
      for (const double z : {0.0, 0.3, 0.9, 0.99999}) {
        for (const double x : {0.0, 0.1, 0.5}) {
          for (const double turn : {0.0, M_PI / 4, M_PI / 2}) {
            const Placed placed{make_geometry(a), make_geometry(b), {x, 0, z}, math::rotation_z(turn)};
            const Overlap overlap = placed.find();
            ASSERT_TRUE(overlap.is_found);
            // one way out of all of them: straight up
            EXPECT_LE(overlap.depth, 1 - z + 1e-9);
            if (z < 0.8) continue;  // deep in each other: any of several ways
            EXPECT_TRUE(overlap.has_settled);
            EXPECT_NEAR(overlap.depth, 1 - z, 1e-9);
          }
        }
      }
      EXPECT_FALSE((Placed{make_geometry(a), make_geometry(b), {0.1, 0, 1 + 1e-9}, Mat3::identity()}.find().is_found));
    }
  }
}

TEST_F(FindOverlap, IsTheSameFarFromTheOrigin) {
  const Geometry a = make_geometry(rounded(cylinder, 0.5, 1)), b = make_geometry(box_mesh(1, 1, 1));
  const Mat3 R = math::rotation_zxz({0.3, 0.4, 0.5});
  const Vec3 p(0.3, 0.2, 0.7), far(1e5, -1e5, 1e5);
  const Overlap here = find_overlap({&a, p, R}, {&b, Vec3(), Mat3::identity()});
  const Overlap there = find_overlap({&a, far + p, R}, {&b, far, Mat3::identity()});
  ASSERT_TRUE(here.is_found && there.is_found);
  EXPECT_NEAR(here.depth, there.depth, 1e-9);
  EXPECT_LT(norm(far + here.p_W - there.p_W), 1e-4);
}

}  // namespace overlap_test
}  // namespace slew::contact
