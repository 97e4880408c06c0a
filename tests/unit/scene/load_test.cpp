// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include "build_paths.h"
#include "scene/canonical.h"
#include "scene/scene.h"
#include "scene/sections.h"
#include "scene/source.h"
#include "scene/units.h"
#include "scene_text.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace load_test {

TEST(Load, TheCanonicalTextOfASceneReadsBackToTheSameText) {
  for (const char* file : {"first_steps", "truck_crane"}) {
    const Scene scene = load_file(std::string(SLEWRING_SOURCE_DIR "/scenes/") + file + ".yaml");
    const Scene again = load_text(scene.expanded_text, "again");
    EXPECT_EQ(again.expanded_text, scene.expanded_text);
    EXPECT_EQ(again.name, scene.name);
    EXPECT_EQ(again.ports.size(), scene.ports.size());
  }
}

// 25 mPa are 25 millipascal
TEST(Load, WarnsOfMilliWhereMegaIsLikely) {
  const TemporaryFolder folder;
  const Scene scene = load_file(folder.write(
      "scene.yaml",
      "volumes:\n  V: {rigid_volume: 1 l, initial_pressure: 0.2 MPa}\n  T: {fixed: true}\ncomponents:\n"
      "  R: {type: relief_valve, port_1: V, port_2: T, nominal_flow: 10 l/min, setting_pressure: 25 mPa}\n"));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("scene.yaml:5:91: R.setting_pressure: '25 mPa' is 0.025 Pa; expected M in the place "
                                   "of m, 'MPa', unless so little is meant"),
            std::string::npos)
      << scene.warnings[0];
}

TEST(Load, WarnsOfAScriptedChangeBehindTheEndOfTheRun) {
  const std::string script =
      "volumes:\n  V: {rigid_volume: 1 l, initial_pressure: 2 bar}\n  T: {fixed: true}\n"
      "components:\n  R: {type: relief_valve, port_1: V, port_2: T, nominal_flow: 10 l/min, setting_pressure: 25 MPa}\n"
      "script:\n  parameters:\n    - {at: 1 s, set: R.setting_pressure, value: 20 MPa}\n"
      "    - {at: 3 s, set: R.setting_pressure, value: 25 MPa}\n";
  const Scene scene = load_text(script + "session: {duration: 2 s}\n", "test");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("the change of R.setting_pressure at 3 s has no effect: the run ends at 2 s"),
            std::string::npos)
      << scene.warnings[0];
  EXPECT_TRUE(load_text(script + "session: {duration: 4 s}\n", "test").warnings.empty());
  EXPECT_TRUE(load_text(script, "test").warnings.empty());
}

TEST(Load, WarnsOfAContactWithinOneBody) {
  const auto warnings = [](const std::string& second) {
    return load_text(
               "bodies:\n  A: {mass: 1 kg, inertia: [1, 1, 1]}\n  B: {position: [3, 0, 0], mass: 1 kg, inertia: [1, 1, "
               "1]}\n"
               "joints:\n  F: {type: revolute, body2: A}\n  G: {type: revolute, point1: [3, 0, 0], body2: B}\n"
               "shapes:\n  S: {type: sphere, body: A, radius: 0.1}\n  T: {type: sphere, body: " +
                   second +
                   ", radius: 0.1}\n"
                   "contacts: {C: {shape_a: S, shape_b: T, spring_constant: 1e5}}\n",
               "test")
        .warnings;
  };
  ASSERT_EQ(warnings("A").size(), 1u);
  EXPECT_NE(warnings("A")[0].find("C: it has no effect: both shapes are of 'A'"), std::string::npos)
      << warnings("A")[0];
  EXPECT_TRUE(warnings("B").empty());
}

TEST(Load, WarnsOfAPointOfTheScriptBehindTheEndOfTheRun) {
  const auto warnings = [](const std::string& points) {
    return load_text(
               "bodies:\n  Rod: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n  Hinge: {type: revolute, body2: Rod}\n"
               "forces:\n  Push: {type: point_force, body: Rod, force: 1 N}\n"
               "inputs:\n  Stick: {type: analog, primitive: Push}\nsession: {duration: 2 s}\n"
               "script: {inputs: {Stick: " +
                   points + "}}\n",
               "test")
        .warnings;
  };
  const auto meant_ms = warnings("[[0, 0], [500, 1]]");
  ASSERT_EQ(meant_ms.size(), 1u);
  EXPECT_NE(meant_ms[0].find("script.inputs.Stick: the input does not reach its point at 500 s: the run ends at 2 s"),
            std::string::npos)
      << meant_ms[0];
  EXPECT_TRUE(warnings("[[0, 0], [2, 1]]").empty());
  EXPECT_TRUE(warnings("[[0, 0], [1, 1], [9, 1]]").empty());
}

TEST(Load, TextsSurviveTheRoundTrip) {
  const std::string title = "the \"hi\" \\ to\tit: # [x] \xC3\xA4, and 'so'";
  std::string scene = kPendulum + "plots:\n  Swing: {title: " + yaml_text(title) + ", variables: [Rod.position.x]}\n";
  const Scene once = load_text(scene, "test");
  EXPECT_EQ(once.plots.at(0).title, title);
  EXPECT_EQ(load_text(once.expanded_text, "test").plots.at(0).title, title);
}

// a resolved escape is checked like a character of the file
TEST(Load, AnEscapeThatStandsForAControlCharacterOrNoTextIsRefusedAtItsPlace) {
  const auto with_title = [](const std::string& title) {
    return kPendulum + "plots:\n  Swing: {title: \"a" + title + "b\", variables: [Rod.position.x]}\n";
  };
  for (const char* escape : {"\\0",   "\\a",   "\\b",   "\\e",     "\\f",     "\\v",         "\\x00",  "\\x01",
                             "\\x07", "\\x1b", "\\x7f", "\\u0000", "\\u001b", "\\U0000007f", "\\N",    "\\L",
                             "\\P",   "\\x80", "\\x9b", "\\u009f", "\\u2028", "\\ufffe",     "\\uffff"}) {
    const std::string problem = problems_of(with_title(escape));
    EXPECT_NE(problem.find("test:6:18: "), std::string::npos) << escape << ": " << problem;
    EXPECT_NE(problem.find("after its escapes are resolved; expected UTF-8 text"), std::string::npos) << escape;
  }
  EXPECT_NE(problems_of("scene: \"a\\0b\"\n" + kPendulum).find("NUL byte"), std::string::npos);
  for (const char* escape : {"\\t", "\\n", "\\r", "\\\\", "\\\"", "\\/", "\\ ", "\\_", "\\u00e4", "\\U0001F69C",
                             "\\x41", "\\xa0", "\\xc2", "\\u202e"}) {
    const std::string text = with_title(escape);
    ASSERT_EQ(problems_of(text), "") << escape;
    const Scene once = load_text(text, "test");
    EXPECT_EQ(load_text(once.expanded_text, "test").expanded_text, once.expanded_text) << escape;
  }
}

// expand(load(expand(x))) = expand(x): load_file() compares for every scene, and refuses differences
TEST(Load, EveryAcceptedSceneReadsBackFromItsExpansion) {
  int accepted = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SLEWRING_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    const Scene scene = load_file(entry.path().string());
    EXPECT_EQ(load_text(scene.expanded_text, scene.name).expanded_text, scene.expanded_text) << entry.path();
    ++accepted;
  }
  EXPECT_GE(accepted, 5);
}

// what `check --expanded` prints is a scene for a file, beside the files that it names
TEST(Load, AnExpansionIsAFileWithoutProblems) {
  const TemporaryFolder folder;
  for (const char* file : {"single_cylinder", "tipper", "two_dof_crane", "flow_sharing", "first_steps"}) {
    Scene scene = load_file(std::string(SLEWRING_SOURCE_DIR "/scenes/") + file + ".yaml");
    const Scene again = load_file(folder.write(std::string(file) + ".yaml", file_text(scene)));
    EXPECT_EQ(again.expanded_text, scene.expanded_text) << file;
  }
}

// a bound of the solver that the circuit's build would otherwise meet as an internal error
TEST(Load, ACircuitOfMoreUnknownsThanItsSolverTakesIsRefusedByName) {
  const auto chain = [](int volumes, const std::string& solver) {
    std::string text = "hydraulics: {solver: " + solver + "}\nvolumes:\n";
    for (int i = 0; i < volumes; ++i) text += fmt::format("  V{}: {{rigid_volume: 1 l}}\n", i);
    text += "components:\n";
    for (int i = 1; i < volumes; ++i) {
      text += fmt::format("  O{0}: {{type: orifice, port_1: V{1}, port_2: V{0}, diameter: 1 mm}}\n", i, i - 1);
    }
    return problems_of(text);
  };
  EXPECT_EQ(chain(200, "rodas3"), "");
  for (const auto& [volumes, solver] :
       {std::pair(201, "rodas3"), {500, "implicit_euler"}, {5000, "rodas3"}, {1001, "rk4"}}) {
    const std::string problem = chain(volumes, solver);
    EXPECT_NE(problem.find(fmt::format("the circuit has {} unknowns", volumes)), std::string::npos) << problem;
    EXPECT_NE(problem.find("with this hydraulics.solver"), std::string::npos) << problem;
  }
}

TEST(Load, WordsThatYamlTakesForSomethingElseAreQuoted) {
  for (const char* word : {"yes", "No", "true", "null", "~", "", "010", "1.5", "a: b", "-", "x y"}) {
    EXPECT_EQ(yaml_text(word).front(), '"') << word;
  }
  EXPECT_EQ(yaml_text("Truck_Pillar"), "Truck_Pillar");
}

TEST(Load, APendulumNeedsNoHydraulics) {
  const Scene scene = load_file(SLEWRING_SOURCE_DIR "/scenes/first_steps.yaml");
  EXPECT_TRUE(scene.has_mechanics());
  EXPECT_FALSE(scene.has_hydraulics());
  EXPECT_TRUE(scene.ports.empty());
  EXPECT_EQ(scene.name, "first_steps");
}

TEST(Load, AnOverrideReplacesTheValueBeforeTheSceneIsChecked) {
  const Scene scene = load_text(kPendulum, "test", {"Rod.mass=1500kg", "session.step=2 ms", "Rod.inertia=[1, 2, 2]"});
  EXPECT_EQ(scene.mechanics.bodies.at(0).mass, 1500);
  EXPECT_EQ(scene.session.step_duration(), milliseconds(2));
  EXPECT_EQ(scene.mechanics.bodies.at(0).inertia, (Triple{1, 2, 2}));
  EXPECT_EQ(load_text(scene.expanded_text, "test").mechanics.bodies.at(0).mass, 1500);
}

TEST(Load, TheLastOfTwoOverridesWins) {
  EXPECT_EQ(load_text(kPendulum, "test", {"Rod.mass=3", "Rod.mass=4"}).mechanics.bodies.at(0).mass, 4);
}

TEST(Load, IncludedFilesAreLaidUnderTheScene) {
  const TemporaryFolder folder;
  folder.write("base.yaml", kPendulum + "session: {step: 2 ms, duration: 5 s}\n");
  folder.write("free.yaml", "session: {pace: free, step: 4 ms}\n");
  const Scene scene = load_file(folder.write(
      "scene.yaml", "include: [base.yaml, free.yaml]\nbodies:\n  Rod: {mass: 7 kg}\nsession: {duration: 1 s}\n"));
  EXPECT_EQ(scene.mechanics.bodies.at(0).mass, 7);
  EXPECT_EQ(scene.mechanics.bodies.at(0).inertia, (Triple{0, 1, 1}));
  EXPECT_EQ(scene.session.step, 4e-3);
  EXPECT_EQ(scene.session.duration, 1);
  EXPECT_EQ(scene.session.pace, Pace::free);
}

TEST(Load, AProblemInAnIncludedFileIsReportedWhereItStands) {
  const TemporaryFolder folder;
  const std::string base = folder.write("base.yaml", "bodies:\n  Rod: {mass: 0, inertia: [0, 1, 1]}\n");
  const std::string scene =
      folder.write("scene.yaml", "include: base.yaml\njoints:\n  Hinge: {type: revolute, body2: Rod}\n");
  try {
    (void)load_file(scene);
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_EQ(std::string(error.what()), base + ":2:15: Rod.mass: '0' is out of range; expected more than 0 kg");
  }
}

constexpr const char* kWithTable = R"(
bodies: {Load: {position: [1 m, 0, 0], mass: 5 kg, inertia: [1, 1, 1]}}
joints: {Free: {type: floating, body2: Load}}
forces: {Line: {type: translational, body1: Ground, body2: Load, spring_table: line.csv}}
)";

TEST(Load, ATableMayBeAFileOfPointsWithUnits) {
  const TemporaryFolder folder;
  folder.write("line.csv", "# a comment\nway [mm], force [kN]\r\n-100, -1.2\n\n0, 0\n50, 0.25\n");
  const Scene scene = load_file(folder.write("scene.yaml", kWithTable));
  const Table expected = {{-0.1, -1200}, {0, 0}, {0.05, 250}};
  EXPECT_EQ(scene.mechanics.translational_forces[0].spring_table, expected);
  // the nodes get the points, not the name of the file
  EXPECT_EQ(load_text(scene.expanded_text, "test").mechanics.translational_forces[0].spring_table, expected);
  folder.write("line.csv", "way, force\n0, 0\n1, 2\n");
  const Table in_si = {{0, 0}, {1, 2}};
  EXPECT_EQ(load_file(folder.write("scene.yaml", kWithTable)).mechanics.translational_forces[0].spring_table, in_si);
}

TEST(Load, ASceneInMemoryNamesNoFileOfPoints) {
  EXPECT_EQ(
      problems_of(kWithTable),
      "test:4:80: Line.spring_table: a scene without a folder cannot name a file; expected the points themselves");
}

TEST(Load, ASceneInMemoryIncludesNothing) {
  EXPECT_EQ(problems_of("include: base.yaml\n" + kPendulum),
            "test:1:1: include: a scene without a folder cannot include a file");
}

TEST(Load, AnUnusualStepIsAWarningAndNotAnError) {
  const Scene scene = load_text("session: {step: 50 us}\n" + kPendulum, "test");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0], "test:1:17: session.step: 0.05 ms is outside 0.1 to 10 ms");
}

TEST(Load, ANumberOfOverrunsThatNoPolicyLooksAtIsReportedAsAWarning) {
  const Scene slip = load_text("session: {overrun_after: 5}\n" + kPendulum, "test");
  ASSERT_EQ(slip.warnings.size(), 1u);
  EXPECT_EQ(slip.warnings[0],
            "test:1:26: session.overrun_after: it has no effect with session.overrun: slip; expected hold or stop");
  EXPECT_TRUE(load_text("session: {overrun_after: 5, overrun: hold}\n" + kPendulum, "test").warnings.empty());
}

constexpr const char* kTank = "volumes: {Tank: {fixed: true}}\n";

std::string refusal_of(const std::string& file, const Overrides& overrides = {}) {
  try {
    (void)load_file(file, overrides);
  } catch (const LoadError& error) {
    return error.what();
  }
  return "";
}

std::string all_of(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += warning + "\n";
  return text;
}

// a damping that a message would show as -0
TEST(Load, ADampingOfMinusZeroIsZero) {
  const TemporaryFolder folder;
  const std::string file = folder.write(
      "scene.yaml",
      "bodies: {Rod: {mass: 2 kg, inertia: [1, 1, 1]}}\n"
      "joints: {Hinge: {type: revolute, body2: Rod, viscous_friction: -0 Nms/rad, coulomb_friction: -0.0}}\n");
  const Scene scene = load_file(file);
  EXPECT_FALSE(std::signbit(scene.mechanics.joints[0].first.viscous_friction));
  EXPECT_EQ(scene.expanded_text.find("friction: -"), std::string::npos) << scene.expanded_text;
  EXPECT_EQ(with_unit(-0.0, Dimension::force), "0 N");
}

TEST(Load, AKeyThatNothingReadsIsAnErrorWhereItIsStatedAndAWarningWhereALaterChoiceLeftIt) {
  const TemporaryFolder folder;
  const std::string file = folder.write("scene.yaml", std::string(kTank) + "hydraulics: {oil_bulk_modulus: 1.4 GPa}\n");
  EXPECT_EQ(refusal_of(file), "");
  // the choice is of a later layer than the key
  const Overrides parabola = {"hydraulics.oil_law=density_parabola"};
  ASSERT_EQ(refusal_of(file, parabola), "");
  EXPECT_NE(all_of(load_file(file, parabola).warnings)
                .find("hydraulics.oil_bulk_modulus: nothing reads this key with oil_law: density_parabola; expected "
                      "oil_law: oil_and_air, or no such key"),
            std::string::npos);
  const std::string overlay =
      folder.write("over.yaml", "include: scene.yaml\nhydraulics: {oil_law: density_parabola}\n");
  EXPECT_EQ(refusal_of(overlay), "");
  // the key is
  EXPECT_NE(refusal_of(overlay, {"hydraulics.entrained_air=0.01"}).find("hydraulics.entrained_air"), std::string::npos)
      << refusal_of(overlay, {"hydraulics.entrained_air=0.01"});
  EXPECT_NE(refusal_of(file, {"hydraulics.oil_compressibility=6e-10"}), "");
}

// an efficiency of 80 % would else be one of 100 % without a word
TEST(Load, AnEfficiencyWithoutAFrictionCurveIsAWarning) {
  const TemporaryFolder folder;
  const auto warnings = [&](const std::string& cylinder, const std::string& motor) {
    const std::string machine = R"(
bodies:
  M: {mass: 1 kg, inertia: [0, 0, 0], position: [0, 1.1 m, 0]}
  W: {mass: 1 kg, inertia: [1, 1, 1]}
joints:
  J: {type: prismatic, body2: M, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0], point1: [0, 1.1 m, 0]}
  H: {type: revolute, body2: W}
forces:
  F: {type: translational, body1: Ground, body2: M}
  G: {type: rotational, body1: Ground, f1: [1, 0, 0], g1: [0, 1, 0], body2: W, f2: [1, 0, 0]}
volumes: {A: {rigid_volume: 1 l}, B: {rigid_volume: 1 l}}
curves: {Fr: {points: [[0, 0], [1, 1]], odd: true}}
components:
  C:
    {type: double_acting_cylinder, force: F, port_a: A, port_b: B, piston_diameter: 70 mm, rod_diameter: 30 mm,
     piston_length: 40 mm, chamber_length: 640 mm, rod_length: 0.8 m, minimum_stroke: 10 mm, maximum_stroke: 590 mm)";
    const std::string turned =
        "}\n  M1: {type: hydraulic_motor, force: G, port_a: A, port_b: B, displacement: 30 cc/rev";
    return all_of(load_file(folder.write("scene.yaml", machine + cylinder + turned + motor + "}\n")).warnings);
  };
  const std::string curve = ", friction_curve: Fr";
  EXPECT_NE(warnings(", cylinder_coefficient: 0.8", "")
                .find("C.cylinder_coefficient: nothing reads this key with no friction_curve"),
            std::string::npos);
  EXPECT_NE(warnings("", curve).find("M1.friction_curve: nothing reads this key with mechanical_coefficient: 1"),
            std::string::npos);
  const std::string sound = warnings(", cylinder_coefficient: 0.8" + curve, ", mechanical_coefficient: 0.9" + curve) +
                            warnings(", cylinder_coefficient: 1", ", mechanical_coefficient: 0.9");
  EXPECT_EQ(sound.find("nothing reads this key"), std::string::npos) << sound;
}

TEST(Load, TheTextOfASessionStatesEveryKeyAndIsReadWithoutAWord) {
  const TemporaryFolder folder;
  const std::string file = folder.write("scene.yaml", std::string(kTank) + "hydraulics: {oil_law: density_parabola}\n");
  const std::string text = load_file(file).expanded_text;
  ASSERT_NE(text.find("oil_bulk_modulus"), std::string::npos);
  const Scene again = load_text(text, "scene");
  EXPECT_EQ(again.expanded_text, text);
  EXPECT_EQ(all_of(again.warnings), "");
}

TEST(Load, WhatChangesNothingIsReportedAsAWarning) {
  const std::string rod = "bodies:\n  Rod: {mass: 1 kg, inertia: [1, 1, 1]}\n";
  const auto warnings = [&](const std::string& rest) { return all_of(load_text(rod + rest, "test").warnings); };
  const auto joint = [](const std::string& type, const std::string& keys) {
    return "joints:\n  J: {type: " + type + ", body2: Rod" + keys + "}\n";
  };
  const std::string hinge = joint("revolute", "");
  EXPECT_EQ(warnings(hinge), "");

  EXPECT_NE(warnings(joint("revolute", ", friction_speed: 2 rad/s")).find("J.friction_speed: it has no effect"),
            std::string::npos);
  EXPECT_NE(warnings(joint("cylindrical", ", friction_speed_angle: 2 rad/s, coulomb_friction: 1 N"))
                .find("J.friction_speed_angle: it has no effect: coulomb_friction_angle is 0"),
            std::string::npos);
  EXPECT_EQ(warnings(joint("cylindrical", ", friction_speed_angle: 2 rad/s, coulomb_friction_angle: 1 Nm")), "");

  EXPECT_NE(warnings(hinge + "mechanics: {contact_substep: 10 us}\n").find("the scene has no contacts"),
            std::string::npos);
  EXPECT_NE(warnings(hinge + "session: {exchange_every: 2}\n").find("session.exchange_every: it has no effect"),
            std::string::npos);
  EXPECT_NE(warnings(hinge + "hydraulics: {entrained_air: 2 %}\n").find("hydraulics.entrained_air: it has no effect"),
            std::string::npos);
  EXPECT_NE(warnings(hinge + "curves:\n  Unused: {points: [[0, 0], [1, 1]]}\n").find("Unused: nothing refers to"),
            std::string::npos);

  const auto force = [&](const std::string& keys) { return warnings(hinge + "forces:\n  F: {" + keys + "}\n"); };
  const std::string spring = "type: translational, body1: Ground, body2: Rod, point2: [1 m, 0, 0]";
  EXPECT_NE(force(spring + ", free_length: 1 m").find("F: it has no effect: without stiffness and damping"),
            std::string::npos);
  EXPECT_EQ(force(spring + ", free_length: 1 m, damping_constant: 1 Ns/m"), "");
  EXPECT_NE(force("type: point_force, body: Rod").find("F: it has no effect: its force is 0"), std::string::npos);

  // unless the scene's own script switches it on
  const auto scripted = [&](const std::string& keys, const std::string& change) {
    return warnings(hinge + "session: {duration: 3 s}\nforces:\n  F: {" + keys +
                    "}\nscript:\n  parameters:\n    - {at: 1 s, set: " + change + ", over: 1 s}\n");
  };
  EXPECT_EQ(scripted("type: point_force, body: Rod", "F.force, value: 10 N"), "");
  EXPECT_EQ(scripted("type: point_torque, body: Rod", "F.torque, value: 10 Nm"), "");
  EXPECT_EQ(scripted(spring + ", free_length: 1 m", "F.spring_constant, value: 10 N/m"), "");
  EXPECT_NE(scripted("type: point_force, body: Rod", "F.force, value: 0 N").find("F: it has no effect"),
            std::string::npos);
  EXPECT_EQ(force("type: point_force, body: Rod, force: 1 N"), "");
}

TEST(Load, AnInputWithoutEffectIsReportedAsAWarning) {
  const std::string body =
      "bodies:\n  Rod: {mass: 1 kg, inertia: [1, 1, 1]}\njoints:\n  Hinge: {type: revolute, body2: Rod}\n";
  const auto warnings = [&](const std::string& load, const std::string& input) {
    return all_of(load_text(body + "forces:\n  Push: {type: point_force, body: Rod" + load +
                                "}\ninputs:\n  Stick: {type: "
                                "analog, primitive: Push" +
                                input + "}\n",
                            "test")
                      .warnings);
  };
  EXPECT_NE(warnings("", "").find("Stick.primitive: the input has no effect: it is multiplied by the force of 'Push'"),
            std::string::npos);
  EXPECT_NE(warnings(", force: 0 N, force_table: [[0, 0], [1, 0]]", "").find("no effect"), std::string::npos);
  EXPECT_NE(warnings(", force: 1 N", ", scale: 0").find("Stick.scale: the input has no effect"), std::string::npos);
  EXPECT_EQ(warnings(", force: 1 N", "").find("no effect"), std::string::npos);
  EXPECT_EQ(warnings(", force_table: [[0, 0], [1, 5]]", "").find("no effect"), std::string::npos);
}

TEST(Load, AProportionalValveWithoutAnInputIsReportedAsAWarning) {
  const auto warnings = [](const std::string& valve, const std::string& inputs) {
    return all_of(
        load_text("volumes:\n  A: {fixed: true, initial_pressure: 150 bar}\n  T: {fixed: true}\ncomponents:\n"
                  "  C: {type: relief_valve, port_1: A, port_2: T, nominal_flow: 60 lpm, setting_pressure: 200 "
                  "bar" +
                      valve + "}\n" + inputs,
                  "test")
            .warnings);
  };
  const std::string proportional = ", proportional: true, minimum_pressure: 12 bar";
  EXPECT_NE(
      warnings(proportional, "")
          .find("C.proportional: no input names the valve: it opens at its minimum_pressure of 12 bar all the time"),
      std::string::npos);
  EXPECT_EQ(warnings(proportional, "inputs:\n  Set: {type: analog, primitive: C}\n").find("C.proportional"),
            std::string::npos);
  EXPECT_EQ(warnings("", "").find("C.proportional"), std::string::npos);
  for (const auto& [valve, input, what] :
       {std::array<std::string, 3>{"", "inputs:\n  Set: {type: analog, primitive: C}\n", "takes no control signal"},
        {proportional, "inputs:\n  Set: {type: analog, primitive: C}\n  Too: {type: analog, primitive: C}\n",
         "is driven by 'Set' already"}}) {
    try {
      warnings(valve, input);
      ADD_FAILURE() << what;
    } catch (const LoadError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
}

// Defaults of valves and gains of components leave an input without effect; a change of the script gives it one.
TEST(Load, AnInputThatMovesNoComponentIsReportedAsAWarning) {
  const auto warnings = [](const std::string& component, const std::string& input, const std::string& script = "") {
    return all_of(load_text("volumes:\n  P: {fixed: true, initial_pressure: 150 bar}\n  A: {fixed: true}\n"
                            "  B: {fixed: true}\n  T: {fixed: true}\ncomponents:\n  C: {" +
                                component + "}\ninputs:\n  Stick: {type: analog, primitive: C" + input + "}\n" + script,
                            "test")
                      .warnings);
  };
  const std::string l90 = "type: l90ls_valve, port_p: P, port_a: A, port_b: B, port_t: T";
  EXPECT_NE(warnings(l90, "").find("Stick.scale: the input has no effect: at full stick it moves the spool of 'C' by "
                                   "0.2 % of its travel, within 32 % of overlap"),
            std::string::npos)
      << warnings(l90, "");
  EXPECT_NE(warnings(l90, ", scale: -160").find("no effect"), std::string::npos);
  EXPECT_EQ(warnings(l90, ", scale: -170").find("no effect"), std::string::npos);
  const std::string spool = "type: spool_valve, port_p: P, port_a: A, port_b: B, port_t: T, area_pa: 1 mm2";
  EXPECT_EQ(warnings(spool, "").find("no effect"), std::string::npos);
  EXPECT_NE(warnings(spool + ", maximum_control_signal: 100", "").find("no effect"), std::string::npos);
  const std::pair<const char*, const char*> gains[] = {
      {"type: pump, port_a: P, port_b: T, speed: 150 rad/s, displacement: 10 cc/rev", "swash_per_signal: 0.5"},
      {"type: flow_source, port_1: T, port_2: P, flow: 10 l/min", "flow_per_signal: 1 l/min"},
      {"type: pressure_source, port_1: P, set_pressure: 10 bar, nominal_flow: 10 l/min, nominal_pressure_drop: 1 bar",
       "pressure_per_signal: 1 bar"},
      {"type: four_way_valve, port_p: P, port_a: A, port_b: B, port_t: T, edge_area: 1 mm2, opening_gain: 0", ""}};
  for (const auto& [component, gain] : gains) {
    EXPECT_NE(warnings(component, "").find("Stick.primitive: the input has no effect"), std::string::npos) << component;
    if (*gain == 0) continue;
    EXPECT_EQ(warnings(component + std::string(", ") + gain, "").find("no effect"), std::string::npos) << component;
  }
  EXPECT_EQ(
      warnings(
          gains[0].first, "",
          "session: {duration: 1 s}\nscript:\n  parameters:\n    - {at: 0.5 s, set: C.swash_per_signal, value: 1}\n")
          .find("no effect"),
      std::string::npos);
}

TEST(Load, TheWindowFollowsThePaceWhenItIsNotGiven) {
  EXPECT_EQ(load_text(kPendulum, "test").session.window_steps(), 1);
  EXPECT_EQ(load_text(kPendulum, "test", {"session.pace=free"}).session.window_steps(), 4);
  EXPECT_EQ(load_text(kPendulum, "test", {"session.window=7"}).session.window_steps(), 7);
  const Overrides free_running = {"session.mode=free_running"};
  const auto with_step = [&](const std::string& step) {
    return load_text(kPendulum, "test", {free_running.front(), "session.step=" + step}).session;
  };
  EXPECT_EQ(with_step("1 ms").window_steps(), 64);
  EXPECT_EQ(with_step("5 ms").window_steps(), 20);
  EXPECT_EQ(with_step("5 ms").wait_budget_duration().ns, 2'500'000);
}

TEST(Load, StepsAreWholeNumbersOfTheDuration) {
  EXPECT_EQ(load_text(kPendulum, "test", {"session.duration=0.3 s", "session.step=0.1 ms"}).session.steps(), 3000);
  EXPECT_EQ(load_text(kPendulum, "test", {"session.duration=0"}).session.steps(), 0);
}

TEST(Load, SeveralDiagnosticsAreOrderedByPlaceAndCounted) {
  try {
    (void)load_file(SLEWRING_SOURCE_DIR "/tests/scenes_negative/more_than_twenty.yaml");
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_EQ(error.diagnostics().size(), 20u);
    EXPECT_EQ(error.omitted(), 5u);
    EXPECT_EQ(error.diagnostics()[0].line, 2);
    EXPECT_EQ(error.diagnostics()[0].path, "Rod_1.mass");
  }
}

TEST(Load, ATextThatIsTooLongForTheWireIsRefused) {
  std::string text = "description: \"" + std::string(kMaxExpandedBytes, 'x') + "\"\n" + kPendulum;
  try {
    (void)load_text(std::move(text), "long");
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("when published to the nodes"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("expected at most 8388608"), std::string::npos) << error.what();
  }
}

TEST(Load, ATextThatIsTooLongForTheWireNamesTheLongestElementAndItsLine) {
  std::string numbers = "0, 0, 0, 1, 0, 0, 0, 1, 0";
  for (int i = 0; i < 720'000; ++i) numbers += ", 0.123456789";
  const std::string shape =
      "shapes:\n  Yard: {type: triangle_mesh, vertices: [" + numbers + "], triangles: [0, 1, 2]}\n";
  try {
    (void)load_text(shape + kPendulum, "long");
    FAIL();
  } catch (const LoadError& error) {
    ASSERT_EQ(error.diagnostics().size(), 1u);
    EXPECT_EQ(error.diagnostics()[0].line, 2);
    EXPECT_NE(error.diagnostics()[0].what.find("of them in 'Yard'"), std::string::npos) << error.diagnostics()[0].what;
    EXPECT_NE(error.diagnostics()[0].expected.find("meshes of fewer triangles"), std::string::npos);
  }
}

TEST(Assets, HaveNamesThatFitTheWire) {
  const std::string name(kMaxAssetNameLength + 1, 'a');
  try {
    (void)load_text("assets: [" + name + "]\n" + kPendulum, "test");
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_STREQ(error.what(), "test:1:10: assets: a file's name has 256 characters; expected at most 255");
  }
}

TEST(Assets, AreMeasuredAndComparedByContents) {
  const TemporaryFolder here, there;
  here.write("mesh.stl", "abc");
  const Scene scene = load_file(here.write("scene.yaml", "assets: [mesh.stl]\n" + kPendulum));
  ASSERT_EQ(scene.assets.size(), 1u);
  EXPECT_EQ(scene.assets[0].size, 3u);
  // FIPS 180, digest of "abc": ba7816bf ... f20015ad
  EXPECT_EQ(scene.assets[0].sha256[0], 0xba);
  EXPECT_EQ(scene.assets[0].sha256[31], 0xad);
  EXPECT_TRUE(check_assets(scene.assets, here.path()).is_ok());

  const Status missing = check_assets(scene.assets, there.path());
  EXPECT_EQ(missing.code, ExitCode::bad_input);
  EXPECT_NE(missing.text.find("asset 'mesh.stl' cannot be read"), std::string::npos) << missing.text;
  there.write("mesh.stl", "abd");
  EXPECT_NE(check_assets(scene.assets, there.path()).text.find("differs from the session's (3 bytes here, 3 there)"),
            std::string::npos);
  there.write("mesh.stl", "abcd");
  EXPECT_NE(check_assets(scene.assets, there.path()).text.find("differs from the session's (4 bytes here, 3 there)"),
            std::string::npos);
}

// the published text of a session must hold every joint
TEST(Scene, EveryJointTypeIsWrittenAndReadBack) {
  for (const ElementTable& table : element_tables()) {
    if (table.section != "joints") continue;
    const std::string type(table.type);
    const bool crosses_axes = type == "universal" || type == "perpendicular";
    const bool is_link = type.find('_') != std::string::npos && !type.starts_with("in_");
    const std::string text =
        "bodies:\n  Rod: {position: [0, 0, 0], mass: 2 kg, inertia: [1, 1, 1]}\njoints:\n  Joint: {type: " + type +
        ", body2: Rod" + (crosses_axes ? ", orientation1: [90 deg, 0, 0]" : "") +
        (is_link ? ", point1: [1 m, 0, 0]" : "") + "}\n";
    ASSERT_EQ(problems_of(text), "") << type;
    const Scene scene = load_text(text, "test");
    EXPECT_NE(scene.expanded_text.find("    type: " + type + "\n"), std::string::npos) << scene.expanded_text;
    const Scene again = load_text(scene.expanded_text, "test");
    EXPECT_EQ(again.expanded_text, scene.expanded_text) << type;
    EXPECT_EQ(again.mechanics.joints.at(0).type, scene.mechanics.joints.at(0).type) << type;
  }
}

TEST(Assets, KeepTheirNamesInTheCanonicalText) {
  const TemporaryFolder folder;
  folder.write("mesh 1.stl", "abc");
  const Scene scene = load_file(folder.write("scene.yaml", "assets: [mesh 1.stl]\n" + kPendulum));
  const Scene again = load_text(scene.expanded_text, "test");
  ASSERT_EQ(again.assets.size(), 1u);
  EXPECT_EQ(again.assets[0].name, "mesh 1.stl");
  EXPECT_EQ(again.assets[0].size, 0u);
}

TEST(Assets, OutsideTheScenesFolderAreRefused) {
  EXPECT_EQ(problems_of("assets: [../mesh.stl, /etc/passwd]\n" + kPendulum),
            "test:1:10: assets: an entry is '../mesh.stl'; expected a file in the scene's folder\n"
            "test:1:23: assets: an entry is '/etc/passwd'; expected a file in the scene's folder");
}

}  // namespace load_test
}  // namespace slew::scene
