// SPDX-License-Identifier: Apache-2.0
// A live parameter that the directory accepts is one that a subsystem takes: nothing is accepted and then ignored.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/parameters.h"
#include "scene/scene.h"
#include "support/crane_pair.h"
#include "support/mechanics_alone.h"

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

// Share of a change in step n of those from its begin on: the mean of the line over the step.
double share_of(int n, int over) {
  return n < 0 ? 0 : over == 0 ? 1 : std::min(1.0, (n + 0.5) / over);
}

// The step that a change is given for is the first one computed with it: m v = H (sum of the forces so far).
TEST(LiveParameters, OfMechanicsActInTheStepThatTheyAreGivenFor) {
  for (const int over : {0, 4}) {
    SCOPED_TRACE(over);
    MechanicsAlone m(
        scene::load_text("mechanics: {gravity: [0, 0, 0]}\n"
                         "bodies:\n  S: {mass: 2 kg, inertia: [2, 2, 2]}\n"
                         "joints:\n  R: {type: prismatic, body2: S}\n"
                         "forces:\n  D: {type: point_force, body: S, axes: ground, direction: [0, 0, 1]}\n"
                         "session: {step: 1 ms, duration: 1 s}\n",
                         "push"));
    double force_sum = 0;
    for (int n = 0; n < 12; ++n) {
      if (n == 5) ASSERT_TRUE(m.subsystem.change_parameter(n, {"D.force", 100, milliseconds(over)}));
      force_sum += 100 * share_of(n - 5, over);
      m.step();
      EXPECT_NEAR(m.value("R.velocity"), 1e-3 * force_sum / 2, 1e-14) << n;
    }
  }
}

TEST(LiveParameters, OfHydraulicsActInTheStepThatTheyAreGivenFor) {
  const scene::Scene scene = scene::load_text(
      "hydraulics: {start_return_pressure: 1 bar}\n"
      "volumes:\n"
      "  T: {initial_pressure: 1 bar, fixed: true}\n"
      "  V: {initial_pressure: 1 bar, fixed: true}\n"
      "components: {F: {type: flow_source, port_1: T, port_2: V}}\n"
      "session: {step: 1 ms, duration: 1 s}\n",
      "source");
  for (const int over : {0, 4}) {
    SCOPED_TRACE(over);
    hydraulics_node::HydraulicsSubsystem hydraulics(scene);
    coupling::OwnSample sample;
    ASSERT_TRUE(hydraulics.start({}, sample).is_ok());
    std::vector<double> values(hydraulics.variables().size());
    std::size_t flow = 0;
    while (flow < values.size() && hydraulics.variables()[flow].name != "F.flow") ++flow;
    ASSERT_LT(flow, values.size());
    for (int n = 0; n < 12; ++n) {
      if (n == 5) ASSERT_TRUE(hydraulics.change_parameter(n, {"F.flow", 1e-3, milliseconds(over)}));
      hydraulics.step(n, {}, {}, sample);
      hydraulics.read_variables(values);
      EXPECT_NEAR(values[flow], 1e-3 * share_of(n - 5, over), 1e-18) << n;
    }
  }
}

// A mass that a cylinder lifts straight up: one kilogram more takes g newtons more, in the step of a change of gravity.
TEST(LiveParameters, OfGravityActOnTheDemandOfThePayloadAsWell) {
  const scene::Scene scene = scene::load_text(R"(
mechanics: {gravity: [0, -10, 0]}
bodies: {M: {position: [0, 1.6 m, 0], mass: 400 kg, inertia: [1, 1, 1]}}
joints:
  R: {type: prismatic, body2: M, point1: [0, 1.6 m, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}
forces: {F: {type: translational, body1: Ground, body2: M}}
hydraulics: {start: table13}
volumes: {P: {initial_pressure: 10 bar, fixed: true}, T: {initial_pressure: 1 bar, fixed: true}}
components:
  C: {type: double_acting_cylinder, force: F, port_a: P, port_b: T, piston_diameter: 80 mm, rod_diameter: 40 mm,
      piston_length: 0, chamber_length: 1 m, rod_length: 1.1 m, minimum_stroke: 20 mm, maximum_stroke: 980 mm}
session: {step: 1 ms, duration: 1 s}
)",
                                              "lift");
  CranePair lift(scene);
  lift.start();
  const auto demand = [&lift] {
    const std::span<const ElementVariable> variables = lift.mechanics->variables();
    std::vector<double> values(variables.size());
    lift.mechanics->read_variables(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (variables[i].name == "C.static_force_per_kg") return values[i];
    }
    ADD_FAILURE() << "no such variable";
    return 0.0;
  };
  for (int n = 0; n < 10; ++n) {
    if (n == 5) ASSERT_TRUE(lift.mechanics->change_parameter(n, {"mechanics.gravity.y", -20, {}}));
    lift.step({});
    EXPECT_NEAR(demand(), n < 5 ? 10 : 20, 1e-9) << n;
  }
}

}  // namespace live_parameters_test
}  // namespace slew::testing
