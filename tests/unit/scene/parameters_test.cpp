// SPDX-License-Identifier: Apache-2.0
#include "scene/parameters.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>

#include "build_paths.h"
#include "scene_text.h"

namespace slew::scene {
namespace parameters_test {

class Parameters : public ::testing::Test {
 protected:
  Scene scene = load_text(kPendulum, "test");
  ParameterDirectory directory{scene};
};

TEST_F(Parameters, ListEveryNumberWithItsValueAndLimits) {
  const ParameterInfo* mass = directory.find("Rod.mass");
  ASSERT_NE(mass, nullptr);
  EXPECT_EQ(mass->value, 2.0);
  EXPECT_EQ(mass->dimension, Dimension::mass);
  EXPECT_EQ(mass->change, Change::live);
  EXPECT_EQ(mass->ramp, 1.0);
  EXPECT_EQ(directory.find("Rod.center_of_mass.x")->value, 0.5);
  EXPECT_EQ(directory.find("session.step")->change, Change::restart);
  EXPECT_TRUE(directory.find("session.window")->is_integer);
  EXPECT_EQ(directory.find("Rod.relative_to"), nullptr);
}

TEST_F(Parameters, AreTheSameForTheSameSceneInCanonicalText) {
  const auto a = parameters(scene);
  const auto b = parameters(load_text(scene.expanded_text, "test"));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].path, b[i].path);
    EXPECT_EQ(a[i].value, b[i].value) << a[i].path;
  }
}

TEST_F(Parameters, AnAssignmentGivesThePathTheSiValueAndTheRamp) {
  const Assignment assignment = directory.parse_assignment("Rod.mass=1.5 t");
  EXPECT_TRUE(assignment.status.is_ok()) << assignment.status.text;
  EXPECT_EQ(assignment.path, "Rod.mass");
  EXPECT_EQ(assignment.value, 1500.0);
  EXPECT_EQ(assignment.over, milliseconds(1000));
}

TEST_F(Parameters, AChangeIsSpreadOverWholeSteps) {
  EXPECT_EQ(directory.check("Rod.mass", 2, microseconds(2500)).over, milliseconds(3));
  EXPECT_EQ(directory.check("Rod.mass", 2, microseconds(2499)).over, milliseconds(2));
  EXPECT_EQ(directory.check("Rod.mass", 2, microseconds(1)).over, milliseconds(1));
  EXPECT_EQ(directory.check("Rod.mass", 2, SimDuration{}).over.ns, 0);
}

// a value in its own range may still make a machine that the loader refuses
TEST_F(Parameters, AValueWithWhichTheLoaderWouldRefuseTheMachineIsRefusedWithItsSentence) {
  for (const double mass : {4.9e-324, 1e-300, 1e-200, 1e-100, 1e-13}) {
    const std::string live = directory.check("Rod.mass", mass).status.text;
    EXPECT_NE(live.find("is refused: Rod.mass: with "), std::string::npos) << mass << ": " << live;
    EXPECT_NE(live.find("the radius of gyration is"), std::string::npos) << live;
    const std::string loaded = problems_of(kPendulum, {"Rod.mass=" + fmt::format("{}", mass)});
    EXPECT_NE(loaded.find("the radius of gyration is"), std::string::npos) << mass << ": " << loaded;
  }
  EXPECT_EQ(directory.check("Rod.mass", 1e-3).status.text, "");
}

// the inertia follows the mass, whatever point it is given about
TEST_F(Parameters, AMassIsAcceptedWhereTheInertiaIsGivenAboutTheOrigin) {
  const ParameterDirectory about_origin(
      load_text(kPendulum, "test", {"Rod.inertia=[0.6, 0.9, 0.86]", "Rod.inertia_about=body_origin"}));
  for (const double mass : {0.5, 4.0, 50.0}) EXPECT_EQ(about_origin.check("Rod.mass", mass).status.text, "") << mass;
}

TEST_F(Parameters, AnAssignmentIsRefusedWithAReason) {
  const auto refusal = [&](const char* text) { return directory.parse_assignment(text).status.text; };
  EXPECT_EQ(refusal("Rod.mas=5"), "no parameter 'Rod.mas'; did you mean 'Rod.mass'?");
  EXPECT_EQ(refusal("Rot.mass=5"), "no parameter 'Rot.mass'; did you mean 'Rod.mass'?");
  EXPECT_EQ(refusal("Rod=5"), "'Rod' alone is no parameter; expected one of its own, such as Rod.mass");
  EXPECT_EQ(refusal("pressure=5 bar").find("no parameter 'pressure'; expected Element.key, such as "), 0U)
      << refusal("pressure=5 bar");
  EXPECT_EQ(refusal("mechanics.gravity=[0, 0, 0]"),
            "mechanics.gravity is three numbers, which change one by one; expected mechanics.gravity.x, "
            "mechanics.gravity.y or mechanics.gravity.z");
  EXPECT_EQ(refusal("session.step=2 ms"),
            "session.step cannot be changed while the session runs; start it again with --set session.step=VALUE");
  EXPECT_EQ(refusal("Rod.mass=-1 kg"), "Rod.mass: -1 kg is out of range; expected more than 0 kg");
  EXPECT_EQ(refusal("Rod.mass=5 m"),
            "Rod.mass: '5 m' is a length; expected a mass such as '500 kg', or a bare number in kg");
  EXPECT_EQ(refusal("Rod.mass=.nan"), "Rod.mass: '.nan' is not finite; expected a finite number");
  EXPECT_EQ(
      refusal("Rod.relative_to=Ground"),
      "Rod.relative_to takes the name of a body and cannot be changed while the session runs; start it again with "
      "--set Rod.relative_to=VALUE");
  EXPECT_EQ(refusal("Rod.mass"),
            "'Rod.mass' is not an assignment; expected Element.key=value, such as 'Bag.mass=1500kg'");
}

TEST(ParametersOfAJoint, ThatAreNotPartOfTheMechanismAreRefusedNamingWhy) {
  const ParameterDirectory bare(load_text(kPendulum, "test"));
  EXPECT_EQ(bare.find("Hinge.viscous_friction")->change, Change::restart);
  EXPECT_EQ(
      bare.check("Hinge.viscous_friction", 5).status.text,
      "Hinge.viscous_friction would change nothing: the scene gives the joint neither friction nor limits, so none "
      "is computed; start it again with --set Hinge.viscous_friction=VALUE");
  EXPECT_EQ(bare.check("Hinge.limit_damping", 5).status.text,
            "Hinge.limit_damping would change nothing: the joint has no limits; start it again with --set "
            "Hinge.limit_max=VALUE");

  // with one of them there is a row, and all its constants can change; without limits those of the limits cannot
  const ParameterDirectory rubbing(load_text(kPendulum, "test", {"Hinge.coulomb_friction=1 N m"}));
  EXPECT_TRUE(rubbing.check("Hinge.viscous_friction", 5).status.is_ok());
  EXPECT_FALSE(rubbing.check("Hinge.limit_damping", 5).status.is_ok());
  const ParameterDirectory limited(load_text(kPendulum, "test", {"Hinge.limit_max=1 rad", "Hinge.limit_stiffness=10"}));
  EXPECT_TRUE(limited.check("Hinge.limit_damping", 5).status.is_ok());
  EXPECT_TRUE(limited.check("Hinge.coulomb_friction", 5).status.is_ok());
}

TEST(ParametersOfARope, AreLiveWhereTheyAreItsOwn) {
  const ParameterDirectory rope(load_text(R"(
bodies: {Load: {mass: 1 kg, inertia: [1, 1, 1]}}
joints: {Free: {type: floating, body2: Load}}
forces:
  Rope: {type: rope, bodies: [Ground, Load], points: [[0, 2 m, 0], [0, 0, 0]], free_length: 2 m, axial_rigidity: 1 kN}
)",
                                          "test"));
  EXPECT_TRUE(rope.check("Rope.axial_rigidity", 5).status.is_ok());
  EXPECT_TRUE(rope.check("Rope.free_length", 1).status.is_ok());
  EXPECT_EQ(rope.check("Rope.stiffness", 5).status.text,
            "Rope.stiffness would change nothing: the rope has its spring by axial_rigidity");
}

constexpr const char* kCylinder = SLEWRING_SOURCE_DIR "/scenes/single_cylinder.yaml";

// rk4 at 1 ms follows a damper of 2785 Ns/m on 1 kg and a spring of 8e6 N/m, not one with 1.187 times in each step
TEST(ParametersOfAForce, ThatWouldGrowInASubStepAreRefused) {
  const Scene scene = load_text(R"(session: {step: 1 ms}
bodies:
  B: {position: [1 m, 0, 0], mass: 1 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  J: {type: prismatic, orientation1: [0, 90 deg, 0], body2: B, orientation2: [0, 90 deg, 0]}
forces:
  Damper: {type: translational, body1: Ground, body2: B, free_length: 1 m, damping_constant: 1 Ns/m}
  Rope: {type: rope, bodies: [Ground, B], points: [[0, 0, 0], [0, 0, 0]], free_length: 4 m, axial_rigidity: 16 MN}
)",
                                "live.yaml");
  const ParameterDirectory directory(scene);
  EXPECT_TRUE(directory.check("Damper.damping_constant", 500).status.is_ok());
  EXPECT_NE(directory.check("Damper.damping_constant", 2900).status.text.find("too fast for rk4"), std::string::npos);
  EXPECT_TRUE(directory.check("Rope.free_length", 3).status.is_ok());
  EXPECT_NE(directory.check("Rope.free_length", 1.5).status.text.find("too fast for rk4"), std::string::npos);
}

TEST(ParameterOfChoices, IsListedWithItsNamesAndTakesOneOfThem) {
  const Scene scene = load_file(kCylinder);
  ParameterDirectory directory(scene);
  const ParameterInfo* level = directory.find("session.coupling");
  ASSERT_NE(level, nullptr);
  EXPECT_EQ(level->change, Change::live);
  EXPECT_EQ(level->choice_of(level->value), "two");
  EXPECT_EQ(level->choice_of(0.5), "");
  const Assignment assignment = directory.parse_assignment("Cyl_Lift.coupling = linear");
  ASSERT_FALSE(assignment.status.is_ok());  // the path has a blank
  const Assignment chosen = directory.parse_assignment("Cyl_Lift.coupling= linear");
  EXPECT_TRUE(chosen.status.is_ok()) << chosen.status.text;
  EXPECT_EQ(chosen.value, 2);
  EXPECT_EQ(chosen.over.ns, 0);
}

TEST(ParameterOfChoices, IsRefusedWhatItIsNot) {
  ParameterDirectory directory(load_file(kCylinder));
  const auto refusal = [&](const char* text) { return directory.parse_assignment(text).status.text; };
  EXPECT_EQ(
      refusal("Cyl_Lift.coupling=liner"),
      "Cyl_Lift.coupling: 'liner' is none of its choices; expected session, hold, linear, two or tlm; did you mean "
      "'linear'?");
  EXPECT_EQ(refusal("session.coupling=2"),
            "session.coupling: '2' is none of its choices; expected hold, linear, two or tlm");
  EXPECT_EQ(refusal("session.pace=free"),
            "session.pace takes real or free and cannot be changed while the session runs; start it again with --set "
            "session.pace=VALUE");
  EXPECT_EQ(directory.check("session.coupling", 4).status.text,
            "session.coupling: 4 is none of its choices; expected hold, linear, two or tlm");
  EXPECT_EQ(directory.check("session.coupling", 1, milliseconds(10)).status.text,
            "session.coupling is a choice and changes at once; leave out the time to spread it over");
  EXPECT_TRUE(directory.check("session.coupling", 1, SimDuration{}).status.is_ok());
}

TEST(ParameterOfChoices, OfLevelTlmNeverReachesAMotor) {
  const std::string file = SLEWRING_SOURCE_DIR "/scenes/slewing_upper.yaml";
  ParameterDirectory directory(load_file(file));
  EXPECT_EQ(directory.parse_assignment("session.coupling=tlm").status.text,
            "session.coupling: Motor_Slew: level tlm is not for motors: the oil of one step is a large part of the "
            "motor's own");
  EXPECT_TRUE(directory.parse_assignment("session.coupling=hold").status.is_ok());
  EXPECT_TRUE(directory.parse_assignment("Motor_Slew.coupling=session").status.is_ok());
  // the motor has a level of its own in a session of tlm, and cannot give it up
  const std::vector<std::string> of_tlm = {"session.coupling=tlm", "Motor_Slew.coupling=two"};
  ParameterDirectory waves(load_file(file, of_tlm));
  EXPECT_FALSE(waves.parse_assignment("Motor_Slew.coupling=session").status.is_ok());
  EXPECT_TRUE(waves.parse_assignment("Motor_Slew.coupling=hold").status.is_ok());
}

// the waves between two lines on one volume grow at any step: refused at load and as a live change
TEST(ParameterOfChoices, OfLevelTlmNeverReachesCylindersThatShareAVolume) {
  constexpr const char* kChambers =
      ", port_b: B, piston_diameter: 60 mm, rod_diameter: 35 mm, piston_length: 0, chamber_length: 900 mm, "
      "rod_length: 950 mm, minimum_stroke: 20 mm, maximum_stroke: 880 mm}\n";
  const auto text = [&](const char* volume) {
    return std::string(R"(
bodies:
  L: {position: [0, 1.4, 0], mass: 700, inertia: [1, 1, 1]}
  R: {position: [1, 1.4, 0], mass: 700, inertia: [1, 1, 1]}
joints:
  JL: {type: prismatic, body2: L, point1: [0, 1.4, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}
  JR: {type: prismatic, body2: R, point1: [1, 1.4, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}
forces:
  FL: {type: translational, body1: Ground, body2: L}
  FR: {type: translational, body1: Ground, point1: [1, 0, 0], body2: R}
volumes:
  A: {rigid_volume: 0.4 l}
  Other: {rigid_volume: 0.4 l}
  B: {fixed: true}
components:
)") + "  CL: {type: double_acting_cylinder, force: FL, port_a: A" +
           kChambers + "  CR: {type: double_acting_cylinder, force: FR, port_a: " + volume + kChambers;
  };
  const std::string shared = text("A");
  const char* const why =
      "level tlm is not for cylinders that share a volume: the waves between their lines grow at any step";
  EXPECT_NE(problems_of(shared, {"session.coupling=tlm"}).find(why), std::string::npos);
  EXPECT_NE(problems_of(shared, {"CR.coupling=tlm"}).find(why), std::string::npos);
  ParameterDirectory directory(load_text(shared, "test"));
  EXPECT_EQ(directory.parse_assignment("CL.coupling=tlm").status.text, std::string("CL.coupling: CL: ") + why);
  EXPECT_FALSE(directory.parse_assignment("session.coupling=tlm").status.is_ok());
  EXPECT_TRUE(directory.parse_assignment("session.coupling=hold").status.is_ok());
  // by the script
  for (const std::string name : {"session", "CL"}) {
    const std::string script = "script: {parameters: [{at: 1 s, set: " + name + ".coupling, value: tlm}]}\n";
    EXPECT_NE(problems_of(shared + script).find("script.parameters[0].value: " + name + ".coupling: CL: " + why),
              std::string::npos);
    EXPECT_EQ(problems_of(text("Other") + script), "");
  }
  // a fixed volume has no lines
  EXPECT_EQ(problems_of(text("Other"), {"session.coupling=tlm"}), "");
}

TEST_F(Parameters, OfACouplingThatIsNotThereIsRefused) {
  EXPECT_EQ(directory.check("session.coupling", 1).status.text,
            "session.coupling would change nothing: the scene has no cylinder that is coupled");
}

TEST(ParameterOfChoices, IsTheSameInTheCanonicalText) {
  const std::string text = R"(
script:
  parameters:
    - {at: 1 s, set: Cyl_Lift.coupling, value: tlm}
    - {at: 2 s, set: session.coupling, value: hold, over: 0}
)";
  const Scene crane = load_file(kCylinder);
  const Scene scene = load_text(crane.expanded_text.substr(0, crane.expanded_text.find("script:")) + text, "test");
  ASSERT_EQ(scene.script.changes.size(), 2u);
  EXPECT_EQ(scene.script.changes[0].choice, "tlm");
  EXPECT_EQ(scene.script.changes[0].value, 4);
  EXPECT_EQ(scene.script.changes[1].value, 0);
  const Scene again = load_text(scene.expanded_text, "test");
  EXPECT_EQ(again.expanded_text, scene.expanded_text);
  EXPECT_EQ(again.script.changes[0].choice, "tlm");
}

TEST_F(Parameters, AValueFromTheWireIsCheckedInTheSameWay) {
  EXPECT_TRUE(directory.check("Rod.mass", 3).status.is_ok());
  EXPECT_FALSE(directory.check("Rod.mass", 0).status.is_ok());
  EXPECT_FALSE(directory.check("Rod.mass", std::numeric_limits<double>::quiet_NaN()).status.is_ok());
  EXPECT_FALSE(directory.check("Rod.mass", std::numeric_limits<double>::infinity()).status.is_ok());
  EXPECT_EQ(directory.check("Rod.mass", 0).status.code, ExitCode::bad_input);
}

}  // namespace parameters_test
}  // namespace slew::scene
