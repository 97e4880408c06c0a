// SPDX-License-Identifier: Apache-2.0
// The alarm of the coupling: it ends what diverges and nothing else. Errors and the alarm's measure over all machines,
// levels, steps and moving valves: docs/coupling-alarm.md.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace alarm_test {

const std::string kScenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";
const std::string kExcavator = std::string(SLEWRING_SOURCE_DIR) + "/tests/validation/coupling/mini_excavator.yaml";
const scene::Overrides kSmooth = {"Cyl_Boom.cylinder_coefficient=1", "Cyl_Stick.cylinder_coefficient=1",
                                  "Cyl_Bucket.cylinder_coefficient=1"};

struct Ended {
  bool has_failed = false, is_flagged = false;
  std::string text;
};

// By the scene's script, or all valves at full stick to and fro `hertz` times a second.
Ended run(const scene::Scene& scene, double duration, double hertz, Ages ages) {
  CoupledRun run(scene, std::move(ages));
  const Status status = run.start();
  EXPECT_TRUE(status.is_ok()) << status.text;
  Operator op(scene, kControlGrid);
  std::vector<double> controls(scene.inputs.size());
  while (run.time().seconds() < duration - 1e-9 && !run.has_failed()) {
    const std::span<const double> script = op.controls(run.time());
    for (std::size_t i = 0; i < controls.size(); ++i) {
      const double sine = std::sin(2 * std::numbers::pi * hertz * run.time().seconds());
      controls[i] = hertz > 0 ? scene.inputs[i].scale * sine : script[i];
    }
    run.step(controls);
  }
  return {run.has_failed(), (run.flags() & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy)) != 0,
          std::string(run.hydraulics().failure_text())};
}

scene::Scene load(const std::string& file, double H, Level level, const scene::Overrides& overrides = {}) {
  scene::Scene scene = scene::load_file(file, overrides);
  scene.session.step = H;
  scene.session.coupling = level;
  return scene;
}

TEST(CouplingAlarm, IsSilentOnASpoolThatJumps) {
  for (const Level level : {Level::two, Level::linear}) {
    for (const double H : {1e-3, 2e-3, 5e-3, 10e-3}) {
      const scene::Scene scene = load(kScenes + "two_dof_crane.yaml", H, level);
      const Ended ended = run(scene, 10, 0, {});
      EXPECT_FALSE(ended.has_failed) << H << ended.text;
      EXPECT_FALSE(ended.is_flagged) << H;
    }
  }
}

TEST(CouplingAlarm, IsSilentOnTheLightPortOfAnExcavator) {
  for (const double H : {1e-3, 2e-3, 5e-3, 10e-3}) {
    const scene::Scene scene = load(kExcavator, H, Level::two);
    const Ended ended = run(scene, 8, 0, {});
    EXPECT_FALSE(ended.has_failed) << H << ended.text;
    EXPECT_FALSE(ended.is_flagged) << H;
  }
}

TEST(CouplingAlarm, IsSilentOnValvesThatAlwaysMove) {
  for (const double H : {1e-3, 2e-3, 5e-3}) {
    const scene::Scene scene = load(kExcavator, H, Level::two);
    const Ended ended = run(scene, 6, 0.8, {});
    EXPECT_FALSE(ended.has_failed) << H << ended.text;
  }
}

// a damper of a double rod, without force at rest, that a load or a prescribed motion begins to move: what it has
// worked is nothing beside the first residuals
scene::Scene damper(const std::string& step, Level level, bool is_driven) {
  scene::Scene scene = scene::load_text("session: {step: " + step + "}\n" +
                                            (is_driven ? R"(
motions: {D: {type: translation_harmonic, joint: J, amplitude: 0.1 m, frequency: 3 Hz}}
hydraulics: {entrained_air: 0, start: table13}
)"
                                                       : R"(
hydraulics: {entrained_air: 0}
)") + R"(
bodies: {M: {position: [1.5, 0, 0], mass: 500, inertia: [1, 1, 1]}}
joints:
  J: {type: prismatic, body1: Ground, orientation1: [0, 90 deg, 0], body2: M, orientation2: [0, 90 deg, 0]}
forces:
  L: {type: translational, body1: Ground, body2: M}
  E: {type: point_force, body: M, direction: [1, 0, 0], force_table: [[0, 0], [0.2, 0], [0.21, 10 kN], [1, 10 kN]]}
volumes:
  A: {rigid_volume: 0.05 l, initial_pressure: 50 bar}
  B: {rigid_volume: 0.05 l, initial_pressure: 50 bar}
components:
  Cyl: {type: double_rod_cylinder, force: L, port_a: A, port_b: B, piston_diameter: 50 mm, rod_diameter: 30 mm,
        piston_length: 30 mm, chamber_length: 1 m, rod_length: 1 m, minimum_stroke: 0.02 m, maximum_stroke: 0.95 m,
        cylinder_coefficient: 1, seal_friction: 200}
  O: {type: orifice, port_1: A, port_2: B, diameter: 8 mm}
)",
                                        "damper");
  scene.session.coupling = level;
  return scene;
}

TEST(CouplingAlarm, IsSilentOnAPortWithoutForceThatOthersBeginToMove) {
  for (const Level level : {Level::two, Level::linear}) {
    for (const char* const step : {"1 ms", "2 ms", "5 ms"}) {
      for (const bool is_driven : {false, true}) {
        const Ended ended = run(damper(step, level, is_driven), 0.5, 0, {});
        EXPECT_FALSE(ended.has_failed) << step << ' ' << is_driven << ended.text;
        EXPECT_FALSE(ended.is_flagged) << step << ' ' << is_driven;
      }
    }
  }
}

// pressed onto the end stop by 8 kN and released at 40 kN/s: while the stop gives way, the oil carries 0.3 N
TEST(CouplingAlarm, IsSilentOnAPistonThatSlowlyLeavesItsEndStop) {
  for (const char* const step : {"1 ms", "2 ms", "5 ms"}) {
    const scene::Scene scene = scene::load_text("session: {step: " + std::string(step) + "}\n" + R"(
mechanics: {gravity: [0, 0, 0]}
hydraulics: {start: table13}
bodies: {Load: {mass: 200 kg, position: [1, 0, 0], inertia: [10, 10, 10]}}
joints:
  Rail: {type: prismatic, body2: Load, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0]}
forces:
  F: {type: translational, body1: Ground, point1: [-1 m, 0, 0], body2: Load}
  X: {type: point_force, body: Load, direction: [1, 0, 0], axes: ground,
      force_table: [[0, 0], [0.2, 8 kN], [1.8, 8 kN], [2.2, -8 kN], [3.8, -8 kN], [4.2, 8 kN]]}
volumes:
  A: {rigid_volume: 0.2 l, initial_pressure: 60 bar}
  B: {rigid_volume: 0.2 l, initial_pressure: 60 bar}
components:
  Cyl: {type: double_rod_cylinder, force: F, port_a: A, port_b: B, piston_diameter: 63 mm, rod_diameter: 36 mm,
        piston_length: 40 mm, chamber_length: 900 mm, rod_length: 1500 mm, minimum_stroke: 100 mm,
        maximum_stroke: 800 mm, viscous_friction: 300, dead_volume: 0.05 l}
  O: {type: orifice, port_1: A, port_2: B, diameter: 6 mm}
)",
                                                "stop");
    const Ended ended = run(scene, 5, 0, {});
    EXPECT_FALSE(ended.has_failed) << step << ended.text;
  }
}

TEST(CouplingAlarm, EndsLevelLinearBeyondItsLimitAndNamesLevelTwo) {
  const scene::Scene scene = load(kExcavator, 10e-3, Level::linear, kSmooth);
  const Ended ended = run(scene, 8, 0, {});
  EXPECT_TRUE(ended.has_failed);
  EXPECT_NE(ended.text.find("the coupling diverges"), std::string::npos) << ended.text;
  EXPECT_NE(ended.text.find("coupling: two"), std::string::npos) << ended.text;
}

TEST(CouplingAlarm, EndsLevelLinearDrivenByItsValve) {
  const scene::Scene scene = load(kScenes + "single_cylinder.yaml", 20e-3, Level::linear);
  EXPECT_NE(run(scene, 6, 3, {}).text.find("the coupling diverges"), std::string::npos);
}

TEST(CouplingAlarm, EndsSamplesThatComeTooLateAndNamesNothingThatIsChosen) {
  scene::Scene scene = load(kScenes + "single_cylinder.yaml", 4e-3, Level::two);
  scene.session.mode = scene::ExchangeMode::free_running;
  const Ended ended = run(scene, 6, 0, delayed(7));
  EXPECT_TRUE(ended.has_failed);
  EXPECT_NE(ended.text.find("session.mode: lockstep"), std::string::npos) << ended.text;
  EXPECT_EQ(ended.text.find("coupling: two"), std::string::npos) << ended.text;
}

}  // namespace alarm_test
}  // namespace slew::coupling::test
