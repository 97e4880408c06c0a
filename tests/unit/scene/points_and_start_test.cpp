// SPDX-License-Identifier: Apache-2.0
// Named points are the lists that they stand for; a start by joint coordinates is the pose that trigonometry gives.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "multibody/model/model.h"
#include "multibody/model/topology.h"
#include "multibody/results/observe.h"
#include "scene/scene.h"
#include "scene_text.h"

namespace slew::scene {
namespace points_and_start_test {

constexpr double kDegree = std::numbers::pi / 180;

std::string expanded(const std::string& text) {
  return load_text(text, "test").expanded_text;
}

// ---- named points

std::string boom(const std::string& points, const std::string& joints, const std::string& more) {
  return "bodies:\n  Boom: {mass: 10 kg, center_of_mass: [1 m, 0, 0], inertia: [1, 9, 9]" + points +
         "}\n  Load: {mass: 5 kg, inertia: [1, 1, 1], " + more + "}\njoints:\n" + joints;
}

TEST(Points, StandWhereAPointOfTheirBodyIsWanted) {
  const std::string points =
      ", points: {tip: [2 m, 0.1 m, 0], eye: {position: [0, 0, 0], orientation: [0, 90 deg, 0]}}";
  const std::string named =
      boom(points,
           "  Foot: {type: revolute, body1: Ground, frame2: Boom.eye, orientation1: [0, 90 deg, 0]}\n"
           "  Tip: {type: spherical, point1: Boom.tip, body2: Load}\n"
           "forces:\n  Stay: {type: translational, body1: Ground, point1: [0, 3 m, 0], "
           "point2: Boom.tip}\n"
           "  Line: {type: rope, bodies: [Boom, Ground], points: [Boom.tip, [0, 5 m, 0]], free_length: 1 m, stiffness: "
           "1 kN/m}\n"
           "  Push: {type: point_force, point: Boom.tip, direction: [0, 1, 0]}\n"
           "dummies:\n  Lamp: {type: static, position: Boom.tip, mass: 1 kg}\n",
           "position: Boom.tip");
  const std::string listed =
      boom("",
           "  Foot: {type: revolute, body1: Ground, body2: Boom, orientation2: [0, 90 deg, 0], orientation1: [0, 90 "
           "deg, 0]}\n"
           "  Tip: {type: spherical, body1: Boom, point1: [2 m, 0.1 m, 0], body2: Load}\n"
           "forces:\n  Stay: {type: translational, body1: Ground, point1: [0, 3 m, 0], body2: Boom, "
           "point2: [2 m, 0.1 m, 0]}\n"
           "  Line: {type: rope, bodies: [Boom, Ground], points: [[2 m, 0.1 m, 0], [0, 5 m, 0]], free_length: 1 m, "
           "stiffness: 1 kN/m}\n"
           "  Push: {type: point_force, body: Boom, point: [2 m, 0.1 m, 0], direction: [0, 1, 0]}\n"
           "dummies:\n  Lamp: {type: static, relative_to: Boom, position: [2 m, 0.1 m, 0], mass: 1 kg}\n",
           "relative_to: Boom, position: [2 m, 0.1 m, 0]");
  EXPECT_EQ(expanded(named), expanded(listed));
}

TEST(Points, OfGroundAndThroughParametersAndGroups) {
  const std::string scene = R"(parameters: {where: Ground.post}
groups:
  Swing:
    parameters: {at: }
    bodies:
      Rod: {mass: 1 kg, inertia: [1, 1, 1], position: ${at}, points: {end: [1 m, 0, 0]}}
      Bob: {mass: 1 kg, inertia: [1, 1, 1], position: Rod.end}
    joints:
      Hinge: {type: revolute, point1: ${at}, body2: Rod}
      Ball: {type: spherical, point1: Rod.end, body2: Bob}
instances:
  A: {group: Swing, parameters: {at: "${where}"}}
bodies:
  Ground: {points: {post: [0, 2 m, 0]}}
)";
  const Scene loaded = load_text(scene, "test");
  EXPECT_EQ(loaded.mechanics.joints.at(0).body1, "Ground");
  EXPECT_EQ(loaded.mechanics.joints.at(0).point1, (Triple{0, 2, 0}));
  EXPECT_EQ(loaded.mechanics.joints.at(1).body1, "A_Rod");
  EXPECT_EQ(loaded.mechanics.bodies.at(1).relative_to, "A_Rod");
}

TEST(Points, FaultsHaveTheirPlace) {
  const auto problem = [](const std::string& points, const std::string& joint) {
    return problems_of("bodies:\n  Boom: {mass: 10 kg, inertia: [1, 9, 9], points: " + points +
                       "}\njoints:\n  Foot: " + joint + "\n");
  };
  const std::string tip = "{tip: [2 m, 0, 0]}";
  EXPECT_EQ(problem(tip, "{type: revolute, body1: Ground, point2: Boom.tpi}"),
            "test:4:49: Foot.point2: there is no point 'Boom.tpi'; did you mean 'Boom.tip'?");
  EXPECT_EQ(
      problem(tip, "{type: revolute, body1: Ground, point1: Boom.tip, body2: Boom}"),
      "test:4:49: Foot.point1: the point is on 'Boom', the body beside it is 'Ground'; expected a point of that body, "
      "or no body");
  EXPECT_EQ(
      problem("{tip: [2 m, 0]}", "{type: revolute, body2: Boom}"),
      "test:2:57: Boom.points.tip: is no point; expected [x, y, z], or {position: [x, y, z], orientation: [a, b, c]}");
  EXPECT_EQ(problem("[tip]", "{type: revolute, body2: Boom}"),
            "test:2:51: Boom.points: is a list; expected a map of points by name");
  EXPECT_EQ(problem("{t p: [2 m, 0, 0]}", "{type: revolute, body2: Boom}"),
            "test:2:52: Boom.points.t p: is not a name; expected letters, digits and _, beginning with a letter");
  EXPECT_EQ(problem(tip, "{type: revolute, frame1: Boom.tip, point1: [0, 0, 0], body2: Boom}"),
            "test:4:26: Foot.frame1: 'point1' is given as well; expected one of them");
  EXPECT_EQ(problem("{tip: {position: [2 m, 0, 0], turn: 3}}", "{type: revolute, body2: Boom}"),
            "test:2:81: Boom.points.tip.turn: unknown key; expected position or orientation");
  // the unit of a point is checked where it is used
  EXPECT_EQ(problem("{tip: [2 kg, 0, 0]}", "{type: revolute, body1: Ground, point2: Boom.tip}"),
            "test:2:58: Foot.point2: '2 kg' is a mass; expected a length such as '1.5 m', or a bare number in m");
}

// ---- start

// angle of a body about Ground's z
double angle_of(const Scene& scene, const std::string& body) {
  Problems none;
  const auto poses = multibody::start_poses(scene.mechanics, none);
  const auto& R = poses[static_cast<std::size_t>(multibody::find_body(scene.mechanics, body))].R;
  return std::atan2(R(1, 0), R(0, 0));
}

TEST(Start, PutsAJointOfATreeAndWhatItCarries) {
  const std::string chain = kPendulum +
                            "  Elbow: {type: revolute, body1: Rod, point1: [1 m, 0, 0], body2: Arm}\n"
                            "  Slide: {type: prismatic, body1: Arm, point1: [1 m, 0, 0], orientation1: [0, 90 deg, 0], "
                            "body2: Tube, orientation2: [0, 90 deg, 0]}\n";
  const std::string bodies =
      "  Arm: {relative_to: Rod, position: [1 m, 0, 0], mass: 1 kg, inertia: [1, 1, 1]}\n"
      "  Tube: {relative_to: Arm, position: [1 m, 0, 0], mass: 1 kg, inertia: [1, 1, 1]}\n";
  std::string text = chain;
  text.insert(text.find("joints:"), bodies);
  const Scene scene = load_text(text + "start: {Hinge: 40 deg, Slide: 0.25 m}\n", "test");
  EXPECT_NEAR(angle_of(scene, "Rod"), 40 * kDegree, 1e-15);
  EXPECT_NEAR(angle_of(scene, "Arm"), 40 * kDegree, 1e-15);
  // what does not move relative to its neighbour keeps its numbers
  EXPECT_EQ(scene.mechanics.bodies.at(1).position, (Triple{1, 0, 0}));
  EXPECT_EQ(scene.mechanics.bodies.at(1).orientation, (Triple{0, 0, 0}));
  EXPECT_NEAR(scene.mechanics.bodies.at(2).position[0], 1.25, 1e-15);
  EXPECT_EQ(load_text(scene.expanded_text, "test").expanded_text, scene.expanded_text);
  // from the command line as well, and instead of the file's
  EXPECT_NEAR(angle_of(load_text(text, "test", {"start.Hinge=40 deg"}), "Rod"), 40 * kDegree, 1e-15);
}

// Crank a, coupler b, rocker c, ground d. The rocker's angle by Freudenstein's equation (1955):
//   c cos(t4) (2 d - 2 a cos t2) ... solved as the intersection of two circles
struct FourBar {
  double a = 1, b = 3, c = 2.5, d = 3;
  // angle of the rocker for the crank's, open configuration
  [[nodiscard]] double rocker(double crank) const {
    const double x = d - a * std::cos(crank), y = -a * std::sin(crank);
    const double s = std::hypot(x, y), cosine = (c * c + s * s - b * b) / (2 * c * s);
    return std::atan2(-y, -x) - std::acos(cosine);
  }
  [[nodiscard]] double coupler(double crank) const {
    const double t4 = rocker(crank);
    return std::atan2(c * std::sin(t4) - a * std::sin(crank), d + c * std::cos(t4) - a * std::cos(crank));
  }
};

std::string four_bar(const std::string& start, double error = 0) {
  const FourBar bar;
  const double crank = 60 * kDegree, t3 = bar.coupler(crank) + error, t4 = bar.rocker(crank);
  const auto number = [](double value) { return std::to_string(value); };
  return "bodies:\n  Crank: {orientation: [60 deg, 0, 0], mass: 1 kg, inertia: [1, 1, 1]}\n"
         "  Coupler: {relative_to: Ground, position: [" +
         number(bar.a * std::cos(crank)) + ", " + number(bar.a * std::sin(crank)) + ", 0], orientation: [" +
         number(t3) + ", 0, 0], mass: 2 kg, inertia: [1, 1, 1]}\n  Rocker: {position: [3 m, 0, 0], orientation: [" +
         number(t4) +
         ", 0, 0], mass: 1 kg, inertia: [1, 1, 1]}\n"
         "joints:\n  A: {type: revolute, body2: Crank}\n"
         "  B: {type: revolute, body1: Crank, point1: [1 m, 0, 0], body2: Coupler}\n"
         "  C: {type: revolute, body1: Coupler, point1: [3 m, 0, 0], body2: Rocker, point2: [2.5 m, 0, 0]}\n"
         "  D: {type: revolute, point1: [3 m, 0, 0], body2: Rocker}\n" +
         start;
}

// the loader closes loops as the start of a session does
constexpr double kClosedWithin = 1e-6;

TEST(Start, ClosesALoopOnTheBranchOfThePoses) {
  const FourBar bar;
  for (const double degrees : {20.0, 60.0, 100.0, 150.0, -40.0}) {
    const Scene scene = load_text(four_bar("start: {A: " + std::to_string(degrees) + " deg}\n"), "test");
    const double crank = degrees * kDegree;
    EXPECT_NEAR(angle_of(scene, "Crank"), crank, kClosedWithin) << degrees;
    EXPECT_NEAR(std::remainder(angle_of(scene, "Coupler") - bar.coupler(crank), 2 * std::numbers::pi), 0, kClosedWithin)
        << degrees;
    EXPECT_NEAR(std::remainder(angle_of(scene, "Rocker") - bar.rocker(crank), 2 * std::numbers::pi), 0, kClosedWithin)
        << degrees;
  }
}

TEST(Start, ClosesALoopFromRoughPosesAndFromTheOtherSide) {
  const FourBar bar;
  // the poses have the coupler 0.02 rad off, 0.06 m at its end
  EXPECT_NE(problems_of(four_bar("", 0.02)), "");
  const Scene rough = load_text(four_bar("start: {A: 80 deg}\n", 0.02), "test");
  EXPECT_NEAR(angle_of(rough, "Rocker"), bar.rocker(80 * kDegree), kClosedWithin);
  // the rocker's joint leads instead of the crank's
  const Scene driven =
      load_text(four_bar("start: {D: " + std::to_string(bar.rocker(90 * kDegree)) + " rad}\n"), "test");
  EXPECT_NEAR(angle_of(driven, "Crank"), 90 * kDegree, 1e-5);  // six decimals in the text
}

TEST(Start, FaultsHaveTheirPlace) {
  EXPECT_EQ(problems_of(kPendulum + "start: {Hnge: 40 deg}\n"),
            "test:5:9: start.Hnge: no joint 'Hnge'; did you mean 'Hinge'?");
  EXPECT_EQ(
      problems_of(kPendulum + "start: {Hinge: 40 mm}\n"),
      "test:5:16: start.Hinge: '40 mm' is a length; expected an angle such as '37.5 deg', or a bare number in rad");
  EXPECT_EQ(problems_of(kPendulum + "start: [Hinge]\n"),
            "test:5:8: start: is a list; expected a map, such as {Boom_Hinge: 40 deg}");
  std::string ball = kPendulum;
  ball.replace(ball.find("revolute"), 8, "spherical");
  EXPECT_EQ(
      problems_of(ball + "start: {Hinge: 40 deg}\n"),
      "test:5:9: start.Hinge: the joint has no coordinates; expected a revolute, prismatic, cylindrical or universal "
      "joint");
}

TEST(Start, ALoopThatCannotCloseIsRefused) {
  // a rocker of 2.5 m on a coupler of 3 m does not reach beyond 5.5 m
  const std::string problem = problems_of(four_bar("start: {D: 0 deg}\n"));
  EXPECT_NE(problem.find("start: the mechanism cannot be closed with these coordinates: '"), std::string::npos)
      << problem;
  const std::string both = problems_of(four_bar("start: {A: 80 deg, D: 2.2 rad}\n"));
  EXPECT_NE(both.find("cannot be closed with these coordinates"), std::string::npos) << both;
}

// ---- payload

// coordinate of a joint as gears, limits, springs and outputs read it
double coordinate_of(const Scene& scene, const std::string& joint) {
  const multibody::Model model = multibody::build_model(scene.mechanics);
  const multibody::Joint& found = model.joints.at(static_cast<std::size_t>(multibody::find_joint(model, joint)));
  return model.start_q.at(static_cast<std::size_t>(model.links.at(static_cast<std::size_t>(found.link)).q));
}

const std::string kTwoWheels = R"(
bodies:
  A: {mass: 1, inertia: [1, 1, 1]}
  B: {mass: 1, inertia: [1, 1, 1], position: [1 m, 0, 0]}
joints:
  J1: {type: revolute, body2: A}
  J2: {type: revolute, point1: [1 m, 0, 0], body2: B}
gears:
  G: {type: gear, joint1: J1, joint2: J2, ratio: 0.5, offset: 0 deg}
)";

TEST(Start, BeyondHalfATurnTurnsWhatIsGearedToIt) {
  const Scene half = load_text(kTwoWheels + "start: {J1: 200 deg}\n", "test");
  EXPECT_NEAR(coordinate_of(half, "J1"), 200 * kDegree, 1e-12);
  EXPECT_NEAR(coordinate_of(half, "J2"), 100 * kDegree, 1e-9);
  EXPECT_NEAR(angle_of(half, "B"), 100 * kDegree, 1e-9);
  // the turns belong to the scene that sessions publish
  EXPECT_NEAR(coordinate_of(load_text(half.expanded_text, "test"), "J2"), 100 * kDegree, 1e-9);
  // from either end, and over many turns
  const Scene back = load_text(kTwoWheels + "start: {J2: -500 deg}\n", "test");
  EXPECT_NEAR(coordinate_of(back, "J2"), -500 * kDegree, 1e-12);
  EXPECT_NEAR(coordinate_of(back, "J1"), -1000 * kDegree, 1e-9);
  EXPECT_NEAR(coordinate_of(load_text(kTwoWheels + "start: {J1: 7300 deg}\n", "test"), "J2"), 3650 * kDegree, 1e-9);
}

// a drum of 0.15 m turned three times lowers its load by 3 2 pi 0.15 m
TEST(Start, OfADrumOverWholeTurnsMovesItsLoad) {
  const Scene scene = load_text(R"(
start: {Axle: 1080 deg}
bodies:
  Drum: {mass: 80 kg, inertia: [1, 1, 0.9], position: [0, 5 m, 0]}
  Load: {mass: 100 kg, inertia: [1, 1, 1], position: [0.15 m, 2 m, 0]}
joints:
  Axle: {type: revolute, point1: [0, 5 m, 0], body2: Drum}
  Guide: {type: prismatic, point1: [0.15 m, 5 m, 0], orientation1: [90 deg, 0, 0], body2: Load, orientation2: [90 deg, 0, 0]}
gears:
  Rope: {type: rack_and_pinion, joint1: Axle, joint2: Guide, radius: 150 mm, offset: 3 m}
)",
                                "test");
  EXPECT_NEAR(coordinate_of(scene, "Axle"), 1080 * kDegree, 1e-9);
  EXPECT_NEAR(coordinate_of(scene, "Guide"), 3 + 0.15 * 1080 * kDegree, 1e-9);
  EXPECT_NEAR(scene.mechanics.bodies.at(1).position[1], 5 - (3 + 0.15 * 1080 * kDegree), 1e-9);
}

TEST(Start, BeyondHalfATurnIsWithinTheLimitsThatHoldIt) {
  const std::string text = R"(
bodies:
  A: {mass: 1, inertia: [1, 1, 1]}
joints:
  J1: {type: revolute, body2: A, limit_min: 200 deg, limit_max: 300 deg, limit_stiffness: 1e5 Nm/rad}
forces:
  Twist: {type: rotational, body1: Ground, f1: [1, 0, 0], g1: [0, 1, 0], body2: A, f2: [1, 0, 0], spring_constant: 1 Nm/rad}
)";
  const Scene scene = load_text(text + "start: {J1: 260 deg}\n", "test");
  EXPECT_NEAR(coordinate_of(scene, "J1"), 260 * kDegree, 1e-12);
  // the spring's angle is the coordinate
  const multibody::Model model = multibody::build_model(scene.mechanics);
  multibody::Workspace ws(model);
  multibody::observe(model, multibody::start_state(model), ws);
  EXPECT_NEAR(ws.angles.at(0).angle, 260 * kDegree, 1e-12);
  EXPECT_NE(problems_of(text + "start: {J1: -100 deg}\n").find("outside of its limits"), std::string::npos);
}

TEST(Payload, IsAListThatSessionsCarry) {
  const Scene one = load_text(kPendulum + "payload: Rod\n", "test");
  EXPECT_EQ(one.mechanics.payload, "Rod");
  EXPECT_EQ(one.expanded_text, expanded(kPendulum + "mechanics: {payload: Rod}\n"));
  std::string two_text = kPendulum + "  Other: {type: revolute, body2: Bob}\npayload: [Bob, Rod]\n";
  two_text.insert(two_text.find("joints:"), "  Bob: {mass: 1 kg, center_of_mass: [1 m, 0, 0], inertia: [1, 1, 1]}\n");
  const Scene two = load_text(two_text, "test");
  EXPECT_EQ(two.mechanics.payload, "Bob");
  EXPECT_EQ(two.other_payloads, std::vector<std::string>{"Rod"});
  EXPECT_EQ(expanded(two.expanded_text), two.expanded_text);
}

TEST(Payload, FaultsHaveTheirPlace) {
  EXPECT_EQ(problems_of(kPendulum + "payload: [Rod, Bag]\n"), "test:5:16: payload: no body 'Bag'");
  EXPECT_EQ(problems_of(kPendulum + "payload: [Rod, Rod]\n"),
            "test:5:1: payload: 'Rod' is named twice; expected each body once");
  EXPECT_EQ(problems_of(kPendulum + "payload: {a: 1}\n"),
            "test:5:10: payload: is a map; expected a list of names of bodies");
}

}  // namespace points_and_start_test
}  // namespace slew::scene
