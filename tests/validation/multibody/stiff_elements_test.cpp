// SPDX-License-Identifier: Apache-2.0
// Force elements far stiffer than the sub-step resolves, under the implicit rules: closed forms of their statics, no
// energy from what pushes on one side only, and an iteration that ends soon because its matrix holds their slopes.
#include <functional>

#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace stiff_elements_test {

using testing::Choice;
using testing::Formulated;

constexpr double kStep = 1e-3;
constexpr double kGravity = 9.81;

void add_free(MechanicsDef& def, const BodyDef& body, const Triple& velocity = {}) {
  def.bodies.push_back(body);
  def.joints.push_back({.name = body.name + "_Free",
                        .type = JointType::floating,
                        .point1 = body.position,
                        .body2 = body.name,
                        .initial_translation = velocity});
}

// Steps of 1 ms, the corrections that they took, and how many did not settle.
struct Counted {
  int steps = 0, unsettled = 0, largest = 0;
  double sum = 0;
  [[nodiscard]] double mean() const { return sum / steps; }
};
Counted count(Formulated& mechanism, double time, const std::function<void()>& look = {}) {
  Counted counted;
  counted.steps = static_cast<int>(std::lround(time / kStep));
  for (int i = 0; i < counted.steps; ++i) {
    mechanism.dynamics.evaluate(mechanism.model, mechanism.state, mechanism.ws);
    const bool has_settled = mechanism.dynamics.advance(mechanism.model, mechanism.state, mechanism.ws, kStep, {}, {});
    counted.unsettled += has_settled ? 0 : 1;
    counted.largest = std::max(counted.largest, mechanism.dynamics.iterations());
    counted.sum += mechanism.dynamics.iterations();
    if (!look) continue;
    mechanism.see();
    look();
  }
  mechanism.see();
  return counted;
}

class StiffElement : public ::testing::TestWithParam<Choice> {
 protected:
  [[nodiscard]] static Formulated start(MechanicsDef def) {
    std::tie(def.formulation, def.integrator) = GetParam();
    def.contact_substep = kStep;
    return Formulated(def);
  }
  [[nodiscard]] static bool rings() { return std::get<1>(GetParam()) == Integrator::trapezoidal; }
  static void expect_soon(const Counted& counted, double mean) {
    EXPECT_EQ(counted.unsettled, 0);
    EXPECT_LE(counted.mean(), mean);
    RecordProperty("mean", std::to_string(counted.mean()));
    RecordProperty("largest", std::to_string(counted.largest));
    if (std::getenv("SLEWRING_SHOW") != nullptr) {
      std::printf("%-60s mean %.2f largest %d unsettled %d of %d\n",
                  ::testing::UnitTest::GetInstance()->current_test_info()->name(), counted.mean(), counted.largest,
                  counted.unsettled, counted.steps);
    }
  }
};

// ---- bushing --------------------------------------------------------------------------------------------------

constexpr double kMount = 1e9, kTurn = 1e8;

// two bodies one after the other on bearings of 30,000 and 10,000 rad/s; the bearing stands beside the centre of mass
MechanicsDef on_bushings(int bodies, double damping_time) {
  MechanicsDef def;
  for (int i = 0; i < bodies; ++i) {
    const std::string name = "B" + std::to_string(i), inner = i > 0 ? "B" + std::to_string(i - 1) : "Ground";
    add_free(def, {.name = name,
                   .position = {0.2 * i, 0, 0},
                   .mass = 1,
                   .center_of_mass = {0.1, 0, 0},
                   .inertia = {0.01, 0.01, 0.01}});
    def.bushings.push_back({.name = "Mount" + std::to_string(i),
                            .frames = {.body1 = inner, .point1 = {i > 0 ? 0.2 : 0.0, 0, 0}, .body2 = name},
                            .stiffness = {kMount, kMount, kMount},
                            .rotational_stiffness = {kTurn, kTurn, kTurn},
                            .damping = {damping_time * kMount, damping_time * kMount, damping_time * kMount},
                            .rotational_damping = {damping_time * kTurn, damping_time * kTurn, damping_time * kTurn}});
  }
  return def;
}

TEST_P(StiffElement, BushingsHoldTheirBodiesAsTheirStatics) {
  for (const int bodies : {1, 2, 6}) {
    Formulated chain = start(on_bushings(bodies, 1e-2));
    expect_soon(count(chain, 0.5), 6);
    // the first carries all, with the moment of the weights about it
    const double weight = bodies * kGravity, moment = kGravity * (0.1 * bodies + 0.1 * bodies * (bodies - 1));
    const double tolerance = rings() ? 1e-3 : 1e-6;
    EXPECT_NEAR(chain.pose("B0").position[1], -weight / kMount, tolerance * weight / kMount);
    EXPECT_NEAR(2 * chain.state.q[6], -moment / kTurn, tolerance * moment / kTurn);
  }
}

// a force that grows by 1 kN in 0.1 s along a spring that follows it at 30,000 rad/s: F(t)/k, behind it by the damper's
// time and by the start transient that the trapezoid keeps
TEST_P(StiffElement, BushingFollowsASlowForceQuasiStatically) {
  MechanicsDef def = on_bushings(1, 1e-4);
  def.gravity = {};
  def.bodies[0].center_of_mass = {};
  def.point_forces.push_back(
      {.name = "Push", .body = "B0", .direction = {1, 0, 0}, .force_table = {{0, 0}, {0.05, 500}, {0.1, 1000}}});
  Formulated body = start(def);
  const Counted counted = count(body, 0.1, [&body] {
    if (body.state.time < 0.05) return;
    const double force = body.value("Push.force");
    EXPECT_NEAR(body.pose("B0").position[0], force / kMount, 2e-3 * 1e-6);
  });
  expect_soon(counted, 4);
}

// ---- beam -----------------------------------------------------------------------------------------------------

// ten segments of steel, 0.1 m square: the tip sags by F l^3/(3 E I), and the weights of the segments' ends
TEST_P(StiffElement, BeamSagsAsACantilever) {
  constexpr int kSegments = 10;
  constexpr double kLength = 2, kE = 2.1e11, kSecond = 1e-4 / 12, kPart = kLength / kSegments;
  MechanicsDef def;
  for (int i = 0; i < kSegments; ++i) {
    const std::string name = "S" + std::to_string(i), inner = i > 0 ? "S" + std::to_string(i - 1) : "Ground";
    add_free(def, {.name = name, .position = {kPart * (i + 1), 0, 0}, .mass = 15.7, .inertia = {0.1, 0.1, 0.1}});
    def.beams.push_back({.name = "Beam" + std::to_string(i),
                         .frames = {.body1 = inner, .body2 = name},
                         .length = kPart,
                         .youngs_modulus = kE,
                         .area = 0.01,
                         .second_moment_y = kSecond,
                         .second_moment_z = kSecond,
                         .torsion_constant = 0.1406e-4,
                         .damping_time = 1e-2});
  }
  Formulated beam = start(def);
  expect_soon(count(beam, 1), 8);
  double sag = 0;
  for (int i = 0; i < kSegments; ++i) {
    const double a = kPart * (i + 1);
    sag += 15.7 * kGravity * a * a * (3 * kLength - a) / (6 * kE * kSecond);
  }
  EXPECT_NEAR(beam.pose("S9").position[1], -sag, 1e-3 * sag);
}

// ---- rope -----------------------------------------------------------------------------------------------------

// 10 kg fall 0.1 m into a rope of 1e8 N/m over two pulleys, then hang on it
TEST_P(StiffElement, RopeGoesTautWithoutGain) {
  MechanicsDef def;
  add_free(def, {.name = "Weight", .position = {0, -0.9, 0}, .mass = 10, .inertia = {1, 1, 1}});
  def.ropes.push_back({.name = "Rope",
                       .bodies = {"Weight", "Ground", "Ground"},
                       .points = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}},
                       .free_length = 2,
                       .stiffness = 1e8,
                       .damping_constant = 1e5});
  Formulated weight = start(def);
  double energy = weight.total_energy();
  const Counted counted = count(weight, 2, [&] {
    EXPECT_LE(weight.total_energy(), energy + 1e-9 * 10 * kGravity);
    energy = weight.total_energy();
  });
  expect_soon(counted, 6);
  EXPECT_NEAR(weight.pose("Weight").position[1], -1 - 10 * kGravity / 1e8, 1e-3 * 10 * kGravity / 1e8);
}

// a block and tackle: a rope over a pulley on a body that hangs in it carries half of its weight
TEST_P(StiffElement, RopeOverAHangingPulleyCarriesHalf) {
  MechanicsDef def;
  add_free(def, {.name = "Pulley", .position = {0, -1, 0}, .mass = 100, .inertia = {1, 1, 1}});
  def.ropes.push_back({.name = "Rope",
                       .bodies = {"Ground", "Pulley", "Ground"},
                       .points = {{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}},
                       .free_length = 2 * std::hypot(0.5, 1),
                       .stiffness = 1e8,
                       .damping_constant = 1e6});
  Formulated pulley = start(def);
  expect_soon(count(pulley, 1), 6);
  const double along = std::hypot(0.5, 1);
  EXPECT_NEAR(pulley.value("Rope.tension"), 100 * kGravity * along / 2, 1e-3 * 500);
}

// ---- tyre -----------------------------------------------------------------------------------------------------

TEST_P(StiffElement, TyreRestsAtTheDepthOfItsLoad) {
  MechanicsDef def;
  add_free(def, {.name = "Axle", .position = {0, 0.5, 0}, .mass = 50, .inertia = {1, 1, 1}}, {1, 0, 0});
  def.tyre_dummies.push_back({.name = "Wheel",
                              .relative_to = "Axle",
                              .mass = 50,
                              .inertia = {1, 1, 1},
                              .radius = 0.5,
                              .stiffness = 1e8,
                              .damping = 1e5,
                              .friction = 0.8,
                              .lateral_slip_slope = 10,
                              .slip_speed = 1e-3});
  Formulated wheel = start(def);
  expect_soon(count(wheel, 0.5), 8);
  const double depth = 100 * kGravity / 1e8;
  EXPECT_NEAR(wheel.pose("Axle").position[1], 0.5 - depth, 1e-3 * depth);
}

// ---- contact --------------------------------------------------------------------------------------------------

ShapeDef floor_shape() {
  return {.name = "Floor", .type = contact::ShapeType::plane, .orientation = {0, -M_PI / 2, 0}};
}

ContactPairDef on_floor(const std::string& shape, double stiffness, const std::string& friction = "") {
  ContactPairDef pair;
  pair.normal = {.stiffness = stiffness, .restitution = 0.1, .smallest_impact_speed = 0.1};
  pair.name = shape + "_Floor";
  pair.shape_a = shape;
  pair.shape_b = "Floor";
  pair.friction = friction;
  return pair;
}

// 1 kg on 1e8 N/m: 10,000 rad/s
TEST_P(StiffElement, BallRestsAtTheDepthOfItsWeight) {
  MechanicsDef def;
  add_free(def, {.name = "Ball", .position = {0, 0.1, 0}, .mass = 1, .inertia = {0.004, 0.004, 0.004}});
  def.shapes = {{.name = "Skin", .type = contact::ShapeType::sphere, .body = "Ball", .radius = 0.1}, floor_shape()};
  def.contacts = {on_floor("Skin", 1e8)};
  Formulated ball = start(def);
  const double begin = ball.total_energy();
  expect_soon(count(ball, 0.5, [&] { EXPECT_LE(ball.total_energy(), begin + 1e-12); }), 6);
  const double depth = kGravity / 1e8;
  EXPECT_NEAR(ball.pose("Ball").position[1], 0.1 - depth, rings() ? depth : 1e-3 * depth);
}

// a box of 2 kg on a slope of 10 degrees, mu 0.3: it stays, on bristles of 1e7 N/m and floor of 1e8 N/m
TEST_P(StiffElement, BoxStaysOnASlopeByItsBristles) {
  const double angle = 10 * M_PI / 180;
  MechanicsDef def;
  def.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
  add_free(def, {.name = "Box", .position = {0, 0.1, 0}, .mass = 2, .inertia = {0.03, 0.05, 0.03}});
  def.shapes = {{.name = "Sides", .type = contact::ShapeType::box, .body = "Box", .size = {0.4, 0.2, 0.4}},
                floor_shape()};
  FrictionDef friction;
  friction.name = "Dry";
  friction.law.stiffness = 1e7;
  friction.law.damping = 1e4;
  friction.law.static_coefficient = friction.law.dynamic_coefficient = 0.3;
  def.frictions = {friction};
  def.contacts = {on_floor("Sides", 1e8, "Dry")};
  Formulated box = start(def);
  static_cast<void>(count(box, 0.2));
  const double settled = box.pose("Box").position[0];
  const Counted counted = count(box, 1);
  expect_soon(counted, 6);
  EXPECT_NEAR(box.pose("Box").position[0], settled, 1e-7);
  EXPECT_NEAR(box.value("Sides_Floor.friction_force.x"), -2 * kGravity * std::sin(angle), 1e-2 * 2 * kGravity);
}

// ---- tables ---------------------------------------------------------------------------------------------------

// 1 m of a rod on a hinge with a spring table of 1e7 N m/rad, that gets twice as stiff
TEST_P(StiffElement, TableOfAHingeCarriesTheWeight) {
  MechanicsDef def;
  def.bodies.push_back({.name = "Rod", .mass = 1, .center_of_mass = {0.5, 0, 0}, .inertia = {0.01, 0.08, 0.08}});
  def.joints.push_back({.name = "Pin", .body2 = "Rod"});
  def.rotational_forces.push_back({.name = "Table",
                                   .body1 = "Ground",
                                   .f1 = {1, 0, 0},
                                   .g1 = {0, 1, 0},
                                   .body2 = "Rod",
                                   .f2 = {1, 0, 0},
                                   .spring_table = {{-2e-7, -4}, {-1e-7, -1}, {0, 0}, {1e-7, 1}, {2e-7, 4}},
                                   .damper_table = {{-1, -1e5}, {0, 0}, {1, 1e5}}});
  Formulated rod = start(def);
  expect_soon(count(rod, 1), 6);
  const double moment = kGravity * 0.5;
  EXPECT_NEAR(rod.value("Table.torque"), moment, 1e-5 * moment);
}

// ---- the trapezoid of index 3 shares the slopes ----------------------------------------------------------------

TEST(AugmentedLagrangian, SettlesOnStiffBushings) {
  for (const int bodies : {1, 6}) {
    MechanicsDef def = on_bushings(bodies, 1e-2);
    def.formulation = Formulation::augmented;
    Formulated chain(def);
    EXPECT_EQ(count(chain, 0.5).unsettled, 0);
    const double weight = bodies * kGravity;
    EXPECT_NEAR(chain.pose("B0").position[1], -weight / kMount, 1e-3 * weight / kMount);
  }
}

const testing::Rules kRules = {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2};
const testing::Rules kInBodyCoordinates = {Integrator::sdirk2};
INSTANTIATE_TEST_SUITE_P(In, StiffElement, ::testing::ValuesIn(testing::gate_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, StiffElement,
                         ::testing::ValuesIn(testing::nightly_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);

}  // namespace stiff_elements_test
}  // namespace slew::multibody
