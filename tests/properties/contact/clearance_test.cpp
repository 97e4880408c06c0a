// What a set remembers of pairs that were apart saves searches and changes nothing that is found.
#include <gtest/gtest.h>

#include <random>

#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace {

using math::Mat3;
using math::Vec3;
using namespace testing;
using enum ShapeType;

class Clearance : public ::testing::Test {
 protected:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  ShapeDef shape(ShapeType type) {
    switch (type) {
      case sphere:
        return testing::sphere(uniform(0.2, 1));
      case box:
        return testing::box(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
      case plane:
        return testing::plane();
      case height_field:
        return flat_field(4, 4, 0.5);
      case convex_mesh:
        return box_mesh(uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2));
      default:
        return rounded(type, uniform(0.1, 0.8), uniform(0.2, 2));
    }
  }
  Pose moved(const Pose& pose, double size) {
    const Mat3 turn = math::rotation_zxz({uniform(-size, size), uniform(-size, size), uniform(-size, size)});
    return {pose.p_WF + Vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size)), turn * pose.R_WF};
  }
  // a random walk in small and large steps, from apart to deep in each other and back
  void walk(ShapeType a, ShapeType b, bool b_moves) {
    ContactDef def = two_shapes(shape(a), shape(b));
    def.shapes[0].position = {uniform(-0.5, 0.5), uniform(-0.5, 0.5), 0};
    const ContactModel model = build(def);
    ContactSet kept(model);
    std::vector<Pose> poses = {Pose{}, Pose{{uniform(-2, 2), uniform(-2, 2), uniform(0, 3)}, Mat3::identity()}};
    for (int i = 0; i < 150; ++i) {
      const double size = i % 3 == 0 ? 0.2 : 0.01;
      poses[1] = moved(poses[1], size);
      if (b_moves) poses[0] = moved(poses[0], size);
      find_contacts(model, poses, kept);
      ContactSet fresh(model);
      find_contacts(model, poses, fresh);
      ASSERT_EQ(kept.points().size(), fresh.points().size());
      for (std::size_t k = 0; k < fresh.points().size(); ++k) {
        ASSERT_EQ(kept.points()[k].depth, fresh.points()[k].depth);
        ASSERT_EQ(kept.points()[k].p_W.array(), fresh.points()[k].p_W.array());
        ++touching_;
      }
      ++looks_;
    }
  }

  std::mt19937_64 random_{7};
  int touching_ = 0, looks_ = 0;
};

TEST_F(Clearance, LeavesNothingOut) {
  for (const ShapeType a : {sphere, box, capsule, cylinder, convex_mesh}) {
    for (const ShapeType b : {sphere, box, capsule, cylinder, plane, convex_mesh, height_field}) {
      for (int i = 0; i < 6; ++i) walk(a, b, b != plane && b != height_field);
    }
  }
  EXPECT_GT(touching_, looks_ / 10);
}

}  // namespace
}  // namespace slew::contact
