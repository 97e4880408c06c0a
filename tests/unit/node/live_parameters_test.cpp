// SPDX-License-Identifier: Apache-2.0
// A live parameter that the directory accepts is one that a subsystem takes: nothing is accepted and then ignored.
#include <gtest/gtest.h>

#include <filesystem>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/parameters.h"
#include "scene/scene.h"

namespace slew::testing {
namespace live_parameters_test {

void expect_all_taken(const scene::Scene& scene, const std::string& of) {
  std::vector<std::unique_ptr<coupling::Subsystem>> subsystems;
  if (scene.has_mechanics()) subsystems.push_back(mechanics_node::make_mechanics_subsystem(scene));
  if (scene.has_hydraulics()) subsystems.push_back(hydraulics_node::make_hydraulics_subsystem(scene));
  const scene::ParameterDirectory directory(scene);
  int live = 0;
  for (const scene::ParameterInfo& parameter : directory.all()) {
    if (!directory.check(parameter.path, parameter.value).status.is_ok()) continue;
    ++live;
    int takers = 0;
    for (const auto& subsystem : subsystems) {
      takers += subsystem->change_parameter(0, {parameter.path, parameter.value, milliseconds(100)}) ? 1 : 0;
    }
    // a level of the coupling is both sides'
    const bool is_level = parameter.path.ends_with(".coupling");
    EXPECT_EQ(takers, is_level ? 2 : 1) << parameter.path << " of " << of;
  }
  EXPECT_GT(live, 0) << of;
}

TEST(LiveParameters, OfEverySceneAreAllTakenAtOnceByOneNodeEach) {
  int scenes = 0;
  for (const auto& file : std::filesystem::directory_iterator(SLEWRING_SOURCE_DIR "/scenes")) {
    if (file.path().extension() != ".yaml") continue;
    expect_all_taken(scene::load_file(file.path().string()), file.path().filename().string());
    ++scenes;
  }
  EXPECT_GT(scenes, 3);
}

TEST(LiveParameters, OfJointsWithAndWithoutFrictionAndLimitsAreTakenOrRefused) {
  expect_all_taken(scene::load_text("bodies:\n"
                                    "  Cart: {mass: 2 kg, inertia: [1, 1, 1]}\n"
                                    "  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\n"
                                    "  Bob: {mass: 2 kg, inertia: [1, 1, 1]}\n"
                                    "joints:\n"
                                    "  Rail: {type: prismatic, body2: Cart, coulomb_friction: 5 N}\n"
                                    "  Hinge: {type: revolute, body1: Cart, body2: Rod}\n"
                                    "  Ball: {type: spherical, body1: Rod, body2: Bob}\n",
                                    "joints"),
                   "joints");
}

}  // namespace live_parameters_test
}  // namespace slew::testing
