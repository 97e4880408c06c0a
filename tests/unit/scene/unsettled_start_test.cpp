// SPDX-License-Identifier: Apache-2.0
// A machine whose chassis falls while its actuators are held is named at load; machines that move for other reasons are
// not.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "build_paths.h"
#include "scene/scene.h"

namespace slew::scene {
namespace unsettled_start_test {

// a chassis on springs, a boom with one cylinder on it
std::string chassis(const std::string& free_length) {
  return R"(
bodies:
  Chassis: {mass: 3 t, inertia: [500, 500, 500]}
  Boom: {mass: 400 kg, center_of_mass: [2 m, 0, 0], inertia: [10, 500, 500]}
joints:
  Up: {type: prismatic, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0], body2: Chassis}
  Foot: {type: revolute, body1: Chassis, body2: Boom}
forces:
  Springs: {type: translational, body1: Ground, point1: [0, -1 m, 0], body2: Chassis, spring_constant: 2 kN/mm,
            free_length: )" +
         free_length + R"(}
  Line: {type: translational, body1: Chassis, point1: [0.3 m, -1 m, 0], body2: Boom, point2: [0.9 m, 0, 0]}
volumes:
  T: {fixed: true, initial_pressure: 1 bar}
  A: {rigid_volume: 0.2 l}
  B: {rigid_volume: 0.2 l}
components:
  C: {type: double_acting_cylinder, force: Line, port_a: A, port_b: B, piston_diameter: 80 mm, rod_diameter: 45 mm,
      piston_length: 40 mm, chamber_length: 800 mm, rod_length: 800 mm, minimum_stroke: 20 mm, maximum_stroke: 740 mm}
  Bl: {type: bleed, port_1: B, port_2: T, nominal_flow: 2 l/min, nominal_pressure_drop: 10 bar}
)";
}

std::string warning_of(const Scene& scene) {
  const auto found = std::find_if(scene.warnings.begin(), scene.warnings.end(), [](const std::string& warning) {
    return warning.find("falling machine") != std::string::npos;
  });
  return found == scene.warnings.end() ? "" : *found;
}

TEST(UnsettledStart, OfAChassisWithoutLoadOnItsSpringsIsNamed) {
  const std::string warning = warning_of(load_text(chassis("1 m"), "test"));
  EXPECT_NE(warning.find("hydraulics.start: every actuator is in equilibrium, but Chassis, which carries some, "
                         "accelerates with 9.81 m/s2 at the start"),
            std::string::npos)
      << warning;
  EXPECT_NE(warning.find("slewring run --from"), std::string::npos) << warning;
}

TEST(UnsettledStart, IsNoneOnSpringsThatCarryTheWeight) {
  // (3000 + 400) kg 9.81 m/s2 / 2 kN/mm
  EXPECT_EQ(warning_of(load_text(chassis("1.016677 m"), "test")), "");
  // nor where the circuit begins by its table, which claims no equilibrium
  EXPECT_EQ(warning_of(load_text(chassis("1 m") + "hydraulics: {start: table13}\n", "test")), "");
}

// a load that swings beyond the cylinder, and a load whose hinge is held by friction
TEST(UnsettledStart, IsNoneWhereALoadSwings) {
  std::string text = chassis("1.016677 m");
  text.insert(text.find("  Boom:"),
              "  Load: {position: [4 m, 0, 0], mass: 10 kg, center_of_mass: [0.5 m, 0, 0], inertia: [1, 1, 1]}\n");
  text.insert(text.find("  Foot:"), "  Hang: {type: revolute, body1: Boom, point1: [4 m, 0, 0], body2: Load}\n");
  EXPECT_EQ(warning_of(load_text(text, "test")), "");
}

// a hair above the ground, which carries within milliseconds
TEST(UnsettledStart, IsNoneAboveTheGround) {
  const std::string text = chassis("1 m") + R"(
shapes:
  Feet: {type: sphere, body: Chassis, radius: 0.5 m}
  Floor: {type: plane, position: [0, -0.5001 m, 0], orientation: [0, -90 deg, 0]}
contacts:
  Feet_Floor: {shape_a: Feet, shape_b: Floor, spring_constant: 1e8 N/m, restitution_coefficient: 0.5}
)";
  EXPECT_EQ(warning_of(load_text(text, "test")), "");
}

// machines a hair above the ground, swinging pendulums, cranes, diggers
TEST(UnsettledStart, IsNoneInTheScenesThatAreShipped) {
  int loaded = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SLEWRING_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    try {
      const Scene scene = load_file(entry.path().string());
      EXPECT_EQ(warning_of(scene), "") << entry.path();
      ++loaded;
    } catch (const LoadError&) {
      // a part that other scenes include
    }
  }
  EXPECT_GT(loaded, 30);
}

}  // namespace unsettled_start_test
}  // namespace slew::scene
