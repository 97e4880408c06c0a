// SPDX-License-Identifier: Apache-2.0
// Contacts are found again by place.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "contact/contact_memory.h"
#include "core/allocation_guard.h"
#include "math/rotation.h"
#include "support/contact_shapes.h"

namespace slew::contact {
namespace memory_test {

using math::Vec3;
using namespace testing;

class Remembered : public ::testing::Test {
 protected:
  void look(Vec3 p, const math::Mat3& R = math::Mat3::identity()) {
    const std::array<Pose, 2> poses = {Pose{}, Pose{p, R}};
    find_contacts(model, poses, set);
    memory.advance(model, poses, set);
  }
  // marks each contact by the quadrant of the box's corner
  static double mark(const ContactPoint& point, Vec3 middle) {
    return (point.p_W.x() > middle.x() ? 1 : 0) + (point.p_W.y() > middle.y() ? 2 : 0) + 1;
  }
  ContactModel model = build(two_shapes(box(1, 1, 1), plane()));
  ContactSet set{model};
  ContactMemory memory{model};
};

TEST_F(Remembered, StatesStayWithTheirCornersWhenOthersLeave) {
  look({0, 0, 0.499});
  ASSERT_EQ(memory.states().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(memory.states()[i].normal.impact_speed, 0);
    memory.states()[i].normal.impact_speed = mark(set.points()[i], {});
  }
  // slid by 3 m in a step, tipped onto the edge at +x
  look({3, 0, 0.5}, math::rotation_y(0.01));
  ASSERT_EQ(memory.states().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(memory.states()[i].normal.impact_speed, mark(set.points()[i], {3, 0, 0}));
  }
  // those that come back start afresh
  look({3, 0, 0.499});
  ASSERT_EQ(memory.states().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const double expected = set.points()[i].p_W.x() > 3 ? mark(set.points()[i], {3, 0, 0}) : 0;
    EXPECT_EQ(memory.states()[i].normal.impact_speed, expected);
  }
  look({3, 0, 2});
  EXPECT_TRUE(memory.states().empty());
}

TEST_F(Remembered, BristlesTurnHalfWithTheBody) {
  look({0, 0, 0.499});
  for (RememberedContact& state : memory.states()) state.friction.z_W = Vec3(1e-3, 0, 0);
  const double turn = 1e-3;
  look({0, 0, 0.499}, math::rotation_z(turn));
  ASSERT_EQ(memory.states().size(), 4u);
  for (const RememberedContact& state : memory.states()) {
    EXPECT_LT(norm(state.friction.z_W - Vec3(std::cos(turn / 2), std::sin(turn / 2), 0) * 1e-3), 1e-12);
  }
}

TEST_F(Remembered, FollowingDoesNotAllocate) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  look({0, 0, 0.499});
  const AllocationGuard guard;
  look({0, 0, 0.498}, math::rotation_y(1e-4));
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_EQ(set.points().size(), 4u);
}

}  // namespace memory_test
}  // namespace slew::contact
