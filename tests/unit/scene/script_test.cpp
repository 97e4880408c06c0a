// SPDX-License-Identifier: Apache-2.0
#include "scene/script.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "scene/parameters.h"
#include "scene/scene.h"
#include "scene_text.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace script_test {

const std::string kValve =
    "volumes:\n"
    "  Vol_P: {rigid_volume: 1 l}\n"
    "  Vol_A: {rigid_volume: 1 l}\n"
    "  Vol_B: {rigid_volume: 1 l}\n"
    "  Tank: {fixed: true}\n"
    "components:\n"
    "  Valve: {type: l90ls_valve, port_p: Vol_P, port_a: Vol_A, port_b: Vol_B, port_t: Tank}\n"
    "  Valve_2: {type: l90ls_valve, port_p: Vol_P, port_a: Vol_A, port_b: Vol_B, port_t: Tank}\n"
    "inputs:\n"
    "  Stick: {type: analog, primitive: Valve, channel: 0}\n"
    "  Button: {type: digital, primitive: Valve_2, channel: 1}\n";

ScriptPlayer player(const std::string& script) {
  return ScriptPlayer(load_text(kValve + script, "test"));
}

SimTime at(double seconds) {
  return {std::llround(seconds * 1e9)};
}

TEST(Script, IsExactAtItsPointsAndLinearBetween) {
  const ScriptPlayer script = player("script:\n  inputs:\n    Stick: [[0.1 s, 0.3], [0.7 s, -0.1], [1 s, 1]]\n");
  EXPECT_EQ(script.value(0, at(0.1)), 0.3);
  EXPECT_EQ(script.value(0, at(0.7)), -0.1);
  EXPECT_EQ(script.value(0, at(1)), 1.0);
  EXPECT_DOUBLE_EQ(script.value(0, at(0.4)), 0.1);
}

TEST(Script, HoldsTheFirstAndTheLastValue) {
  const ScriptPlayer script = player("script:\n  inputs:\n    Stick: [[1 s, 0.5], [2 s, 1]]\n");
  EXPECT_EQ(script.value(0, at(0)), 0.5);
  EXPECT_EQ(script.value(0, at(100)), 1.0);
  EXPECT_EQ(script.end(), at(2));
}

TEST(Script, AValueThatHoldsFromTheStartOnBeforeItsPointIsWarnedOf) {
  const auto warnings = [](const std::string& points) {
    std::string all;
    for (const std::string& warning :
         load_text(kValve + "script:\n  inputs:\n    Stick: " + points + "\n", "test").warnings) {
      if (warning.find("script") != std::string::npos) all += warning;
    }
    return all;
  };
  EXPECT_NE(warnings("[[0.5 s, 1], [0.6 s, 1]]").find("its first point is at 0.5 s: 1 holds from 0 s on"),
            std::string::npos);
  EXPECT_EQ(warnings("[[0.5 s, 0], [0.6 s, 1]]"), "");
  EXPECT_EQ(warnings("[[0 s, 1], [0.6 s, 1]]"), "");
}

TEST(Script, StepInterpolationJumpsAtThePoint) {
  const ScriptPlayer script = player("script:\n  interpolation: step\n  inputs:\n    Stick: [[0, 0], [1 s, 1]]\n");
  EXPECT_EQ(script.value(0, {999'999'999}), 0.0);
  EXPECT_EQ(script.value(0, {1'000'000'000}), 1.0);
}

// a switch has no values between: it does not turn half-way to the next point
TEST(Script, ADigitalInputHoldsItsValueFromPointToPoint) {
  const std::string tracks = "  inputs:\n    Stick: [[0, 0], [1 s, 1]]\n    Button: [[0, 0], [1 s, 1], [2 s, 0]]\n";
  for (const char* interpolation : {"", "  interpolation: linear\n", "  interpolation: step\n"}) {
    const ScriptPlayer script = player(std::string("script:\n") + interpolation + tracks);
    EXPECT_EQ(script.value(1, {999'999'999}), 0.0) << interpolation;
    EXPECT_EQ(script.value(1, at(1)), 1.0) << interpolation;
    EXPECT_EQ(script.value(1, {1'999'999'999}), 1.0) << interpolation;
    EXPECT_EQ(script.value(1, at(2)), 0.0) << interpolation;
    SignalCourse course;
    script.read_course(1, at(0.4), at(0.6), course);
    ASSERT_EQ(course.size(), 1u) << interpolation;
    EXPECT_EQ(course[0].end, 0.0) << interpolation;
  }
  // a stick beside it still moves along the line
  EXPECT_DOUBLE_EQ(player("script:\n" + tracks).value(0, at(0.5)), 0.5);
}

// a table beside the scene, as for --input FILE.csv, and as an export of a recording's inputs
TEST(Script, ADigitalInputOfATableHoldsItsValueToo) {
  const TemporaryFolder folder;
  folder.write("keys.csv", "time [s],Button.raw,Stick.raw\n0,0,0\n1,1,1\n");
  const ScriptPlayer script(
      load_file(folder.write("scene.yaml", kValve + "script: {interpolation: linear, file: keys.csv}\n")));
  EXPECT_EQ(script.value(1, {999'999'999}), 0.0);
  EXPECT_EQ(script.value(1, at(1)), 1.0);
  EXPECT_DOUBLE_EQ(script.value(0, at(0.5)), 0.5);
}

TEST(Script, AnInputWithoutTrackIsNeutral) {
  const ScriptPlayer script = player("script:\n  inputs:\n    Stick: [[0, 1]]\n");
  EXPECT_EQ(script.value(1, at(1)), 0.0);
  EXPECT_EQ(script.value(7, at(1)), 0.0);
}

SignalCourse course(const ScriptPlayer& script, SimTime from, SimTime to) {
  SignalCourse pieces{{1, 7, 7}};  // the old content is dropped
  script.read_course(0, from, to, pieces);
  return pieces;
}

void expect_pieces(const SignalCourse& pieces, const std::vector<std::array<double, 3>>& expected) {
  ASSERT_EQ(pieces.size(), expected.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    EXPECT_DOUBLE_EQ(pieces[i].share, expected[i][0]) << i;
    EXPECT_DOUBLE_EQ(pieces[i].begin, expected[i][1]) << i;
    EXPECT_DOUBLE_EQ(pieces[i].end, expected[i][2]) << i;
  }
}

TEST(Script, ItsCourseOverATimeIsStraightBetweenPointsAndJumps) {
  const ScriptPlayer script =
      player("script:\n  inputs:\n    Stick: [[1 s, 0.5], [1.5 s, -0.5], [1.5 s, 0.25], [2 s, 1]]\n");
  expect_pieces(course(script, at(0.5), at(1)), {{1, 0.5, 0.5}});
  expect_pieces(course(script, at(0.75), at(1.25)), {{0.5, 0.5, 0.5}, {0.5, 0.5, 0}});
  expect_pieces(course(script, at(1.1), at(1.2)), {{1, 0.3, 0.1}});
  expect_pieces(course(script, at(1.25), at(1.5)), {{1, 0, -0.5}});
  expect_pieces(course(script, at(1.5), at(1.75)), {{1, 0.25, 0.625}});
  expect_pieces(course(script, at(1), at(2)), {{0.5, 0.5, -0.5}, {0.5, 0.25, 1}});
  expect_pieces(course(script, at(1.75), at(2.25)), {{0.5, 0.625, 1}, {0.5, 1, 1}});
  expect_pieces(course(script, at(3), at(4)), {{1, 1, 1}});
}

TEST(Script, NoCourseHasMorePiecesThanItStates) {
  const ScriptPlayer script = player(
      "script:\n  inputs:\n    Stick: [[1 s, 0.5], [1.002 s, -0.5], [1.002 s, 0.25], "
      "[1.003 s, 0], [1.5 s, 1]]\n");
  for (const std::int64_t length_ms : {1, 2, 3, 4, 1000}) {
    const std::size_t most = script.most_pieces(milliseconds(length_ms));
    std::size_t largest = 0;
    for (std::int64_t from_ns = 0; from_ns < 2'000'000'000; from_ns += 500'000) {
      largest = std::max(largest, course(script, {from_ns}, SimTime{from_ns} + milliseconds(length_ms)).size());
    }
    EXPECT_LE(largest, most) << length_ms;
    EXPECT_LE(most, 6u) << length_ms;
  }
}

TEST(Script, MeansOfItsCourseAddUpToTheAreaBelowIt) {
  const ScriptPlayer script =
      player("script:\n  inputs:\n    Stick: [[0, -1], [0.0101 s, 0.7], [0.0101 s, 0.2], [0.05 s, 1]]\n");
  const double area = 0.0101 * (0.7 - 1) / 2 + 0.0399 * 1.2 / 2 + 0.05;  // until 0.1 s
  for (const std::int64_t step_ns : {1'000'000, 2'500'000, 20'000'000, 100'000'000}) {
    double sum = 0;
    for (std::int64_t t = 0; t < 100'000'000; t += step_ns) {
      SignalMean mean;
      for (const SignalPiece& piece : course(script, {t}, {t + step_ns})) mean.add(piece.share, piece.begin, piece.end);
      sum += mean.value() * 1e-9 * static_cast<double>(step_ns);
    }
    EXPECT_NEAR(sum, area, 1e-15) << step_ns;
  }
}

TEST(Script, AHeldScriptIsHeldOverATimeFromItsBegin) {
  const ScriptPlayer script = player("script:\n  interpolation: step\n  inputs:\n    Stick: [[0, 0], [1 s, 1]]\n");
  expect_pieces(course(script, at(0.9), at(1.1)), {{1, 0, 0}});
  expect_pieces(course(script, at(1), at(1.1)), {{1, 1, 1}});
  expect_pieces(course(player("script:\n  inputs:\n    Button: [[0, 1]]\n"), at(0), at(1)), {{1, 0, 0}});
}

TEST(Script, ADigitalInputTakesZeroAndOneOnly) {
  EXPECT_EQ(problems_of(kValve + "script:\n  inputs:\n    Button: [[0, 0], [1 s, 0.5]]\n"),
            "test:14:13: script.inputs.Button: 0.5 is no value of a digital input; expected 0 or 1");
}

TEST(Script, ChangesComeInOrderOnceEach) {
  const ScriptPlayer script = player(
      "script:\n"
      "  parameters:\n"
      "    - {at: 3 s, set: Valve.overlap, value: 20 %, over: 2 s}\n"
      "    - {at: 1 s, set: Valve.compensator_pressure, value: 9 bar}\n");
  EXPECT_TRUE(script.changes(at(0), at(1)).empty());
  const auto first = script.changes(at(1), at(1.001));
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].set, "Valve.compensator_pressure");
  EXPECT_EQ(first[0].value, 9e5);
  const auto second = script.changes(at(2.999), at(10));
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].value, 0.2);
  EXPECT_EQ(second[0].over, 2.0);
}

TEST(Script, AChangeWithoutTimeTakesTheParametersOwn) {
  const Scene scene =
      load_text(kPendulum + "script:\n  parameters:\n    - {at: 1 s, set: Rod.mass, value: 3 kg}\n", "test");
  ASSERT_EQ(scene.script.changes.size(), 1u);
  EXPECT_EQ(scene.script.changes[0].over, 1.0);
}

TEST(Script, WarnsOfATimeThatIsRoundedToWholeSteps) {
  const auto warnings = [](const std::string& times) {
    return load_text(kPendulum + "session: {step: 10 ms}\nscript:\n  parameters:\n    - {set: Rod.mass, value: 3 kg, " +
                         times + "}\n",
                     "test")
        .warnings;
  };
  const auto late = warnings("at: 0.109 s, over: 0 s");
  ASSERT_EQ(late.size(), 1u);
  EXPECT_NE(late[0].find("script.parameters[0].at: 0.109 s is within a step of 10 ms: the change acts from 0.11 s on; "
                         "expected a multiple of session.step"),
            std::string::npos)
      << late[0];
  const auto rounded = warnings("at: 0.1 s, over: 25 ms");
  ASSERT_EQ(rounded.size(), 1u);
  EXPECT_NE(rounded[0].find("script.parameters[0].over: 25 ms is no whole number of steps of 10 ms: the change takes "
                            "30 ms; expected a multiple of session.step"),
            std::string::npos)
      << rounded[0];
  EXPECT_TRUE(warnings("at: 0.11 s, over: 70 ms").empty());
  EXPECT_TRUE(warnings("at: 0.11 s").empty());
}

TEST(Script, AChangeThatActsBehindTheEndOfTheRunHasNoEffect) {
  const auto warnings = load_text(kPendulum +
                                      "session: {step: 10 ms, duration: 1 s}\nscript:\n  parameters:\n"
                                      "    - {at: 0.995 s, set: Rod.mass, value: 3 kg}\n",
                                  "test")
                            .warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find("the change of Rod.mass at 0.995 s has no effect") != std::string::npos;
  }));
}

// rules between fields hold for the values that the script reaches, change after change
TEST(Script, AChangeThatTheComponentsRulesRefuseIsRefused) {
  const std::string circuit =
      "volumes:\n  T: {fixed: true}\n  P: {rigid_volume: 1 l}\n  S: {rigid_volume: 1 l}\ncomponents:\n"
      "  U: {type: unloading_valve, port_1: P, port_2: T, port_3: S, nominal_flow: 60 l/min, cut_out_pressure: 100 "
      "bar, "
      "cut_in_pressure: 80 bar}\n"
      "script:\n  parameters:\n";
  const auto change = [](const char* at, const char* key, const char* value) {
    return fmt::format("    - {{at: {}, set: U.{}, value: {}}}\n", at, key, value);
  };
  const std::string refusal = problems_of(circuit + change("1 s", "cut_in_pressure", "120 bar"));
  EXPECT_NE(refusal.find("script.parameters[0]: U.cut_in_pressure is refused: U.cut_in_pressure: the valve would shut "
                         "above the pressure at which it opens; expected at most cut_out_pressure"),
            std::string::npos)
      << refusal;
  const std::string out = change("1 s", "cut_out_pressure", "150 bar");
  EXPECT_EQ(problems_of(circuit + out + change("2 s", "cut_in_pressure", "120 bar")), "");
  EXPECT_EQ(problems_of(circuit + change("1 s", "cut_in_pressure", "120 bar") + out), "") << "in one step";
  // at 2 s the ramp is at 105 bar
  const std::string slow = "    - {at: 1 s, set: U.cut_out_pressure, value: 150 bar, over: 10 s}\n";
  EXPECT_NE(problems_of(circuit + slow + change("2 s", "cut_in_pressure", "110 bar")).find("script.parameters[1]: "),
            std::string::npos);
  EXPECT_EQ(problems_of(circuit + slow + change("2 s", "cut_in_pressure", "104 bar")), "");
  const Scene scene = load_text(circuit + out, "test");
  EXPECT_EQ(load_text(scene.expanded_text, "test").expanded_text, scene.expanded_text);
  EXPECT_EQ(ParameterDirectory(scene).find("U.cut_out_pressure")->value, 100e5);
}

TEST(Script, MoreChangesInOneStepThanATickHoldsAreRefused) {
  std::string text = kPendulum + "script:\n  parameters:\n";
  for (int i = 0; i < 17; ++i) text += "    - {at: 1 s, set: Rod.mass, value: 3 kg}\n";
  EXPECT_EQ(problems_of(text),
            "test:6:3: script.parameters: more than 16 changes in the step at 1 s; expected at most 16 in one step");
}

TEST(Script, ACsvFileBesideTheSceneIsTheSameAsPointsInIt) {
  const TemporaryFolder folder;
  folder.write("lift.csv", "# a comment\ntime, Button, Stick\n\n0, 0, 0\n0.5, , 1\r\n2,1,-1\n");
  const Scene scene = load_file(folder.write("scene.yaml", kValve + "script: {file: lift.csv, interpolation: step}\n"));
  ASSERT_EQ(scene.script.tracks.size(), 2u);
  EXPECT_EQ(scene.script.tracks[0].input, "Stick");  // in the order of the inputs
  EXPECT_EQ(scene.script.tracks[0].points, (Table{{0, 0}, {0.5, 1}, {2, -1}}));
  EXPECT_EQ(scene.script.tracks[1].points, (Table{{0, 0}, {2, 1}}));
  EXPECT_EQ(load_text(scene.expanded_text, "test").script.tracks[0].points, scene.script.tracks[0].points);
}

TEST(Script, AYamlFileHoldsTheKeysOfTheSection) {
  const TemporaryFolder folder;
  folder.write("lift.yaml", "interpolation: step\ninputs:\n  Stick: [[0, 0], [1 s, 1]]\n");
  const Scene scene = load_file(folder.write("scene.yaml", kValve + "script: {file: lift.yaml}\n"));
  EXPECT_EQ(scene.script.interpolation, ScriptInterpolation::step);
  ASSERT_EQ(scene.script.tracks.size(), 1u);
}

TEST(Script, ASceneWithoutFolderCannotNameAFile) {
  EXPECT_EQ(problems_of(kPendulum + "script: {file: a.csv}\n"),
            "test:5:16: script.file: a scene without a folder cannot name a file; expected the points themselves under "
            "inputs");
}

}  // namespace script_test
}  // namespace slew::scene
