// SPDX-License-Identifier: Apache-2.0
// Mass properties of simple solids against textbook numbers and against quadrature: points of Gauss-Legendre rules in
// the solid, moved one by one into the body, summed as 1, x and x x^T. No formula of a solid, no parallel axis and no
// turned tensor is used there.
#include "contact/shape_properties.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "support/nightly.h"

namespace slew::contact {
namespace shape_properties_test {

using math::Mat3;
using math::Vec3;
using slew::testing::for_each_seed;
using slew::testing::seeds;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;

// nodes and weights on -1 .. 1, exact to degree 9
constexpr std::array<double, 5> kNodes = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                          0.9061798459386640};
constexpr std::array<double, 5> kWeights = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                            0.4786286704993665, 0.2369268850561891};

using Visit = std::function<void(double x, double y, double z, double weight)>;

void visit_box(std::array<double, 3> low, std::array<double, 3> high, const Visit& visit) {
  std::array<double, 3> half{}, middle{};
  for (std::size_t i = 0; i < 3; ++i) {
    half[i] = (high[i] - low[i]) / 2;
    middle[i] = (high[i] + low[i]) / 2;
  }
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; j < 5; ++j) {
      for (std::size_t k = 0; k < 5; ++k) {
        visit(middle[0] + half[0] * kNodes[i], middle[1] + half[1] * kNodes[j], middle[2] + half[2] * kNodes[k],
              half[0] * half[1] * half[2] * kWeights[i] * kWeights[j] * kWeights[k]);
      }
    }
  }
}

// a body of revolution about z between two heights, hollow inside of r_in
void visit_revolution(double z0, double z1, double r_in, const std::function<double(double)>& r_out,
                      const Visit& visit) {
  for (std::size_t i = 0; i < 5; ++i) {
    const double z = (z0 + z1) / 2 + (z1 - z0) / 2 * kNodes[i], R = r_out(z);
    for (std::size_t j = 0; j < 5; ++j) {
      const double r = (R + r_in) / 2 + (R - r_in) / 2 * kNodes[j];
      for (int k = 0; k < 8; ++k) {
        const double phi = 2 * kPi * k / 8;
        visit(r * std::cos(phi), r * std::sin(phi), z,
              (z1 - z0) / 2 * kWeights[i] * (R - r_in) / 2 * kWeights[j] * r * 2 * kPi / 8);
      }
    }
  }
}

void visit_ball_ends(double R, double L, const Visit& visit) {
  for (const double side : {-1.0, 1.0}) {
    const double base = side * L / 2;
    visit_revolution(
        std::min(base, base + side * R), std::max(base, base + side * R), 0,
        [&](double z) { return std::sqrt(R * R - (z - base) * (z - base)); }, visit);
  }
}

void visit_solid(const SolidDef& def, const Visit& visit) {
  const double L = def.length;
  switch (def.type) {
    case SolidType::box:
      return visit_box({-def.size[0] / 2, -def.size[1] / 2, -def.size[2] / 2},
                       {def.size[0] / 2, def.size[1] / 2, def.size[2] / 2}, visit);
    case SolidType::hollow_box: {  // two walls over the whole height, two flanges between them
      const double y = def.width / 2, z = def.height / 2, yi = y - def.wall, zi = z - def.flange;
      visit_box({-L / 2, -y, -z}, {L / 2, -yi, z}, visit);
      visit_box({-L / 2, yi, -z}, {L / 2, y, z}, visit);
      visit_box({-L / 2, -yi, -z}, {L / 2, yi, -zi}, visit);
      return visit_box({-L / 2, -yi, zi}, {L / 2, yi, z}, visit);
    }
    case SolidType::sphere:
      return visit_ball_ends(def.radius, 0, visit);
    case SolidType::cylinder:
      return visit_revolution(
          -L / 2, L / 2, 0, [&](double) { return def.radius; }, visit);
    case SolidType::tube:
      return visit_revolution(
          -L / 2, L / 2, def.inner_diameter / 2, [&](double) { return def.diameter / 2; }, visit);
    case SolidType::cone:
      return visit_revolution(
          -L / 2, L / 2, 0, [&](double z) { return def.radius * (0.5 - z / L) + def.top_radius * (0.5 + z / L); },
          visit);
    case SolidType::capsule:
      visit_ball_ends(def.radius, L, visit);
      return visit_revolution(
          -L / 2, L / 2, 0, [&](double) { return def.radius; }, visit);
  }
}

// volume, mass, centre and the tensor about it, from points
struct Integral {
  double volume = 0, mass = 0;
  std::array<double, 3> centre{};
  std::array<std::array<double, 3>, 3> inertia{};
};

Integral integral_of(const std::vector<PlacedSolid>& parts) {
  Integral out;
  const auto for_each_point = [&](const std::function<void(std::array<double, 3>, double, double)>& use) {
    for (const PlacedSolid& part : parts) {
      visit_solid(part.def, [&](double x, double y, double z, double weight) {
        std::array<double, 3> p{};
        for (int i = 0; i < 3; ++i) {
          p[static_cast<std::size_t>(i)] =
              part.p_BS[i] + part.R_BS(i, 0) * x + part.R_BS(i, 1) * y + part.R_BS(i, 2) * z;
        }
        use(p, weight * part.density, part.density < 0 ? -weight : weight);
      });
    }
  };
  for_each_point([&](std::array<double, 3> p, double mass, double volume) {
    out.volume += volume;
    out.mass += mass;
    for (std::size_t i = 0; i < 3; ++i) out.centre[i] += mass * p[i];
  });
  for (double& c : out.centre) c /= out.mass;
  for_each_point([&](std::array<double, 3> p, double mass, double) {
    for (std::size_t i = 0; i < 3; ++i) p[i] -= out.centre[i];
    const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) out.inertia[i][j] += mass * ((i == j ? square : 0) - p[i] * p[j]);
    }
  });
  return out;
}

void expect_same(const MassProperties& found, const Integral& right, double size, double rounding = kRounding) {
  EXPECT_NEAR(found.volume, right.volume, rounding * right.volume);
  EXPECT_NEAR(found.mass, right.mass, rounding * right.mass);
  const double trace = right.inertia[0][0] + right.inertia[1][1] + right.inertia[2][2];
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    EXPECT_NEAR(found.centre[i], right.centre[row], rounding * size) << i;
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(found.inertia(i, j), right.inertia[row][static_cast<std::size_t>(j)], rounding * trace) << i << j;
    }
  }
}

constexpr std::array<SolidType, 7> kTypes = {SolidType::box,      SolidType::hollow_box, SolidType::sphere,
                                             SolidType::cylinder, SolidType::tube,       SolidType::cone,
                                             SolidType::capsule};

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  SolidDef solid(SolidType type) {
    SolidDef def;
    def.type = type;
    def.size = {between(0.01, 2), between(0.01, 2), between(0.01, 2)};
    def.radius = between(0.01, 1);
    def.top_radius = between(0, 1) < 0.2 ? 0 : between(0, 1);
    def.length = between(0.01, 3);
    def.diameter = between(0.02, 1);
    def.inner_diameter = def.diameter * between(0.1, 0.98);
    def.width = between(0.05, 1);
    def.height = between(0.05, 1);
    def.wall = def.width * between(0.02, 0.48);
    def.flange = def.height * between(0.02, 0.48);
    return def;
  }
  // a random axis and angle, by the quaternion's matrix written out
  Mat3 rotation() {
    double w = between(-1, 1), x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    w /= n, x /= n, y /= n, z /= n;
    return {Vec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
            Vec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
            Vec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
  }
  PlacedSolid placed(SolidType type, double reach) {
    PlacedSolid part;
    part.def = solid(type);
    part.p_BS = Vec3(between(-reach, reach), between(-reach, reach), between(-reach, reach));
    part.R_BS = rotation();
    part.density = between(500, 9000);
    return part;
  }

 private:
  std::mt19937 engine_;
};

// m (3 a^2 + 3 b^2 + L^2)/12 of a thick tube, m (a^2 + b^2)/2 about its axis; 3/10 m R^2 and 3/80 m (4 R^2 + h^2) of a
// cone, a quarter of its height above the base
TEST(ShapeProperties, AreThoseOfTheTextbook) {
  const auto expect = [](const SolidDef& def, double V, Vec3 centre, Vec3 moments) {
    const MassProperties found = shape_properties(def);
    EXPECT_NEAR(found.volume, V, 1e-14 * V);
    EXPECT_EQ(found.mass, found.volume);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(found.centre[i], centre[i], 1e-15);
      EXPECT_NEAR(found.inertia(i, i), moments[i], 2e-14 * moments[i]);
    }
  };
  expect({.type = SolidType::box, .size = {1, 2, 3}}, 6, {}, {6.5, 5, 2.5});
  expect({.type = SolidType::sphere, .radius = 0.5}, kPi / 6, {}, Vec3(1, 1, 1) * (kPi / 60));
  expect({.type = SolidType::cylinder, .radius = 2, .length = 3}, 12 * kPi, {},
         Vec3(12 * kPi * 21 / 12, 12 * kPi * 21 / 12, 24 * kPi));
  expect({.type = SolidType::tube, .length = 3, .diameter = 4, .inner_diameter = 2}, 9 * kPi, {},
         Vec3(9 * kPi * 24 / 12, 9 * kPi * 24 / 12, 9 * kPi * 5 / 2));
  expect({.type = SolidType::cone, .radius = 1, .length = 2}, 2 * kPi / 3, {0, 0, -0.5},
         Vec3(2 * kPi / 3 * 0.3, 2 * kPi / 3 * 0.3, 2 * kPi / 3 * 0.3));
  // 2 m x 0.4 m x 0.3 m outside with walls of 0.02 m and flanges of 0.01 m: outside less inside
  const double out = 2 * 0.4 * 0.3, in = 2 * 0.36 * 0.28;
  expect({.type = SolidType::hollow_box, .length = 2, .width = 0.4, .height = 0.3, .wall = 0.02, .flange = 0.01},
         out - in, {},
         Vec3((out * (0.16 + 0.09) - in * (0.36 * 0.36 + 0.28 * 0.28)) / 12,
              (out * (4 + 0.09) - in * (4 + 0.28 * 0.28)) / 12, (out * (4 + 0.16) - in * (4 + 0.36 * 0.36)) / 12));
}

TEST(ShapeProperties, OfRandomShapesInRandomPosesAreTheirIntegrals) {
  for_each_seed(seeds({{1, 200}}, 24), [](std::uint32_t seed) {
    Random random(seed);
    for (const SolidType type : kTypes) {
      SCOPED_TRACE(static_cast<int>(type));
      const std::vector<PlacedSolid> part = {random.placed(type, 5)};
      expect_same(sum_of(part), integral_of(part), 10);
    }
  });
}

TEST(ShapeProperties, OfRandomCompositesWithHolesAreTheirIntegrals) {
  for_each_seed(seeds({{1, 200}}, 24), [](std::uint32_t seed) {
    Random random(seed);
    std::vector<PlacedSolid> parts;
    const int count = 2 + static_cast<int>(seed % 9);
    for (int i = 0; i < count; ++i) {
      parts.push_back(random.placed(kTypes[(seed + static_cast<std::uint32_t>(3 * i)) % 7], 3));
      // a smaller hole in the same place
      if (i % 2 == 1) continue;
      PlacedSolid hole = parts.back();
      hole.def.type = SolidType::sphere;
      hole.def.radius = 1e-2;
      hole.density = -hole.density;
      parts.push_back(hole);
    }
    expect_same(sum_of(parts), integral_of(parts), 10);
  });
}

// the tensor of a sum is that of a body: a tube is its outer cylinder less a hole
TEST(ShapeProperties, ATubeIsACylinderWithAHole) {
  const PlacedSolid tube = {.def = {.type = SolidType::tube, .length = 2, .diameter = 0.6, .inner_diameter = 0.5},
                            .p_BS = {}};
  const std::vector<PlacedSolid> drilled = {
      {.def = {.type = SolidType::cylinder, .radius = 0.3, .length = 2}, .p_BS = {}},
      {.def = {.type = SolidType::cylinder, .radius = 0.25, .length = 2}, .p_BS = {}, .density = -1}};
  const MassProperties a = sum_of(std::vector{tube}), b = sum_of(drilled);
  EXPECT_NEAR(a.mass, b.mass, 1e-14);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.inertia(i, i), b.inertia(i, i), 1e-14);
  EXPECT_EQ(share_without_material(drilled, 1), 0);
}

// by quadrature points, which all lie in the solid; points beyond its extent and in its hollow do not
TEST(ShapeProperties, PointsAreInsideWhereTheSolidIs) {
  for_each_seed(seeds({{1, 200}}, 24), [](std::uint32_t seed) {
    Random random(seed);
    for (const SolidType type : kTypes) {
      SCOPED_TRACE(static_cast<int>(type));
      const SolidDef def = random.solid(type);
      visit_solid(def, [&](double x, double y, double z, double) { EXPECT_TRUE(is_inside(def, {x, y, z}, 1e-12)); });
      const Vec3 half = half_extent(def);
      EXPECT_FALSE(is_inside(def, Vec3(half.x() + 1e-6, 0, 0), 0));
      EXPECT_FALSE(is_inside(def, Vec3(0, half.y() + 1e-6, 0), 0));
      EXPECT_FALSE(is_inside(def, Vec3(0, 0, half.z() + 1e-6), 0));
      const bool is_hollow = type == SolidType::tube || type == SolidType::hollow_box;
      EXPECT_EQ(is_inside(def, {}, 0), !is_hollow);
      // share of the box around it: its volume
      int inside = 0;
      constexpr int kPoints = 20000;
      for (int i = 0; i < kPoints; ++i) {
        inside += is_inside(def,
                            Vec3(random.between(-half.x(), half.x()), random.between(-half.y(), half.y()),
                                 random.between(-half.z(), half.z())),
                            0)
                      ? 1
                      : 0;
      }
      const double share = shape_properties(def).volume / (8 * half.x() * half.y() * half.z());
      // five standard deviations
      EXPECT_NEAR(static_cast<double>(inside) / kPoints, share, 5 * std::sqrt(0.25 / kPoints));
    }
  });
}

TEST(ShapeProperties, AHoleOutsideOfTheMaterialHasItsShare) {
  const auto hole_at = [](double x, double density) {
    const std::vector<PlacedSolid> parts = {
        {.def = {.type = SolidType::box, .size = {2, 2, 2}}, .p_BS = {}, .density = 1000},
        {.def = {.type = SolidType::box, .size = {1, 1, 1}}, .p_BS = {x, 0, 0}, .density = density}};
    return share_without_material(parts, 1);
  };
  EXPECT_EQ(hole_at(0, -1000), 0);
  EXPECT_EQ(hole_at(0.5, -1000), 0);  // their faces coincide
  EXPECT_NEAR(hole_at(0.75, -1000), 0.25, 0.01);
  EXPECT_EQ(hole_at(3, -1000), 1);
  EXPECT_EQ(hole_at(0, -1001), 1);  // more than the part has
  // two holes that meet in an eighth
  const std::vector<PlacedSolid> twice = {
      {.def = {.type = SolidType::box, .size = {4, 4, 4}}, .p_BS = {}},
      {.def = {.type = SolidType::box, .size = {1, 1, 1}}, .p_BS = {}, .density = -1},
      {.def = {.type = SolidType::box, .size = {1, 1, 1}}, .p_BS = {0.5, 0.5, 0.5}, .density = -1}};
  EXPECT_NEAR(share_without_material(twice, 1), 0.125, 0.01);
  EXPECT_NEAR(share_without_material(twice, 2), 0.125, 0.01);
}

TEST(ShapeProperties, PartsThatOverlapCountTwiceByTheirShare) {
  const auto box_at = [](double x) {
    return PlacedSolid{.def = {.type = SolidType::box, .size = {1, 1, 1}}, .p_BS = {x, 0, 0}, .density = 1000};
  };
  const std::vector<PlacedSolid> touching = {box_at(0), box_at(1)}, shifted = {box_at(0), box_at(0.75)};
  EXPECT_EQ(share_counted_twice(touching, 1), 0);
  EXPECT_EQ(share_counted_twice(shifted, 0), 0);  // of the later one alone
  EXPECT_NEAR(share_counted_twice(shifted, 1), 0.25, 0.01);
  // a pin in its bore, and a pin in a solid plate
  const PlacedSolid pin = {
      .def = {.type = SolidType::cylinder, .radius = 0.2, .length = 1}, .p_BS = {}, .density = 7850};
  PlacedSolid bore = pin;
  bore.density = -1000;
  EXPECT_EQ(share_counted_twice(std::vector{box_at(0), bore, pin}, 2), 0);
  EXPECT_EQ(share_counted_twice(std::vector{box_at(0), pin}, 1), 1);
}

TEST(ShapeProperties, WithoutMassHaveNoCentre) {
  const std::vector<PlacedSolid> parts = {
      {.def = {.type = SolidType::sphere, .radius = 1}, .p_BS = {1, 0, 0}},
      {.def = {.type = SolidType::sphere, .radius = 1}, .p_BS = {1, 0, 0}, .density = -1}};
  const MassProperties sum = sum_of(parts);
  EXPECT_EQ(sum.mass, 0);
  EXPECT_EQ(norm(sum.centre), 0);
}

}  // namespace shape_properties_test
}  // namespace slew::contact
