// SPDX-License-Identifier: Apache-2.0
// Distances, nearest points and closing speeds against closed forms and an independent search over triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "math/rotation.h"
#include "sensor_bench.h"

namespace slew::sensors::testing {
namespace distance_test {

using contact::ShapeType;
using contact::testing::box;
using contact::testing::box_mesh;
using contact::testing::plane;
using contact::testing::rounded;
using contact::testing::sphere;
using math::Mat3;

constexpr double kSearch = 1e-9;    // m
constexpr double kCylinder = 1e-8;  // m

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Mat3 rotation() { return rotation_of(math::turn_by(vector(3))); }
  FrameMotion motion(double size) { return {vector(size), rotation(), vector(2), vector(2)}; }

 private:
  std::mt19937 engine_;
};

double distance_of(const SensorsDef& def, const FrameMotion& a, const FrameMotion& b = {}) {
  Sensors sensors(def);
  EXPECT_TRUE(sensors.observe(at(a, b)));
  return value(sensors, "S.distance");
}

// distance of two segments p + s d, s in 0..1 (Ericson 2005, 5.1.9)
double segment_distance(Vec3 p1, Vec3 d1, Vec3 p2, Vec3 d2) {
  const Vec3 r = p1 - p2;
  const double a = dot(d1, d1), e = dot(d2, d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2);
  const double denominator = a * e - b * b;
  double s = denominator > 1e-14 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((b * t - c) / a, 0.0, 1.0);
  }
  return norm(p1 + d1 * s - p2 - d2 * t);
}

// distance of a point and a triangle: projection inside, else the edges
double triangle_distance(Vec3 p, const std::array<Vec3, 3>& v) {
  const Vec3 n = cross(v[1] - v[0], v[2] - v[0]);
  bool is_inside = true;
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Vec3 from = v[k], edge = v[(k + 1) % 3] - from;
    is_inside = is_inside && dot(cross(edge, p - from), n) >= 0;
    const double s = std::clamp(dot(p - from, edge) / dot(edge, edge), 0.0, 1.0);
    least = std::min(least, norm(p - from - edge * s));
  }
  return is_inside ? std::fabs(dot(p - v[0], n)) / norm(n) : least;
}

std::vector<std::array<Vec3, 3>> triangles_of(const ShapeDef& shape, const FrameMotion& frame) {
  std::vector<std::array<Vec3, 3>> all;
  for (const auto& t : shape.mesh.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = frame.p_W + frame.R_W * Vec3(shape.mesh.vertices[t[k]]);
    all.push_back(corners);
  }
  return all;
}

// distance of two surfaces that do not intersect: vertices to triangles both ways, and edges to edges
double surface_distance(const std::vector<std::array<Vec3, 3>>& a, const std::vector<std::array<Vec3, 3>>& b) {
  double least = 1e300;
  for (const auto& x : a) {
    for (const auto& y : b) {
      for (int i = 0; i < 3; ++i) {
        least = std::min({least, triangle_distance(x[i], y), triangle_distance(y[i], x)});
        for (int k = 0; k < 3; ++k) {
          const Vec3 dx = x[(i + 1) % 3] - x[i], dy = y[(k + 1) % 3] - y[k];
          least = std::min(least, segment_distance(x[i], dx, y[k], dy));
        }
      }
    }
  }
  return least;
}

// A U of three blocks, open upwards: a concave surface.
ShapeDef channel() {
  ShapeDef shape;
  shape.type = ShapeType::triangle_mesh;
  for (const auto& [size, place] :
       {std::pair(Vec3(3, 2, 0.5), Vec3(0, 0, 0)), std::pair(Vec3(0.5, 2, 2), Vec3(-1.25, 0, 1.25)),
        std::pair(Vec3(0.5, 2, 2), Vec3(1.25, 0, 1.25))}) {
    contact::MeshDef block = box_mesh(size[0], size[1], size[2]).mesh;
    for (Triple& v : block.vertices) v = (Vec3(v) + place).array();
    contact::testing::append(shape.mesh, block);
  }
  return shape;
}

TEST(Distance, OfSpheresAndCapsulesIsThatOfTheirAxes) {
  Draw draw(1);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const FrameMotion a = draw.motion(1), b = {draw.vector(1) + Vec3(6, 0, 0), draw.rotation(), {}, {}};
    EXPECT_NEAR(distance_of(pair(sphere(0.4), sphere(0.7), clearance()), a, b), norm(a.p_W - b.p_W) - 1.1, kSearch);
    const Vec3 axis_a = a.R_W.c[2], axis_b = b.R_W.c[2];
    const double axes = segment_distance(a.p_W - axis_a, axis_a * 2, b.p_W - axis_b * 0.5, axis_b);
    const SensorsDef capsules =
        pair(rounded(ShapeType::capsule, 0.3, 2), rounded(ShapeType::capsule, 0.2, 1), clearance());
    EXPECT_NEAR(distance_of(capsules, a, b), axes - 0.5, kSearch);
  }
}

// the only curved surface
TEST(Distance, OfABallFromACylinderIsThatOfItsProfile) {
  Draw draw(9);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const FrameMotion a = draw.motion(1);
    const Vec3 centre = draw.vector(3);
    const double across = std::max(std::hypot(centre[0], centre[1]) - 0.7, 0.0);
    const double along = std::max(std::fabs(centre[2]) - 1, 0.0);
    const FrameMotion b{a.p_W + a.R_W * centre, draw.rotation(), {}, {}};
    const SensorsDef def = pair(rounded(ShapeType::cylinder, 0.7, 2), sphere(0.05), clearance());
    EXPECT_NEAR(distance_of(def, a, b), std::max(std::hypot(across, along) - 0.05, 0.0), kCylinder);
  }
}

TEST(Distance, OfBoxesIsThatOfTheirTriangles) {
  Draw draw(2);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const FrameMotion a = draw.motion(1), b = {draw.vector(1) + Vec3(5, 0, 0), draw.rotation(), {}, {}};
    const double expected = surface_distance(triangles_of(box_mesh(1, 2, 0.5), a), triangles_of(box_mesh(2, 1, 1), b));
    EXPECT_NEAR(distance_of(pair(box(1, 2, 0.5), box(2, 1, 1), clearance()), a, b), expected, kSearch);
    EXPECT_NEAR(distance_of(pair(box_mesh(1, 2, 0.5), box(2, 1, 1), clearance()), a, b), expected, kSearch);
  }
}

// Many corners are equally far in such places, where a search may end too early: turns by quarters, centres on a grid.
TEST(Distance, OfShapesAlongTheAxesIsThatOfTheirFaces) {
  Draw draw(11);
  const auto edges_of = [](const Mat3& R, Vec3 size) {
    Triple half{};
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) half[k] += 0.5 * std::fabs(R(k, j)) * size[j];
    }
    return half;
  };
  const auto quarters = [&] { return math::rotation_x(M_PI_2 * std::floor(draw.number(0, 4))); };
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const auto grid = [&] { return 0.5 * std::floor(draw.number(-6, 7)); };
    const FrameMotion a{{}, quarters(), {}, {}}, b{{grid(), grid(), grid()}, quarters(), {}, {}};
    const Triple half_a = edges_of(a.R_W, {0.2, 1, 1}), half_b = edges_of(b.R_W, {1, 2, 0.5});
    Triple gap{}, from_centre{};
    for (int k = 0; k < 3; ++k) {
      gap[k] = std::max(std::fabs(b.p_W[k]) - half_a[k] - half_b[k], 0.0);
      from_centre[k] = std::max(std::fabs(b.p_W[k]) - half_a[k], 0.0);
    }
    for (const ShapeDef& first : {box(0.2, 1, 1), box_mesh(0.2, 1, 1)}) {
      EXPECT_NEAR(distance_of(pair(first, box(1, 2, 0.5), clearance()), a, b), norm(Vec3(gap)), kSearch);
      EXPECT_NEAR(distance_of(pair(first, box_mesh(1, 2, 0.5), clearance()), a, b), norm(Vec3(gap)), kSearch);
      ShapeDef surface = box_mesh(1, 2, 0.5);
      surface.type = ShapeType::triangle_mesh;
      if (norm(Vec3(gap)) > 0) {
        EXPECT_NEAR(distance_of(pair(first, surface, clearance()), a, b), norm(Vec3(gap)), kSearch);
      }
      EXPECT_NEAR(distance_of(pair(first, sphere(0.1), clearance()), a, b),
                  std::max(norm(Vec3(from_centre)) - 0.1, 0.0), kSearch);
    }
  }
}

// places, found among some 50,000 each, where a search ends 14 mm and 47 mm too early
TEST(Distance, OfBoxesHoldsWhereASearchEndsTooEarly) {
  struct Place {
    Vec3 size;
    math::Quaternion a, b;
    Vec3 p_B;
  };
  const Place places[] = {
      {{4.170006376471302, 1.1218030106059735, 2.6425704547955102},
       {0.51967006069132826, 0.38605855922831944, -0.09869375281282089, 0.67769007605895371},
       {-0.24186840696147516, -0.8997931174641044, -0.54824890859441466, 0.92986919399803258},
       {-2.3625647223531248, 1.6934648851677034, -2.71290822748472}},
      {{3.8856237181550974, 1.5366003834653679, 17.906244704098551},
       {0.3803957347253708, -0.81145024607760097, 0.38445431309733191, -0.26290247648408194},
       {-0.17783220990414239, 0.4893030862669463, 0.15261818609929634, -0.64712774221189207},
       {7.1648973311693611, 7.1648973311693611, 7.1648973311693611}},
  };
  for (const auto& [size, q_a, q_b, p_B] : places) {
    const auto rotation = [](const math::Quaternion& q) {
      const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
      return math::rotation_of({q.w / length, q.x / length, q.y / length, q.z / length});
    };
    const FrameMotion a{{}, rotation(q_a), {}, {}}, b{p_B, rotation(q_b), {}, {}};
    const ShapeDef mesh = box_mesh(size[0], size[1], size[2]), solid = box(size[0], size[1], size[2]);
    const double expected = surface_distance(triangles_of(mesh, a), triangles_of(mesh, b));
    ASSERT_GT(expected, 0.1);
    EXPECT_NEAR(distance_of(pair(solid, solid, clearance()), a, b), expected, kSearch);
  }
}

// places, found among some 50,000, where a search between a box and a triangle ends 4 mm, 5 mm and 12 mm too early
TEST(Distance, OfBoxesFromSurfacesHoldsWhereASearchEndsTooEarly) {
  struct Place {
    Vec3 size_a, size_b;
    math::Quaternion a, b;
    Vec3 p_AB;
  };
  const Place places[] = {
      {{0.81108270236045577, 0.66063312826094123, 2.8823099411660547},
       {0.50693590064071925, 3.3407988976711356, 2.6950279141315172},
       {0.17088774841991833, 0.49066128146723115, 0.70260917873565232, -0.48619875181382111},
       {-0.39193386675270414, 0.24073372641334401, 0.57083448372116474, 0.68013462583095274},
       {2.1087092190246599 - 3.3467903844370994, 4.0695225501001673 - 2.9997836230485877,
        4.1658298168872427 - 3.1041257639375348}},
      {{0.2990682759368809, 0.67038127906476597, 0.39274956901301844},
       {1.0495401112688889, 0.52170526289090891, 1.2491803452219321},
       {0.72075087565666696, -0.66966910697044557, -0.1788186323377918, 0.0092390009414220417},
       {0.85936997153451367, 0.30472740240878304, 0.36883783434263673, 0.18050793390706826},
       {-0.20521350068617539 + 0.5304060428635774, 0.90685055634293965 - 0.69367519564810864,
        0.85066147916715251 + 0.089363075403382397}},
      {{0.1866217438154695, 1.3897791164598072, 1.1446951927789395},
       {1.2017015357112173, 0.42153848216841078, 0.9862593640293329},
       {-0.33405391641399251, 0.097074394341817472, -0.27620182452285574, 0.89593364431853328},
       {0.36075039997374658, 0.45195901182003179, 0.012291558898387962, 0.81574574355818108},
       {1.0472952555642956 - 1.6039262470077338, -1.5524105894687863 + 1.0152096198905922,
        0.87993349434758328 - 0.56924591451145912}},
  };
  for (const auto& [size_a, size_b, q_a, q_b, p_AB] : places) {
    const FrameMotion a{{}, math::rotation_of(q_a), {}, {}}, b{p_AB, math::rotation_of(q_b), {}, {}};
    const ShapeDef mesh = box_mesh(size_a[0], size_a[1], size_a[2]);
    ShapeDef surface = box_mesh(size_b[0], size_b[1], size_b[2]);
    surface.type = ShapeType::triangle_mesh;
    const double expected = surface_distance(triangles_of(mesh, a), triangles_of(surface, b));
    ASSERT_GT(expected, 0.1);
    for (const ShapeDef& first : {mesh, box(size_a[0], size_a[1], size_a[2])}) {
      EXPECT_NEAR(distance_of(pair(first, surface, clearance()), a, b), expected, kSearch);
      EXPECT_NEAR(distance_of(pair(surface, first, clearance()), b, a), expected, kSearch);
    }
  }
}

TEST(Distance, IsNotFoundBetweenPlacesThatAreNotFinite) {
  ShapeDef surface = box_mesh(1, 1, 1);
  surface.type = ShapeType::triangle_mesh;
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), 1e200}) {
    for (const ShapeDef& second : {box(1, 1, 1), sphere(1), surface}) {
      const SensorsDef def = pair(box(1, 2, 1), second, clearance());
      SensorsDef zone = def;
      zone.sensors = {{.name = "Z", .type = SensorType::zone, .zone = "a", .watch = {"B"}}};
      for (const SensorsDef& one : {def, zone}) {
        Sensors sensors(one);
        EXPECT_FALSE(sensors.observe(at({}, {{x, 0, 0}, Mat3::identity(), {}, {}})));
        EXPECT_EQ(sensors.failed(), 0U);
      }
    }
  }
}

TEST(Distance, FromAPlaneIsThatOfTheLowestPoint) {
  Draw draw(3);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    const FrameMotion a = {draw.vector(1) + Vec3(0, 0, 5), draw.rotation(), draw.vector(1), {}};
    double lowest = 1e300;
    for (const Triple& v : box_mesh(1, 2, 3).mesh.vertices) lowest = std::min(lowest, (a.p_W + a.R_W * Vec3(v))[2]);
    Sensors sensors(pair(box(1, 2, 3), plane(), clearance()));
    ASSERT_TRUE(sensors.observe(at(a)));
    EXPECT_NEAR(value(sensors, "S.distance"), lowest, 1e-12);
    EXPECT_NEAR(value(sensors, "S.closing_speed"), -a.v_W[2], 1e-12);
    const double tilt = std::acos(std::fabs(a.R_W(2, 2)));
    EXPECT_NEAR(distance_of(pair(rounded(ShapeType::cylinder, 0.5, 2), plane(), clearance()), a),
                a.p_W[2] - std::cos(tilt) - 0.5 * std::sin(tilt), 1e-12);
    EXPECT_NEAR(distance_of(pair(rounded(ShapeType::capsule, 0.5, 2), plane(), clearance()), a),
                a.p_W[2] - std::cos(tilt) - 0.5, 1e-12);
  }
}

TEST(Distance, OfConcaveMeshesIsThatOfTheirTriangles) {
  Draw draw(4);
  const ShapeDef shape = channel();
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    // the second one stands within the first, upside down and turned a little
    const FrameMotion a = draw.motion(0.2);
    const Mat3 turned = a.R_W * math::rotation_x(M_PI) * rotation_of(math::turn_by(draw.vector(0.1)));
    const FrameMotion b{a.p_W + a.R_W * (Vec3(1.25, 0, 2.8) + draw.vector(0.05)), turned, {}, {}};
    const double expected = surface_distance(triangles_of(shape, a), triangles_of(shape, b));
    ASSERT_GT(expected, 0.01);
    EXPECT_NEAR(distance_of(pair(shape, shape, clearance()), a, b), expected, 1e-9);
    // a ball in the channel, and a capsule along it
    const FrameMotion inside{a.p_W + a.R_W * (Vec3(0, 0, 1.3) + draw.vector(0.3)), a.R_W, {}, {}};
    double from_point = 1e300;
    for (const auto& t : triangles_of(shape, a)) from_point = std::min(from_point, triangle_distance(inside.p_W, t));
    EXPECT_NEAR(distance_of(pair(shape, sphere(0.1), clearance()), a, inside), from_point - 0.1, kSearch);
    EXPECT_NEAR(distance_of(pair(sphere(0.1), shape, clearance()), inside, a), from_point - 0.1, kSearch);
  }
}

// the points are on the shapes, and at the distance from each other
TEST(NearestPoints, AreTheDistanceApartAndOnTheirShapes) {
  Draw draw(5);
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const FrameMotion a = draw.motion(1), b = {draw.vector(1) + Vec3(6, 0, 0), draw.rotation(), {}, {}};
    for (const auto& [first, second] : {std::pair(sphere(0.5), box(1, 2, 1)), std::pair(box(1, 2, 1), sphere(0.5)),
                                        std::pair(sphere(0.5), channel()), std::pair(channel(), sphere(0.5))}) {
      Sensors sensors(pair(first, second, clearance()));
      ASSERT_TRUE(sensors.observe(at(a, b)));
      const Vec3 p_a = point(sensors, "S.point_of"), p_b = point(sensors, "S.point_to");
      EXPECT_NEAR(norm(p_a - p_b), value(sensors, "S.distance"), 1e-5);
      const bool ball_is_first = first.type == ShapeType::sphere;
      EXPECT_NEAR(norm((ball_is_first ? p_a - a.p_W : p_b - b.p_W)), 0.5, 1e-5);
    }
  }
}

TEST(ClosingSpeed, IsTheRateOfTheDistance) {
  Draw draw(6);
  const double h = 1e-3;
  const std::pair<ShapeDef, ShapeDef> pairs[] = {
      {sphere(0.4), rounded(ShapeType::capsule, 0.2, 1)}, {sphere(0.4), box(1, 2, 1)}, {channel(), sphere(0.3)}};
  for (const auto& [first, second] : pairs) {
    const SensorsDef def = pair(first, second, clearance());
    for (int i = 0; i < 20; ++i) {
      SCOPED_TRACE(i);
      FrameMotion a = draw.motion(0.5), b = draw.motion(0.5);
      b.p_W += Vec3(5, 0, 0);
      const auto moved = [&](const FrameMotion& m, double t) {
        return FrameMotion{m.p_W + m.v_W * t, rotation_of(math::turn_by(m.w_W * t)) * m.R_W, m.v_W, m.w_W};
      };
      Sensors sensors(def);
      ASSERT_TRUE(sensors.observe(at(a, b)));
      const double rate =
          (distance_of(def, moved(a, h), moved(b, h)) - distance_of(def, moved(a, -h), moved(b, -h))) / (2 * h);
      EXPECT_NEAR(value(sensors, "S.closing_speed"), -rate, 5e-3);
    }
  }
}

// many shapes in both groups: the broad phase finds what a search over all pairs finds
TEST(Distance, OfGroupsIsTheLeastOfAllPairs) {
  Draw draw(7);
  SensorsDef def;
  def.frames = {{"Ground", true}, {"A", false}, {"B", false}};
  for (int i = 0; i < 200; ++i) {
    ShapeDef shape = in_frame(sphere(0.1), ("s" + std::to_string(i)).c_str(), i % 2 == 0 ? "A" : "B");
    shape.position = draw.vector(4).array();
    def.shapes.push_back(shape);
  }
  def.sensors = {{.name = "S", .type = SensorType::clearance, .of = {"A"}, .to = {"B"}}};
  Sensors sensors(def);
  for (int i = 0; i < 10; ++i) {
    const FrameMotion a = draw.motion(1), b = {draw.vector(1) + Vec3(9, 0, 0), draw.rotation(), {}, {}};
    double least = 1e300;
    for (std::size_t j = 0; j < def.shapes.size(); j += 2) {
      for (std::size_t k = 1; k < def.shapes.size(); k += 2) {
        const Vec3 p = a.p_W + a.R_W * Vec3(def.shapes[j].position), q = b.p_W + b.R_W * Vec3(def.shapes[k].position);
        least = std::min(least, norm(p - q) - 0.2);
      }
    }
    ASSERT_TRUE(sensors.observe(at(a, b)));
    EXPECT_NEAR(value(sensors, "S.distance"), std::max(least, 0.0), kSearch);
  }
}

TEST(Distance, IsZeroWhileShapesOverlap) {
  Draw draw(8);
  const std::pair<ShapeDef, ShapeDef> pairs[] = {
      {sphere(0.4), box(1, 1, 1)}, {channel(), box(1, 1, 1)},
      {channel(), channel()},      {sphere(0.4), plane()},
      {channel(), plane()},        {box_mesh(1, 1, 1), rounded(ShapeType::cylinder, 0.4, 1)}};
  for (const auto& [first, second] : pairs) {
    for (int i = 0; i < 10; ++i) {
      Sensors sensors(pair(first, second, clearance()));
      FrameMotion a = draw.motion(0), b = draw.motion(0);
      a.p_W = Vec3(0.1, 0.05, 0.02);
      ASSERT_TRUE(sensors.observe(at(a, b)));
      EXPECT_EQ(value(sensors, "S.distance"), 0);
      EXPECT_EQ(value(sensors, "S.closing_speed"), 0);
    }
  }
}

}  // namespace distance_test
}  // namespace slew::sensors::testing
