// SPDX-License-Identifier: Apache-2.0
// Rules of force elements and of the masses that elements carry: path and first words; live constants and their hash.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "multibody/model/parameters.h"
#include "multibody/model/state.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace element_rules_test {

// one of each kind: sound
MechanicsDef sound() {
  MechanicsDef def;
  def.bodies = {{.name = "Arm", .mass = 2, .inertia = {1, 1, 1}}, {.name = "Load", .mass = 5, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Hinge", .body2 = "Arm"}, {.name = "Free", .type = JointType::floating, .body2 = "Load"}};
  def.point_forces = {{.name = "Push", .body = "Arm", .force = 3, .force_table = {{0, 0}, {1, 2}}}};
  def.point_torques = {{.name = "Turn", .body = "Load", .torque = 4}};
  def.bushings = {{.name = "Mount", .frames = {.body1 = "Arm", .body2 = "Load"}, .stiffness = {1, 2, 3}}};
  def.bushings[0].stiffness_matrix.assign(36, 1.0);
  def.bushings[0].damping_matrix.assign(36, 0.0);
  def.beams = {{.name = "Beam",
                .frames = {.body1 = "Ground", .body2 = "Load", .point2 = {1, 0, 0}},
                .length = 1,
                .youngs_modulus = 1e9,
                .area = 1e-4,
                .second_moment_y = 1e-8,
                .second_moment_z = 1e-8,
                .torsion_constant = 1e-8}};
  def.ropes = {{.name = "Rope",
                .bodies = {"Ground", "Arm", "Load"},
                .points = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                .free_length = 2,
                .stiffness = 100}};
  def.tyre_dummies = {{.name = "Wheel", .relative_to = "Load", .mass = 1, .radius = 0.4, .stiffness = 1e4}};
  def.part_dummies = {{.name = "Part", .carried_by = "Arm", .mass = 1, .inertia = {1, 1, 1}}};
  def.constraint_dummies = {{.name = "Pin", .relative_to = "Hinge", .mass = 1, .inertia = {1, 1, 1}}};
  return def;
}

void expect_problem(const std::function<void(MechanicsDef&)>& change, const std::string& path,
                    const std::string& what) {
  MechanicsDef def = sound();
  change(def);
  Problems problems;
  validate(def, problems);
  const bool is_found = std::any_of(problems.begin(), problems.end(), [&](const Problem& problem) {
    return problem.path == path && problem.what.find(what) != std::string::npos;
  });
  EXPECT_TRUE(is_found) << "expected " << path << ": " << what << "\ngot " << testing::text_of(problems);
}

TEST(ElementRules, FindNothingInSoundElements) {
  Problems problems;
  validate(sound(), problems);
  EXPECT_EQ(testing::text_of(problems), "");
}

TEST(ElementRules, NameWhatDoesNotExist) {
  expect_problem([](auto& d) { d.point_forces[0].body = "X"; }, "Push.body", "there is no body 'X'");
  expect_problem([](auto& d) { d.bushings[0].frames.body2 = "X"; }, "Mount.body2", "there is no body 'X'");
  expect_problem([](auto& d) { d.ropes[0].bodies[1] = "X"; }, "Rope.bodies", "there is no body 'X'");
  expect_problem([](auto& d) { d.tyre_dummies[0].relative_to = "X"; }, "Wheel.relative_to", "there is no body 'X'");
  expect_problem([](auto& d) { d.part_dummies[0].carried_by = "X"; }, "Part.carried_by", "there is no body 'X'");
  expect_problem([](auto& d) { d.constraint_dummies[0].relative_to = "X"; }, "Pin.relative_to",
                 "there is no joint 'X'");
  expect_problem([](auto& d) { d.point_torques[0].name = "Push"; }, "Push", "is taken");
}

TEST(ElementRules, WantElementsThatCanDoSomething) {
  expect_problem([](auto& d) { d.point_forces[0].body = "Ground"; }, "Push.body", "acts on Ground");
  expect_problem([](auto& d) { d.point_torques[0].direction = {}; }, "Turn.direction", "is zero");
  expect_problem([](auto& d) { d.beams[0].frames.body1 = "Load"; }, "Beam.body2", "both bodies are 'Load'");
  expect_problem([](auto& d) { d.ropes[0].bodies = {"Arm", "Arm", "Arm"}; }, "Rope.bodies", "all points are on 'Arm'");
  expect_problem([](auto& d) { d.ropes[0].points.pop_back(); }, "Rope.points", "2 points for 3 bodies");
  expect_problem([](auto& d) { d.ropes[0].stiffness = 0; }, "Rope", "no spring");
  expect_problem([](auto& d) { d.ropes[0].axial_rigidity = 1; }, "Rope", "several springs");
  expect_problem([](auto& d) { d.tyre_dummies[0].relative_to = "Ground"; }, "Wheel.relative_to", "is on Ground");
  expect_problem([](auto& d) { d.tyre_dummies[0].ground_normal = {}; }, "Wheel.ground_normal", "is zero");
  expect_problem([](auto& d) { d.joints[0].type = JointType::spherical_spherical; }, "Pin.relative_to",
                 "massless link");
  expect_problem([](auto& d) { d.part_dummies[0].inertia = {1, 1, 3}; }, "Part.inertia", "triangle rule");
}

TEST(ElementRules, WantMatricesOfAnEnergyAndOfDampers) {
  expect_problem([](auto& d) { d.bushings[0].stiffness_matrix.pop_back(); }, "Mount.stiffness_matrix",
                 "has 35 numbers");
  expect_problem([](auto& d) { d.bushings[0].stiffness_matrix[1] = 2; }, "Mount.stiffness_matrix",
                 "not symmetric in row 2, column 1");
  expect_problem([](auto& d) { d.bushings[0].damping_matrix[1] = d.bushings[0].damping_matrix[6] = 2; },
                 "Mount.damping_matrix", "gets energy");
  // as much on the diagonal makes it sound
  MechanicsDef def = sound();
  def.bushings[0].damping_matrix[1] = def.bushings[0].damping_matrix[6] = 2;
  def.bushings[0].damping = {2, 2, 0};
  Problems problems;
  validate(def, problems);
  EXPECT_EQ(testing::text_of(problems), "");
}

TEST(ElementRules, WantStartsThatElementsCanBegin) {
  expect_problem(
      [](auto& d) {
        d.bushings[0].frames.orientation2 = {3.1, 0, 0};
      },
      "Mount.orientation2", "turned by 177.6 deg");
  expect_problem([](auto& d) { d.beams[0].frames.point2 = {0, 1, 0}; }, "Beam.point2", "frame 2 is at (0, 1, 0) m");
  expect_problem([](auto& d) { d.beams[0].frames.orientation2 = {0, 1, 0}; }, "Beam.orientation2", "turned by 57.3");
  expect_problem([](auto& d) { d.ropes[0].points[1] = {0, 1, 0}; }, "Rope.points", "points 1 and 2 coincide");
  expect_problem(
      [](auto& d) {
        d.tyre_dummies[0].orientation = {0, M_PI / 2, 0};
      },
      "Wheel.orientation", "stands on the ground");
}

TEST(ElementRules, WantTablesThatAreFunctionsAndDampersThatBrake) {
  expect_problem([](auto& d) { d.point_forces[0].force_table.pop_back(); }, "Push.force_table", "has one point");
  expect_problem([](auto& d) { d.point_forces[0].force_table[1][0] = 0; }, "Push.force_table", "do not increase");
  expect_problem(
      [](auto& d) {
        d.bushings[0].damper_tables.about_z = {{-1, -1}, {1, 1}};
      },
      "Mount.damper_table_about_z", "no point [0, 0]");
  expect_problem([](auto& d) { d.ropes[0].damper_table = {{-1, 1}, {0, 0}}; }, "Rope.damper_table", "drives");
  expect_problem(
      [](auto& d) {
        d.ropes[0].stiffness = 0;
        d.ropes[0].spring_table = {{0, 1}, {1, 2}};
      },
      "Rope.spring_table", "begins elsewhere");
  const auto line = [](MechanicsDef& d) -> TranslationalForceDef& {
    d.translational_forces = {{.name = "Line", .body1 = "Ground", .point1 = {0, 2, 0}, .body2 = "Arm"}};
    return d.translational_forces[0];
  };
  expect_problem(
      [&](auto& d) {
        line(d).spring_table = {{0, 0}, {1, 2}};
        d.translational_forces[0].spring_constant = 1;
      },
      "Line.spring_table", "a spring_constant as well");
}

// every live field by its path, one by one
TEST(ElementParameters, AreFoundSetAndHashed) {
  Model model = build_model(sound());
  const State state = start_state(model);
  std::set<std::uint64_t> hashes;
  const auto digest = [&] {
    StateHash hash;
    add_to_hash(model, state, hash);
    return hash.digest();
  };
  hashes.insert(digest());
  std::size_t count = 1;
  for (const char* path :
       {"Push.force", "Turn.torque", "Mount.stiffness.x", "Mount.rotational_stiffness.z", "Mount.damping.y",
        "Mount.rotational_damping.x", "Mount.preload_force.z", "Mount.preload_moment.y", "Beam.damping_time",
        "Rope.free_length", "Rope.stiffness", "Rope.axial_rigidity", "Rope.damping_constant", "Wheel.ground_height",
        "Wheel.stiffness", "Wheel.damping", "Wheel.friction", "Wheel.rolling_resistance"}) {
    const auto parameter = find_parameter(model, path);
    ASSERT_TRUE(parameter.has_value()) << path;
    set_parameter(model, *parameter, 0.123 + static_cast<double>(count));
    EXPECT_EQ(get_parameter(model, *parameter), 0.123 + static_cast<double>(count)) << path;
    hashes.insert(digest());
    EXPECT_EQ(hashes.size(), ++count) << path << " is not in the hash";
  }
  EXPECT_EQ(model.elements.bushings[0].spring[0], 0.123 + 3);
  for (const char* path : {"Push.torque", "Turn.force", "Mount.stiffness", "Beam.length", "Rope.points", "Wheel.mass"})
    EXPECT_FALSE(find_parameter(model, path).has_value()) << path;
}

// the field table of a Def against the values of its row, both ways; sound() has every kind
TEST(ElementValues, AreTheLiveFieldsOfEveryKind) {
  const MechanicsDef def = sound();
  const Model model = build_model(def);
  std::size_t live = 0;
  for_each_force_type(def, [&](auto, const auto& type, const auto& defs) {
    ASSERT_FALSE(defs.empty()) << type.name;
    for (const Field& field : type.fields()) {
      if (field.change != Change::live) continue;
      const std::string path = defs.front().name + "." + std::string(field.key);
      if (field.type == FieldType::triple) {
        for (const char* axis : {".x", ".y", ".z"}) EXPECT_TRUE(find_parameter(model, path + axis)) << path << axis;
      } else {
        EXPECT_TRUE(find_parameter(model, path)) << path;
      }
      live += defs.size() * (field.type == FieldType::triple ? 3 : 1);
    }
  });
  EXPECT_EQ(value_count(model.elements), live);
}

TEST(ElementTime, IsPartOfTheStateWhereALoadFollowsTheClock) {
  MechanicsDef def = sound();
  for (const bool has_table : {true, false}) {
    if (!has_table) def.point_forces[0].force_table.clear();
    const Model model = build_model(def);
    State state = start_state(model);
    StateHash before, after;
    add_to_hash(model, state, before);
    state.time = 1e-9;
    add_to_hash(model, state, after);
    EXPECT_EQ(before.digest() != after.digest(), has_table);
  }
}

}  // namespace element_rules_test
}  // namespace slew::multibody
