// SPDX-License-Identifier: Apache-2.0
// Every rule of validate(): the path and the first words of the message.
#include "multibody/build/validate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include "multibody/formulations/integrators.h"
#include "multibody/model/field_tables.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace validate_test {

// a hinge, a ball and a strut with a cylinder: sound
MechanicsDef sound() {
  MechanicsDef def;
  def.bodies = {{.name = "Arm", .mass = 2, .center_of_mass = {0.5, 0, 0}, .inertia = {0.1, 1, 1}},
                {.name = "Load", .relative_to = "Arm", .position = {1, 0, 0}, .mass = 5, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Hinge", .body2 = "Arm"},
                {.name = "Ball", .type = JointType::spherical, .body1 = "Arm", .point1 = {1, 0, 0}, .body2 = "Load"}};
  def.translational_forces = {
      {.name = "Strut", .body1 = "Ground", .point1 = {0, -1, 0}, .body2 = "Arm", .point2 = {0.5, 0, 0}}};
  def.rotational_forces = {{.name = "Damper", .body1 = "Arm", .body2 = "Load"}};
  def.force_dummies = {
      {.name = "Tube", .relative_to = "Strut", .mass = 3, .center_of_mass = {-0.3, 0, 0}, .inertia = {0.01, 0.2, 0.2}}};
  def.static_dummies = {{.name = "Box", .relative_to = "Arm", .mass = 1, .inertia = {1, 1, 1}}};
  return def;
}

Problems problems_of(const std::function<void(MechanicsDef&)>& change) {
  MechanicsDef def = sound();
  change(def);
  Problems problems;
  validate(def, problems);
  return problems;
}

void expect_problem(const std::function<void(MechanicsDef&)>& change, const std::string& path,
                    const std::string& what) {
  const Problems problems = problems_of(change);
  const bool is_found = std::any_of(problems.begin(), problems.end(), [&](const Problem& problem) {
    return problem.path == path && problem.what.find(what) != std::string::npos;
  });
  EXPECT_TRUE(is_found) << "expected " << path << ": " << what << "\ngot " << testing::text_of(problems);
}

TEST(Validate, FindsNothingInASoundMechanism) {
  EXPECT_EQ(testing::text_of(problems_of([](MechanicsDef&) {})), "");
  Problems problems;
  validate(testing::crane_def(), problems);
  EXPECT_EQ(testing::text_of(problems), "");
}

TEST(Validate, TakesEveryFormulation) {
  for (const Formulation formulation :
       {Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty}) {
    EXPECT_EQ(testing::text_of(problems_of([&](auto& d) { d.formulation = formulation; })), "");
  }
}

TEST(Validate, NamesTheLongestStepThatAPenaltyAllows) {
  // a double root at -omega: the Runge-Kutta method of order 4 is stable to 2.785 on the negative axis
  expect_problem([](auto& d) { d.formulation = Formulation::penalty, d.penalty_frequency = 3000; },
                 "mechanics.penalty_frequency",
                 "3000 rad/s with penalty_damping 1 is unstable in sub-steps of 0.001 s");
  const Problems problems =
      problems_of([](auto& d) { d.formulation = Formulation::penalty, d.penalty_frequency = 3000; });
  EXPECT_EQ(problems[0].expected, "at most 2780 rad/s, or max_substep of at most 0.000928 s");
  // the recursion has no such limit, and the longest step of a scene is stable at the default frequency
  EXPECT_EQ(testing::text_of(problems_of([](auto& d) { d.penalty_frequency = 3000; })), "");
  EXPECT_EQ(testing::text_of(problems_of([](auto& d) { d.formulation = Formulation::penalty, d.max_substep = 20e-3; })),
            "");
}

TEST(Validate, NamesIntegratorsThatAFormulationDoesNotHave) {
  expect_problem(
      [](auto& d) {
        d.formulation = Formulation::penalty;
        d.integrator = Integrator::sdirk2;
      },
      "mechanics.integrator", "the formulation 'penalty' has no integrator 'sdirk2'");
  expect_problem(
      [](auto& d) {
        d.formulation = Formulation::augmented;
        d.integrator = Integrator::rk4;
      },
      "mechanics.integrator", "the formulation 'augmented' has no integrator 'rk4'");
  for (const Formulation formulation :
       {Formulation::recursive, Formulation::lagrange, Formulation::augmented, Formulation::penalty}) {
    const auto with = [formulation](Integrator integrator) {
      return testing::text_of(problems_of([&](auto& d) { d.formulation = formulation, d.integrator = integrator; }));
    };
    EXPECT_EQ(with(Integrator::own), "");
    for (const Integrator integrator : integrators_of(formulation)) EXPECT_EQ(with(integrator), "");
  }
  const std::string refusal = testing::text_of(problems_of([](auto& d) {
    d.formulation = Formulation::augmented;
    d.integrator = Integrator::sdirk2;
  }));
  EXPECT_NE(refusal.find("expected index3_trapezoidal or own"), std::string::npos) << refusal;
}

TEST(Validate, NamesDanglingBodies) {
  expect_problem([](auto& d) { d.bodies[1].relative_to = "Army"; }, "Load.relative_to", "there is no body 'Army'");
  expect_problem([](auto& d) { d.joints[1].body2 = "Bag"; }, "Ball.body2", "there is no body 'Bag'");
  expect_problem([](auto& d) { d.translational_forces[0].body1 = ""; }, "Strut.body1", "there is no body ''");
  expect_problem([](auto& d) { d.rotational_forces[0].body2 = "X"; }, "Damper.body2", "there is no body 'X'");
  expect_problem([](auto& d) { d.static_dummies[0].relative_to = "X"; }, "Box.relative_to", "there is no body 'X'");
  expect_problem([](auto& d) { d.force_dummies[0].relative_to = "X"; }, "Tube.relative_to",
                 "no translational force 'X'");
}

TEST(Validate, NamesAJointOfABodyWithItself) {
  expect_problem([](auto& d) { d.joints[1].body1 = "Load"; }, "Ball.body2", "both bodies are 'Load'");
}

TEST(Validate, NamesNamesThatAreTaken) {
  expect_problem([](auto& d) { d.joints[1].name = "Arm"; }, "Arm", "is taken");
  expect_problem([](auto& d) { d.bodies[0].name = "Ground"; }, "Ground", "is taken");
}

TEST(Validate, NamesALoopThatCannotClose) {
  const auto doubled = [](double point2) {
    return [point2](auto& d) {
      d.joints.push_back({.name = "Second", .point1 = {0, 0, 1}, .body2 = "Arm", .point2 = {0, 0, point2}});
    };
  };
  EXPECT_EQ(testing::text_of(problems_of(doubled(1))), "");
  expect_problem(doubled(1.0005), "Second", "cannot be closed: position along z is off by 0.0005");
  expect_problem(doubled(1.1), "Second.point2", "0.1 m apart");
}

TEST(Validate, NamesSpeedsThatALoopDoesNotAllow) {
  const auto doubled = [](double first, double second) {
    return [=](auto& d) {
      d.joints[0].initial_velocity = first;
      d.joints.push_back({.name = "Slide", .type = JointType::prismatic, .body2 = "Load", .initial_velocity = second});
      d.joints[2].point1 = {1, 0, 0};
    };
  };
  EXPECT_EQ(testing::text_of(problems_of(doubled(0, 0))), "");
  expect_problem(doubled(1, 1), "Slide.initial_velocity",
                 "the loops do not allow 1; with the other speeds given it is 0");
}

TEST(Validate, NamesBodiesWithoutAWayToGround) {
  expect_problem([](auto& d) { d.joints.pop_back(); }, "Load", "this body has no joint");
  expect_problem([](auto& d) { d.joints.erase(d.joints.begin()); }, "Arm", "no chain of joints leads");
}

TEST(Validate, NamesACycleOfReferences) {
  expect_problem([](auto& d) { d.bodies[0].relative_to = "Load"; }, "Arm.relative_to", "does not end");
}

TEST(Validate, WantsFloatingJointsToStartFromGround) {
  expect_problem([](auto& d) { d.joints[1].type = JointType::floating; }, "Ball.body1",
                 "floating joint starts from 'Arm'");
}

TEST(Validate, WantsMassesAndInertiaOfRealBodies) {
  expect_problem([](auto& d) { d.bodies[0].mass = 0; }, "Arm.mass", "0 kg is out of range");
  expect_problem([](auto& d) { d.bodies[0].mass = -1; }, "Arm.mass", "-1 kg is out of range");
  expect_problem([](auto& d) { d.bodies[0].mass = std::nan(""); }, "Arm.mass", "out of range");
  expect_problem([](auto& d) { d.bodies[0].inertia[1] = -1; }, "Arm.inertia", "out of range");
  expect_problem([](auto& d) { d.bodies[1].inertia = {1, 1, 2.1}; }, "Load.inertia", "break the triangle rule");
  expect_problem([](auto& d) { d.bodies[1].products = {1.5, 0, 0}; }, "Load.inertia", "is not positive");
  expect_problem([](auto& d) { d.static_dummies[0].inertia = {1, 1, 3}; }, "Box.inertia", "break the triangle rule");
}

TEST(Validate, SeesTheWrongSignOfPrintedProducts) {
  // the pillar with the CAD program's +60.25 instead of the tensor's element
  MechanicsDef def = testing::crane_def();
  def.bodies[0].products[0] = 60.25371;
  Problems problems;
  validate(def, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].path, "Truck_Pillar.inertia");
  EXPECT_NE(problems[0].what.find("(taken to the centre of mass) is not positive"), std::string::npos);
}

TEST(Validate, WarnsOfTheInertiaPrintedForTheJibBoom) {
  Problems warnings;
  find_unlikely_inertia(testing::crane_def(), warnings);
  find_unlikely_inertia(sound(), warnings);
  EXPECT_EQ(testing::text_of(warnings), "");
  // a body of that tensor could exist: 128 kg with a radius of gyration of 13 m, on a boom of 6.5 m
  MechanicsDef def = testing::crane_def();
  def.bodies[3].inertia = {53.61867, 21713.77286, 21682.20193};
  def.bodies[3].products = {167.73081, 784.03676, -7.506971};
  Problems problems;
  validate(def, problems);
  EXPECT_EQ(testing::text_of(problems), "");
  find_unlikely_inertia(def, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].path, "Truck_JibBoom.inertia");
  EXPECT_NE(warnings[0].what.find("the radius of gyration is 13 m"), std::string::npos) << warnings[0].what;
}

TEST(RotationalForce, BesideTheAxisOfItsHingeIsNamedWithBothAxesAndDirectionsThatFit) {
  const auto warnings_of = [](const RotationalForceDef& force, Triple orientation1 = {}, Triple orientation2 = {}) {
    MechanicsDef def = sound();
    def.joints[0].orientation1 = orientation1;
    def.joints[0].orientation2 = orientation2;
    def.rotational_forces = {force};
    Problems warnings;
    find_axes_beside_hinges(def, warnings);
    return warnings;
  };
  RotationalForceDef spring = {.name = "Spring", .body1 = "Ground", .body2 = "Arm"};
  const Problems idle = warnings_of(spring);
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_EQ(idle[0].path, "Spring");
  EXPECT_EQ(
      idle[0].what,
      "its axis f1 x g1 is [0, 1, 0] in 'Ground', and its bodies turn against each other about [0, 0, 1], the axis "
      "of 'Hinge': it carries no torque about that");
  EXPECT_EQ(idle[0].expected, "f1: [1, 0, 0], g1: [0, 1, 0], f2: [1, 0, 0], whose angle is that of the joint");
  spring.f1 = {1, 0, 0}, spring.g1 = {0, 1, 0}, spring.f2 = {1, 0, 0};
  EXPECT_TRUE(warnings_of(spring).empty());
  // half a right angle beside it
  const Problems aslant = warnings_of(spring, {0.7853981633974483, 0, 0});
  ASSERT_EQ(aslant.size(), 1u);
  EXPECT_NE(aslant[0].what.find("about [0, -0.707107, 0.707107]"), std::string::npos) << aslant[0].what;
  EXPECT_NE(aslant[0].what.find("its angle is not that of the joint"), std::string::npos);
  // about the same axis against its direction, and with the bodies in the other order
  spring.f1 = {0, 1, 0}, spring.g1 = {1, 0, 0};
  EXPECT_TRUE(warnings_of(spring).empty());
  std::swap(spring.body1, spring.body2);
  EXPECT_TRUE(warnings_of(spring).empty());
  EXPECT_EQ(warnings_of(spring, {}, {1.5707963267948966, 0, 0}).size(), 1u);
  // between bodies without a hinge: the damper across the ball
  EXPECT_TRUE(warnings_of(sound().rotational_forces[0]).empty());
}

TEST(PointOnABodyWithModes, BetweenTwoNodesIsNamedWithItsDistance) {
  auto modes = std::make_shared<ModalBody>();
  modes->C.resize(1);
  for (int i = 0; i < 4; ++i) modes->nodes.push_back({.id = i + 1, .position = math::Vec3(i, 0, 0)});
  const auto warnings_of = [&](Triple point, const std::string& body = "Arm") {
    MechanicsDef def = sound();
    def.joints.pop_back();
    def.translational_forces.clear();
    def.flexible_bodies = {{.body = "Arm", .modes = modes}};
    def.point_forces = {{.name = "Load", .body = body, .point = point}};
    Problems warnings;
    find_points_between_nodes(def, warnings);
    return warnings;
  };
  const Problems found = warnings_of({1.4, 0, 0});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "Load");
  EXPECT_NE(found[0].what.find("the point lies 0.4 m from the nearest node of 'Arm' towards another one, and the body "
                               "bends as if it held on to that node, 2"),
            std::string::npos)
      << found[0].what;
  EXPECT_NE(found[0].expected.find("a node within 0.15 m"), std::string::npos) << found[0].expected;
  EXPECT_EQ(warnings_of({1.6, -0.2, 0}).size(), 1u);
  EXPECT_TRUE(warnings_of({1.02, 0, 0}).empty());   // below 5 % of 3 m
  EXPECT_TRUE(warnings_of({2, 0.5, 0.3}).empty());  // a lug beside a node
  EXPECT_TRUE(warnings_of({3.5, 0, 0}).empty());    // an arm that goes on from the end
  EXPECT_TRUE(warnings_of({1.4, 0, 0}, "Ground").empty());
  modes->C.clear();  // all modes left out
  EXPECT_TRUE(warnings_of({1.4, 0, 0}).empty());
}

// rk4 looks at a table at the ends and the middle of a sub-step only
TEST(ShortPulse, IsNamedWithTheSubStepThatSuits) {
  MechanicsDef def = sound();
  const auto warnings_of = [&def](Table table) {
    def.point_forces = {{.name = "Blow", .body = def.bodies[0].name, .force_table = std::move(table)}};
    Problems warnings;
    find_short_pulses(def, 1e-3, warnings);
    return warnings;
  };
  const Problems found = warnings_of({{0, 0}, {0.1, 0}, {0.1002, 5000}, {0.1003, 5000}, {0.1004, 0}, {1, 0}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "Blow.force_table");
  EXPECT_NE(found[0].expected.find("mechanics.max_substep of at most 0.0002 s"), std::string::npos)
      << found[0].expected;
  // 0.198 ms: rounded up it would be warned of again
  const Problems shorter = warnings_of({{0, 0}, {0.1, 0}, {0.1002, 5000}, {0.100396, 0}, {1, 0}});
  ASSERT_EQ(shorter.size(), 1u);
  EXPECT_NE(shorter[0].expected.find("of at most 0.00019 s"), std::string::npos) << shorter[0].expected;
  EXPECT_EQ(warnings_of({{0, 0}, {0.1, 0}, {0.1004, -5000}, {0.1008, 0}}).size(), 1u);
  // a pulse of two sub-steps is right, and so is a jump: its error is a part of a sub-step
  EXPECT_TRUE(warnings_of({{0, 0}, {0.1, 0}, {0.101, 5000}, {0.102, 0}}).empty());
  EXPECT_TRUE(warnings_of({{0, 0}, {0.1, 0}, {0.1001, 5000}, {1, 5000}}).empty());
  EXPECT_TRUE(warnings_of({{0, 0}, {0.1, 0}, {0.1001, 5000}, {1, 5000}, {1.0001, 0}}).empty());
}

// the share of the load decides, at its peak too; all of a small load is a blow
TEST(ShortPulse, OfABillionthOfTheLoadIsNone) {
  MechanicsDef def = sound();
  const auto warning_count = [&def](Table table) {
    def.point_torques = {{.name = "Blow", .body = def.bodies[0].name, .torque_table = std::move(table)}};
    Problems warnings;
    find_short_pulses(def, 1e-3, warnings);
    return warnings.size();
  };
  EXPECT_EQ(warning_count({{0, 1000}, {0.1, 1000}, {0.1001, 1000 + 1e-6}, {0.1002, 1000}, {1, 1000}}), 0u);
  EXPECT_EQ(warning_count({{0, 0}, {0.1, 0}, {0.1001, 1e-6}, {0.1002, 0}, {1, -1000}}), 0u);
  EXPECT_EQ(warning_count({{0, 0}, {0.1, 0}, {0.1001, 1e-6}, {0.1002, 0}, {1, 0}}), 1u);
  // a bump within a blow does not hide it, nor does one at its foot
  EXPECT_EQ(warning_count({{0, 0}, {0.1, 0}, {0.1001, 5000}, {0.1002, 4999.999}, {0.1003, 5000}, {0.1004, 0}}), 1u);
  EXPECT_EQ(warning_count({{0, 1e-6}, {0.1, 0}, {0.1001, 5000}, {0.1002, 0}, {0.1003, 1e-6}, {1, 0}}), 1u);
  // steps of less than the share each
  Table steep = {{0, 0}, {0.1, 0}};
  for (int k = 1; k <= 4000; ++k) steep.push_back({0.1 + 1e-7 * k, k <= 2000 ? k : 4000.0 - k});
  EXPECT_EQ(warning_count(steep), 1u);
}

TEST(FastMotion, BeyondThePartsOfASubStepIsNamedWithTheSubStepThatSuits) {
  MechanicsDef def = sound();
  const auto warnings_of = [&def](double frequency) {
    def.motions = {{.name = "Shake",
                    .shape = MotionShape::harmonic,
                    .joint = def.joints[0].name,
                    .amplitude = 1e-3,
                    .frequency = frequency}};
    Problems warnings;
    find_fast_motions(def, 1e-3, warnings);
    return warnings;
  };
  // 10 parts a period of rk4, 64 parts of a sub-step
  EXPECT_TRUE(warnings_of(6300).empty());
  const Problems found = warnings_of(6500);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "Shake");
  EXPECT_NE(found[0].expected.find("mechanics.max_substep of at most 0.0005 s"), std::string::npos)
      << found[0].expected;
}

TEST(Overshoot, OfAJumpInATableIsNamed) {
  MechanicsDef def = sound();
  const auto warnings_of = [&def](Table points) {
    def.motions = {{.name = "Way", .joint = def.joints[0].name, .points = std::move(points)}};
    Problems warnings;
    find_overshoots(def, warnings);
    return warnings;
  };
  const Problems found = warnings_of({{0, 0}, {0.1, 0}, {0.101, 0.1}, {0.2, 0.1}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, "Way.points");
  EXPECT_NE(found[0].what.find("it overshoots beside a jump"), std::string::npos) << found[0].what;
  // an even change, and a sine whose peaks lie between the points
  EXPECT_TRUE(warnings_of({{0, 0}, {0.1, 0}, {0.2, 0.1}, {0.3, 0.1}}).empty());
  Table sine;
  for (int k = 0; k <= 40; ++k) sine.push_back({0.05 * k, std::sin(3.3 * k * 0.05 * 3)});
  EXPECT_TRUE(warnings_of(sine).empty());
}

TEST(Validate, NamesPartsThatNothingKeepsFromSpinning) {
  expect_problem([](auto& d) { d.bodies[1].inertia = {}; }, "Ball", "has no inertia about one of its free directions");
  expect_problem(
      [](auto& d) {
        d.bodies[0].inertia = d.bodies[0].center_of_mass = {};
        d.joints.pop_back();
        d.bodies.pop_back();
        d.rotational_forces.clear();
        d.static_dummies.clear();
        d.force_dummies.clear();
      },
      "Hinge", "has no inertia about one of its free directions");
}

TEST(Validate, WantsJointFramesToAgreeAtTheStart) {
  expect_problem([](auto& d) { d.joints[1].point1[1] = 2e-3; }, "Ball.point2", "0.002 m apart");
  expect_problem([](auto& d) { d.joints[0].orientation2[0] = 0.01; }, "Hinge.orientation2", "axes are 0.01 rad apart");
  const auto slider = [](auto& d) { d.joints[0].type = JointType::prismatic; };
  EXPECT_EQ(testing::text_of(problems_of(slider)), "");
  expect_problem([&](auto& d) { slider(d), d.joints[0].point2[0] = 0.1; }, "Hinge.point2",
                 "0.1 m apart at the start across");
  expect_problem([&](auto& d) { slider(d), d.joints[0].orientation2[2] = 0.1; }, "Hinge.orientation2",
                 "frames are turned 0.1 rad");
  expect_problem([](auto& d) { d.joints[0].type = JointType::fixed, d.joints[0].orientation2[2] = 0.1; },
                 "Hinge.orientation2", "frames are turned 0.1 rad");
}

TEST(Validate, NamesSwappedLimits) {
  expect_problem([](auto& d) { d.joints[0].first.limit_min = 1, d.joints[0].first.limit_max = -1; }, "Hinge.limit_min",
                 "not below the upper limit");
  expect_problem([](auto& d) { d.joints[0].first.limit_min = -1; }, "Hinge.limit_stiffness", "no stiffness");
  expect_problem([](auto& d) { d.translational_forces[0].min_length = 2, d.translational_forces[0].max_length = 1; },
                 "Strut.min_length", "not below the largest");
  expect_problem([](auto& d) { d.rotational_forces[0].min_angle = 2, d.rotational_forces[0].max_angle = 1; },
                 "Damper.min_angle", "not below the largest");
  // all zero, as the thesis prints for forces that a cylinder overrides: no end dampers
  EXPECT_EQ(testing::text_of(problems_of([](auto& d) { d.translational_forces[0].max_length = 0; })), "");
}

TEST(Validate, WantsJointsToStartInsideTheirLimits) {
  const auto limits = [](double min, double max) {
    return [=](MechanicsDef& d) {
      d.joints[0].first.limit_min = min, d.joints[0].first.limit_max = max, d.joints[0].first.limit_stiffness = 1e4;
    };
  };
  EXPECT_EQ(testing::text_of(problems_of(limits(-1, 1))), "");
  EXPECT_EQ(testing::text_of(problems_of(limits(0, 1))), "");
  expect_problem(limits(0.1, 1), "Hinge.limit_min", "the joint starts at 0 rad, outside of its limits");
  expect_problem(limits(-1, -0.1), "Hinge.limit_max", "the joint starts at 0 rad, outside of its limits");
  const auto slider = [&](MechanicsDef& d) {
    limits(0.1, 1)(d);
    d.joints[0].type = JointType::prismatic;
  };
  expect_problem(slider, "Hinge.limit_min", "the joint starts at 0 m, outside of its limits");
}

TEST(Validate, WantsDirectionsAtRightAngles) {
  expect_problem([](auto& d) { d.rotational_forces[0].g1 = {1, 0, 1}; }, "Damper.g1", "enclose 45 deg");
  expect_problem([](auto& d) { d.rotational_forces[0].f2 = {}; }, "Damper.f2", "the direction is zero");
}

TEST(Validate, WantsTheForcesPointsApart) {
  expect_problem([](auto& d) { d.translational_forces[0].point1 = {0.5, 0, 0}; }, "Strut.point2", "coincide");
}

TEST(Validate, WantsDummiesOnTheLineOfForce) {
  expect_problem([](auto& d) { d.force_dummies[0].center_of_mass[1] = 0.1; }, "Tube.center_of_mass", "off the line");
  expect_problem(
      [](auto& d) {
        d.force_dummies[0].inertia = {0.01, 0.2, 0.3};
      },
      "Tube.inertia", "differ by more than 1 %");
  expect_problem([](auto& d) { d.force_dummies[0].inertia = {1, 0.2, 0.2}; }, "Tube.inertia", "triangle rule");
  expect_problem([](auto& d) { d.force_dummies[0].index = 3; }, "Tube.index", "out of range");
}

TEST(Validate, RefusesDummiesAcrossMoreThanOneJoint) {
  expect_problem([](auto& d) { d.translational_forces[0].body2 = "Load"; }, "Tube.relative_to",
                 "more than one joint connects");
  // a fixed joint does not count
  EXPECT_EQ(testing::text_of(problems_of([](auto& d) {
              d.translational_forces[0].body2 = "Load";
              d.joints[1].type = JointType::fixed;
            })),
            "");
}

// an arm that bends, with one mode and nodes at its root and at 0.5 and 1 m
FlexibleBodyDef bending(const std::string& name) {
  auto modes = std::make_shared<ModalBody>();
  modes->mass = 2;
  modes->first_moment = math::Vec3(1, 0, 0);
  modes->second_moment = math::Mat3::diagonal(2, 0.1, 0.1);
  modes->mass_matrix = {1};
  modes->stiffness = {1e4};
  modes->C = {math::Vec3(0, 1, 0)};
  modes->Z.resize(1);
  modes->Y.resize(1);
  const std::vector<math::Vec3> zero(1);
  modes->nodes = {{1, math::Vec3(), zero, zero, {}},
                  {2, math::Vec3(0.5, 0, 0), {math::Vec3(0, 0.5, 0)}, zero, {}},
                  {3, math::Vec3(1, 0, 0), {math::Vec3(0, 1, 0)}, zero, {}}};
  modes->root = 0;
  return {.body = name, .modes = modes, .start = {0}};
}

TEST(Validate, TakesDummiesAtNodesButForThoseThatCoupleModesOfTwoBodies) {
  const auto bend = [](MechanicsDef& d) {
    d.bodies[0].type = BodyType::flexible;
    d.flexible_bodies = {bending("Arm")};
  };
  EXPECT_EQ(testing::text_of(problems_of(bend)), "");
  // from a node to what hangs at another
  EXPECT_EQ(testing::text_of(problems_of([&](auto& d) {
              bend(d);
              d.translational_forces[0].body1 = "Load";
            })),
            "");
  // a second arm, fixed to the first one's root; the load hangs at a node of the first
  const auto two = [&](MechanicsDef& d) {
    bend(d);
    d.bodies.push_back({.name = "Twin", .type = BodyType::flexible, .relative_to = "Arm"});
    d.flexible_bodies.push_back(bending("Twin"));
    d.joints.push_back({.name = "Weld", .type = JointType::fixed, .body1 = "Arm", .body2 = "Twin"});
    d.translational_forces[0] = {
        .name = "Strut", .body1 = "Twin", .point1 = {0.5, 0, 0}, .body2 = "Load", .point2 = {0, 1, 0}};
  };
  expect_problem(two, "Tube.relative_to", "nodes of two flexible bodies");
  expect_problem(
      [&](auto& d) {
        two(d);
        d.translational_forces[0].body2 = "Arm";
        d.translational_forces[0].point2 = {1, 0, 0};
      },
      "Tube.relative_to", "nodes of two flexible bodies");
}

TEST(Validate, WantsUnitsOfSenseInTheSection) {
  expect_problem([](auto& d) { d.max_substep = 0; }, "mechanics.max_substep", "out of range");
  expect_problem([](auto& d) { d.gravity[1] = std::numeric_limits<double>::infinity(); }, "mechanics.gravity",
                 "out of range");
  expect_problem([](auto& d) { d.penalty_factor = 10; }, "mechanics.penalty_factor", "out of range");
  expect_problem([](auto& d) { d.penalty_damping = 0; }, "mechanics.penalty_damping", "out of range");
  expect_problem([](auto& d) { d.penalty_frequency = 0; }, "mechanics.penalty_frequency", "out of range");
}

TEST(ValidateRows, NamesWhatCannotBeActedOn) {
  const MechanicsDef def = sound();
  const auto problem_with = [&](const std::vector<std::string>& rows) {
    Problems problems;
    validate_rows(def, rows, problems);
    return testing::text_of(problems);
  };
  EXPECT_EQ(problem_with({"Strut", "Damper", "Hinge"}), "");
  EXPECT_NE(problem_with({"Ball"}).find("no force and no joint with one coordinate"), std::string::npos);
  EXPECT_EQ(problem_with(std::vector<std::string>(100, "Strut")), "") << "any number";
}

// every number's range: a value outside is named by its key
TEST(FieldTables, RangesAreChecked) {
  for (std::size_t s = 0; s < sections().size(); ++s) {
    for (const ElementType& type : sections()[s].types) {
      for (const Field& row : type.fields) {
        if (row.type != FieldType::number) continue;
        MechanicsDef def;
        void* element = type.append(def, "X");
        *static_cast<double*>(row.member(element)) = std::nan("");
        Problems problems;
        validate(def, problems);
        const bool is_named = std::any_of(problems.begin(), problems.end(), [&](const Problem& problem) {
          return problem.path == "X." + std::string(row.key) && problem.what.find("out of range") != std::string::npos;
        });
        EXPECT_TRUE(is_named) << type.name << " " << row.key;
      }
    }
  }
}

TEST(FieldTables, AppendGivesANamedDefOfTheSection) {
  MechanicsDef def;
  for (const Section& section : sections()) {
    for (const ElementType& type : section.types) EXPECT_NE(type.append(def, std::string(type.name)), nullptr);
  }
  ASSERT_EQ(def.bodies.size(), 3u);
  EXPECT_EQ(def.bodies[1].type, BodyType::flexible);
  EXPECT_EQ(def.bodies[2].type, BodyType::segmented);
  ASSERT_EQ(def.joints.size(), 13u);
  EXPECT_EQ(def.joints[1].name, "prismatic");
  EXPECT_EQ(def.joints[1].type, JointType::prismatic);
  EXPECT_EQ(def.translational_forces.at(0).name, "translational");
  EXPECT_EQ(def.rotational_forces.at(0).name, "rotational");
  EXPECT_EQ(def.force_dummies.size(), 1u);
  EXPECT_EQ(def.static_dummies.size(), 1u);
}

TEST(FieldTables, KeysAreUniqueAndDocumented) {
  for (const Section& section : sections()) {
    for (const ElementType& type : section.types) {
      for (std::size_t i = 0; i < type.fields.size(); ++i) {
        EXPECT_FALSE(type.fields[i].doc.empty()) << type.fields[i].key;
        for (std::size_t k = 0; k < i; ++k) EXPECT_NE(type.fields[i].key, type.fields[k].key);
      }
    }
  }
}

}  // namespace validate_test
}  // namespace slew::multibody
