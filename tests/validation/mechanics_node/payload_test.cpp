// SPDX-License-Identifier: Apache-2.0
// Which body a machine lifts: the one at the end of its longest chain, in whatever order the file has its bodies, or
// the one that the scene names.
#include "mechanics_node/payload.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "build_paths.h"
#include "multibody/model/model.h"
#include "scene/scene.h"

namespace slew::testing {
namespace payload_test {

std::string payload_of(const multibody::MechanicsDef& mechanics) {
  const multibody::Model model = multibody::build_model(mechanics);
  const int payload = mechanics_node::payload_of(mechanics, model);
  return payload == 0 ? "" : model.bodies[static_cast<std::size_t>(payload)].name;
}

scene::Scene loaded(const std::string& scene, const scene::Overrides& overrides = {}) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + scene, overrides);
}

TEST(Payload, IsTheSameInWhateverOrderTheBodiesStand) {
  for (const char* name : {"truck_crane.yaml", "two_dof_crane.yaml", "tipper.yaml"}) {
    multibody::MechanicsDef mechanics = loaded(name).mechanics;
    const std::string expected = payload_of(mechanics);
    ASSERT_FALSE(expected.empty()) << name;
    for (std::size_t k = 0; k < mechanics.bodies.size(); ++k) {
      std::rotate(mechanics.bodies.begin(), mechanics.bodies.begin() + 1, mechanics.bodies.end());
      EXPECT_EQ(payload_of(mechanics), expected) << name << ", rotated by " << k + 1;
    }
    std::reverse(mechanics.bodies.begin(), mechanics.bodies.end());
    EXPECT_EQ(payload_of(mechanics), expected) << name;
  }
}

// pieces of a segmented body stand among the model's bodies
TEST(Payload, HangsOnASegmentedBoomAsOnARigidOne) {
  EXPECT_EQ(payload_of(loaded("truck_crane_segmented.yaml").mechanics), "Bag");
}

TEST(Payload, IsTheBodyThatTheSceneNames) {
  EXPECT_EQ(payload_of(loaded("truck_crane.yaml", {"mechanics.payload=Truck_Hook"}).mechanics), "Truck_Hook");
}

TEST(Payload, ThatCannotBeOneIsRefused) {
  const auto expect_refusal = [](const char* scene, const std::string& name, const std::string& part) {
    try {
      static_cast<void>(loaded(scene, {"mechanics.payload=" + name}));
      ADD_FAILURE() << name;
    } catch (const scene::LoadError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  expect_refusal("truck_crane.yaml", "Bagg", "Bagg");
  expect_refusal("truck_crane.yaml", "Ground", "mechanics.payload");
}

}  // namespace payload_test
}  // namespace slew::testing
