// SPDX-License-Identifier: Apache-2.0
// Gears against closed forms, under every formulation and integrator.
//
// Geared pendulums, q_2 = r q_1: (J_1 + r^2 J_2) q_1'' = -G_1 sin q_1 - r G_2 sin q_2, J about the pivot, G = m g l;
// their speed from the energy. Rack that falls and turns its pinion: x'' = g / (1 + J/(m R^2)). Telescope whose second
// stage goes out with the first, up against gravity: (m_1 + 4 m_2) q'' = F - (m_1 + 2 m_2) g.
// Tolerances: the gear's ratio 1e-9 (penalty: F/(alpha omega^2)), motion by the order of the rule.
#include <cmath>
#include <tuple>

#include "multibody/constraints/gear.h"
#include "multibody/formulations/integrators.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace gear_test {

using testing::Formulated;
using testing::Mechanism;
using testing::name_of;
using testing::text_of;

constexpr double kGravity = 9.81;
constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented,
                                         Formulation::penalty};

GearDef gear(GearKind kind, const std::string& joint1, const std::string& joint2, double ratio) {
  return {.name = "Gear", .kind = kind, .joint1 = joint1, .joint2 = joint2, .ratio = ratio};
}

struct Pendulum {
  double mass, arm, inertia;  // kg, m, kg m2 about the centre
  [[nodiscard]] double J() const { return inertia + mass * arm * arm; }
  [[nodiscard]] double G() const { return mass * kGravity * arm; }
};
constexpr Pendulum kFirst{2, 0.4, 0.05}, kSecond{0.7, 0.3, 0.02};
constexpr double kRatio = -2.5;

BodyDef rod(const std::string& name, const Pendulum& p, double x) {
  return {.name = name,
          .position = {x, 0, 0},
          .mass = p.mass,
          .center_of_mass = {0, -p.arm, 0},
          .inertia = {p.inertia, p.inertia, p.inertia}};
}

// hang side by side along -y; the first turns with speed w
MechanicsDef geared_pendulums(double w, double ratio = kRatio) {
  MechanicsDef def;
  def.bodies = {rod("First", kFirst, 0), rod("Second", kSecond, 1)};
  def.joints = {{.name = "Pivot1", .body2 = "First", .initial_velocity = w},
                {.name = "Pivot2", .point1 = {1, 0, 0}, .body2 = "Second"}};
  def.gears = {gear(GearKind::gear, "Pivot1", "Pivot2", ratio)};
  return def;
}

// from the energy at the bottom
double speed_at(double q, double w) {
  const double J = kFirst.J() + kRatio * kRatio * kSecond.J();
  const double climbed = kFirst.G() * (1 - std::cos(q)) + kSecond.G() * (1 - std::cos(kRatio * q));
  return std::sqrt(w * w - 2 * climbed / J);
}

using Choice = std::tuple<Formulation, Integrator>;
std::vector<Choice> every_choice() {
  std::vector<Choice> choices;
  for (const Formulation formulation : kFormulations) {
    for (const Integrator integrator : integrators_of(formulation)) choices.emplace_back(formulation, integrator);
  }
  return choices;
}

class Geared : public ::testing::TestWithParam<Choice> {
 protected:
  [[nodiscard]] static Formulation formulation() { return std::get<0>(GetParam()); }
  [[nodiscard]] static Integrator rule() { return std::get<1>(GetParam()); }
  [[nodiscard]] static Formulated start(MechanicsDef def) {
    def.formulation = formulation();
    def.integrator = rule();
    return Formulated(def);
  }
  // tolerance of coordinates held by a gear
  [[nodiscard]] static double held() { return formulation() == Formulation::penalty ? 1e-6 : 1e-9; }
  // of motion at 1 ms: of fourth, second and first order
  [[nodiscard]] static double followed() {
    if (rule() == Integrator::semi_implicit_euler) return 3e-2;
    if (formulation() == Formulation::penalty) return 1e-5;
    return rule() == Integrator::rk4 ? 1e-8 : 2e-4;
  }
};

TEST_P(Geared, PendulumsSwingAsOneAndOverTheTop) {
  // the first goes over the top again and again, the second 2.5 times as often
  constexpr double w = 12;
  Formulated pendulums = start(geared_pendulums(w));
  for (int i = 0; i < 10; ++i) {
    pendulums.run(0.1, 1e-3);
    const double q1 = pendulums.value("Pivot1.position"), q2 = pendulums.value("Pivot2.position");
    ASSERT_NEAR(q2, kRatio * q1, held());
    ASSERT_NEAR(pendulums.value("Pivot1.velocity"), speed_at(q1, w), followed() * w);
  }
  EXPECT_GT(pendulums.value("Pivot1.position"), 2 * M_PI);
  EXPECT_LT(pendulums.value("Pivot2.position"), -4 * M_PI);
}

TEST_P(Geared, RackFallsAsItsPinionLetsIt) {
  constexpr double R = 0.1, m = 3, J = 0.02, time = 1;
  MechanicsDef def;
  const Triple along_y = {-M_PI / 2, 0, 0};
  def.bodies = {{.name = "Pinion", .mass = 1, .inertia = {J, J, J}},
                {.name = "Rack", .position = {R, 0, 0}, .mass = m, .inertia = {0.1, 0.1, 0.1}}};
  def.joints = {{.name = "Axle", .body2 = "Pinion"},
                {.name = "Guide",
                 .type = JointType::prismatic,
                 .point1 = {R, 0, 0},
                 .orientation1 = along_y,
                 .body2 = "Rack",
                 .orientation2 = along_y}};
  def.gears = {gear(GearKind::rack_and_pinion, "Axle", "Guide", R)};
  Formulated rack = start(def);
  rack.run(time, 1e-3);
  const double a = -kGravity / (1 + J / (m * R * R)), x = a * time * time / 2;
  // each rule is exact for a constant acceleration, but for semi-implicit Euler, which is half a step ahead
  const double early = rule() == Integrator::semi_implicit_euler ? a * time * 0.5e-3 : 0;
  const double tolerance = formulation() == Formulation::penalty ? 1e-5 : 1e-8;
  EXPECT_NEAR(rack.value("Guide.position"), x + early, tolerance);
  EXPECT_NEAR(rack.value("Axle.position"), (x + early) / R, 10 * tolerance);  // more than four turns
}

INSTANTIATE_TEST_SUITE_P(Choices, Geared, ::testing::ValuesIn(every_choice()), [](const auto& tested) {
  return name_of(std::get<0>(tested.param)) + "_" + std::to_string(static_cast<int>(std::get<1>(tested.param)));
});

class GearedForces : public ::testing::TestWithParam<Formulation> {
 protected:
  [[nodiscard]] static double tolerance() { return GetParam() == Formulation::penalty ? 1e-5 : 1e-9; }
};

std::vector<double> reaction_values(Formulated& m, const std::vector<double>& row_forces) {
  std::vector<JointReaction> reactions(m.model.joints.size());
  joint_reactions(m.model, m.state, m.ws, row_forces, reactions);
  std::vector<double> values(reaction_variables(m.model).size());
  read_reactions(m.model, m.ws, row_forces, reactions, values);
  return values;
}

double reaction_value(Formulated& m, const std::string& name, const std::vector<double>& row_forces = {}) {
  const std::vector<double> values = reaction_values(m, row_forces);
  const std::vector<ElementVariable> names = reaction_variables(m.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

// the second stage slides on the first
MechanicsDef telescope() {
  MechanicsDef def;
  const Triple along_y = {-M_PI / 2, 0, 0};
  def.bodies = {{.name = "Stage1", .mass = 30, .inertia = {1, 1, 1}},
                {.name = "Stage2", .mass = 20, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Slide1",
                 .type = JointType::prismatic,
                 .orientation1 = along_y,
                 .body2 = "Stage1",
                 .orientation2 = along_y,
                 .first = {.viscous_friction = 1}},
                {.name = "Slide2",
                 .type = JointType::prismatic,
                 .body1 = "Stage1",
                 .orientation1 = along_y,
                 .body2 = "Stage2",
                 .orientation2 = along_y}};
  def.gears = {gear(GearKind::slides, "Slide1", "Slide2", 1)};
  return def;
}

TEST_P(GearedForces, OfATelescopeCarryWhatGoesOutWithIt) {
  MechanicsDef def = telescope();
  def.formulation = GetParam();
  Formulated stages(def, {"Slide1"});
  constexpr double F = 900, m1 = 30, m2 = 20;
  const double a = (F - (m1 + 2 * m2) * kGravity) / (m1 + 4 * m2);
  stages.dynamics.evaluate(stages.model, stages.state, stages.ws);
  // values at the port
  EXPECT_NEAR(row_mobility(stages.ws)[0], 1 / (m1 + 4 * m2), tolerance() / (m1 + 4 * m2));
  EXPECT_NEAR(row_free_accelerations(stages.ws)[0], -(m1 + 2 * m2) * kGravity / (m1 + 4 * m2), tolerance());
  stages.run(0.3, 1e-3, {F});
  EXPECT_NEAR(stages.value("Slide1.position"), a * 0.045, tolerance());
  EXPECT_NEAR(stages.value("Slide2.position"), a * 0.045, tolerance());
  // F_2 = m2 (2 a + g), and the same down on the first slide
  EXPECT_NEAR(reaction_value(stages, "Gear.force_2", {F}), m2 * (2 * a + kGravity), 1e-9 * F);
  EXPECT_NEAR(reaction_value(stages, "Gear.force_1", {F}), -m2 * (2 * a + kGravity), 1e-9 * F);
}

TEST_P(GearedForces, OfADrivenPinionAreThoseOfItsLoad) {
  MechanicsDef def = geared_pendulums(0);
  def.gravity = {};
  def.joints[0].initial_velocity = kNotGiven;
  def.motions = {
      {.name = "Motor", .shape = MotionShape::harmonic, .joint = "Pivot1", .amplitude = 0.4, .frequency = 1}};
  def.formulation = GetParam();
  Formulated driven(def);
  driven.run(0.2, 1e-3);
  const double omega = 2 * M_PI, p = 0.4 * std::sin(omega * 0.2), p_rate = -omega * omega * p;
  EXPECT_NEAR(driven.value("Pivot2.position"), kRatio * p, GetParam() == Formulation::penalty ? 1e-6 : 1e-9);
  const double load = kRatio * kSecond.J() * p_rate;
  EXPECT_NEAR(reaction_value(driven, "Gear.torque_2"), load, 1e-6);
  EXPECT_NEAR(reaction_value(driven, "Gear.torque_1"), -kRatio * load, 1e-5);
  EXPECT_NEAR(reaction_value(driven, "Motor.torque"), (kFirst.J() + kRatio * kRatio * kSecond.J()) * p_rate, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Formulations, GearedForces, ::testing::ValuesIn(kFormulations),
                         [](const auto& tested) { return name_of(tested.param); });

// ---- start and rules ------------------------------------------------------------------------------------------------

std::string problems_of(const MechanicsDef& def) {
  Problems problems;
  validate(def, problems);
  return text_of(problems);
}

TEST(GearStart, SpeedsFollowTheOneThatIsGiven) {
  Mechanism pendulums(geared_pendulums(3));
  EXPECT_NEAR(pendulums.value("Pivot2.velocity"), 3 * kRatio, 1e-12);
}

TEST(GearStart, SpeedsThatTheRatioDoesNotAllowAreRefused) {
  MechanicsDef def = geared_pendulums(3);
  def.joints[1].initial_velocity = 3;
  EXPECT_NE(problems_of(def).find("the loops do not allow"), std::string::npos) << problems_of(def);
}

TEST(GearStart, FitsAnOffsetUpToWholeTurns) {
  MechanicsDef def = geared_pendulums(0);
  def.gears[0].offset = 4 * M_PI;
  Mechanism pendulums(def);
  EXPECT_NEAR(pendulums.value("Pivot2.position"), 0, 1e-12);
  def.gears[0].offset = 0.5;
  EXPECT_EQ(
      problems_of(def),
      "Gear.offset: the poses have 'Pivot2' at 0 rad, the gear at 0.5 rad; expected poses that fit the gear within "
      "0.001 rad (mechanics.assembly_tolerance), or no offset\n");
}

TEST(GearStart, MovesBodiesThatMissItByLessThanTheTolerance) {
  MechanicsDef def = geared_pendulums(0);
  def.gears[0].offset = 4e-4;
  Mechanism pendulums(def);
  const double q1 = pendulums.value("Pivot1.position"), q2 = pendulums.value("Pivot2.position");
  EXPECT_NEAR(q2, kRatio * q1 + 4e-4, 1e-12);
  EXPECT_NE(q1, 0);
}

TEST(GearRules, TakeJointsWithOneCoordinateOnly) {
  MechanicsDef def = geared_pendulums(0);
  def.joints[1].type = JointType::universal;
  def.joints[1].orientation2 = {M_PI / 2, 0, 0};
  EXPECT_NE(problems_of(def).find("Gear.joint2: the joint 'Pivot2' is universal; expected a revolute joint"),
            std::string::npos)
      << problems_of(def);
  def = geared_pendulums(0);
  def.gears[0].kind = GearKind::slides;
  EXPECT_NE(problems_of(def).find("Gear.joint1: the joint 'Pivot1' is revolute; expected a prismatic joint"),
            std::string::npos)
      << problems_of(def);
  def = geared_pendulums(0);
  def.gears[0].joint2 = "Pivot1";
  EXPECT_NE(problems_of(def).find("Gear.joint2: both joints are 'Pivot1'"), std::string::npos) << problems_of(def);
  def.gears[0].joint2 = "Pivot3";
  EXPECT_NE(problems_of(def).find("Gear.joint2: there is no joint 'Pivot3'"), std::string::npos) << problems_of(def);
}

TEST(GearRules, RefuseTwoMotionsOfOneChain) {
  MechanicsDef def = geared_pendulums(0);
  def.joints[0].initial_velocity = kNotGiven;
  for (const char* joint : {"Pivot1", "Pivot2"}) {
    def.motions.push_back({.name = std::string(joint) + "_Motor", .shape = MotionShape::speed, .joint = joint});
  }
  EXPECT_NE(problems_of(def).find("Gear: the prescribed motions hold both joints of this gear already"),
            std::string::npos)
      << problems_of(def);
}

TEST(GearRules, LeaveOutAGearThatOthersImply) {
  MechanicsDef def = geared_pendulums(5);
  GearDef back = gear(GearKind::gear, "Pivot2", "Pivot1", 1 / kRatio);
  back.name = "Back";
  def.gears.push_back(back);
  Mechanism pendulums(def);
  ASSERT_EQ(pendulums.model.gears.size(), 1U);
  ASSERT_EQ(pendulums.model.idle_gears.size(), 1U);
  EXPECT_EQ(pendulums.model.idle_gears[0].name, "Back");
  EXPECT_EQ(pendulums.model.degrees_of_freedom(), 1);
  Problems warnings;
  find_start_changes(def, warnings);
  ASSERT_EQ(warnings.size(), 1U) << text_of(warnings);
  EXPECT_EQ(warnings[0].path, "Back");
}

// Pendulums on axes in a row, geared in pairs.
struct Train {
  struct Pair {
    int joint1, joint2;
    double ratio;
  };
  MechanicsDef def;
  explicit Train(int joints, const std::vector<Pair>& pairs) {
    for (int i = 0; i < joints; ++i) {
      const std::string number = std::to_string(i);
      // the inertias differ by a factor of 1e6, as those of a motor and of what it moves
      const double size = std::pow(1e3, i % 3);
      def.bodies.push_back(rod("Rod" + number, {2 * size, 0.4, 0.05 * size}, i));
      def.joints.push_back({.name = "Axis" + number, .point1 = {1.0 * i, 0, 0}, .body2 = "Rod" + number});
    }
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      def.gears.push_back(gear(GearKind::gear, "Axis" + std::to_string(pairs[k].joint1),
                               "Axis" + std::to_string(pairs[k].joint2), pairs[k].ratio));
      def.gears.back().name = "Gear" + std::to_string(k);
    }
  }
  [[nodiscard]] std::string problems(Formulation formulation) {
    def.formulation = formulation;
    return problems_of(def);
  }
};

TEST(GearRules, RefuseRatiosThatContradictEachOther) {
  for (const Formulation formulation : kFormulations) {
    EXPECT_EQ(Train(2, {{0, 1, -2.5}, {1, 0, 1}}).problems(formulation),
              "Gear1.ratio: 1 contradicts the gears before it, which hold 'Axis0' to 'Axis1' with -0.4: neither could "
              "move; expected ratios that agree round every circle of gears, or one gear less\n");
    // one per mille round a circle of three, and a part of the machine that moves
    EXPECT_EQ(Train(5, {{3, 4, 2}, {0, 1, 2}, {1, 2, 3}, {2, 0, 1.001 / 6}}).problems(formulation),
              "Gear3.ratio: 0.166833 contradicts the gears before it, which hold 'Axis0' to 'Axis2' with 0.166667: "
              "neither could move; expected ratios that agree round every circle of gears, or one gear less\n");
  }
}

TEST(GearRules, TakeRatiosThatAgreeAndGearsThatHoldAJoint) {
  for (const Formulation formulation : kFormulations) {
    EXPECT_EQ(Train(3, {{0, 1, 2}, {1, 2, 3}, {2, 0, 1.0 / 6}}).problems(formulation), "");
    EXPECT_EQ(Train(2, {{0, 1, -2.5}, {0, 1, -2.5}, {1, 0, -0.4}}).problems(formulation), "");
    EXPECT_EQ(Train(6, {{0, 1, 1e-3}, {1, 2, 20}, {4, 3, 1e-3}, {3, 2, 50}, {4, 5, -1}}).problems(formulation), "");
    EXPECT_EQ(Train(3, {{0, 1, 0}, {1, 2, 4}}).problems(formulation), "");  // ratio 0 holds joint 2
  }
}

TEST(GearRules, RefuseARatioOtherThanThatOfTheLoopOfTheirJoints) {
  // a parallelogram of 1 m by 2 m, whose cranks turn alike
  MechanicsDef def;
  def.bodies = {rod("Left", kFirst, 0),
                rod("Right", kFirst, 2),
                {.name = "Coupler", .position = {0, 1, 0}, .mass = 3, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "A", .body2 = "Left"},
                {.name = "B", .point1 = {2, 0, 0}, .body2 = "Right"},
                {.name = "C", .body1 = "Left", .point1 = {0, 1, 0}, .body2 = "Coupler"},
                {.name = "D", .body1 = "Right", .point1 = {0, 1, 0}, .body2 = "Coupler", .point2 = {2, 0, 0}}};
  for (const double ratio : {1.0, 2.0}) {
    def.gears = {gear(GearKind::gear, "A", "B", ratio)};
    EXPECT_EQ(problems_of(def).find("Gear: neither 'A' nor 'B' can move") != std::string::npos, ratio != 1.0)
        << problems_of(def);
  }
}

// the speed of the slow joint sets that of the fast one, whatever the ratio
TEST(SteepGear, StartsWithTheSpeedOfItsSlowJoint) {
  for (const double ratio : {1e3, 1e4, 1e5, 1e6, 1e-5}) {
    MechanicsDef def = geared_pendulums(1e-4, ratio);
    const bool is_first_slow = ratio > 1;
    if (!is_first_slow) std::swap(def.joints[0].initial_velocity, def.joints[1].initial_velocity);
    const Mechanism m(def);
    EXPECT_NEAR(m.value(is_first_slow ? "Pivot1.velocity" : "Pivot2.velocity"), 1e-4, 1e-16) << ratio;
    const double fast = 1e-4 * (is_first_slow ? ratio : 1 / ratio);
    EXPECT_NEAR(m.value(is_first_slow ? "Pivot2.velocity" : "Pivot1.velocity"), fast, 1e-12 * fast) << ratio;
    // a speed of the fast joint that does not fit
    if (!is_first_slow) continue;
    def.joints[0].initial_velocity = 1;
    def.joints[1].initial_velocity = 0.9 * ratio;
    Problems problems;
    validate(def, problems);
    EXPECT_NE(text_of(problems).find("initial_velocity: the loops do not allow"), std::string::npos) << ratio;
    def.joints[1].initial_velocity = ratio;
    problems.clear();
    validate(def, problems);
    EXPECT_EQ(text_of(problems), "") << ratio;
  }
}

}  // namespace gear_test
}  // namespace slew::multibody
