// SPDX-License-Identifier: Apache-2.0
// The memory of separated pairs saves searches and does not change the contacts found.
#include <gtest/gtest.h>

#include "support/random_shapes.h"

namespace slew::contact {
namespace clearance_test {

using math::Mat3;
using math::Vec3;
using namespace testing;
using enum ShapeType;

class Clearance : public RandomShapes {
 protected:
  Clearance() : RandomShapes(7) {}

  Pose moved(const Pose& pose, double size) {
    const Mat3 turn = rotation(size);
    return {pose.p_WF + place(size), turn * pose.R_WF};
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

}  // namespace clearance_test
}  // namespace slew::contact
