// SPDX-License-Identifier: Apache-2.0
// Flexible bodies at the start: static deflection against beam theory, bodies without modes, modes that are too fast.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "multibody/flexible/deflection.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace start_test {

using namespace testing;

constexpr double kLength = 6.5;  // m
constexpr double kGravity = 9.81;

// the jib boom, held level at its root, with a load at its tip
MechanicsDef level_boom(double load, double youngs_modulus, const std::vector<int>& kept) {
  MechanicsDef def;
  def.bodies = {{.name = "Boom", .type = BodyType::flexible},
                {.name = "Load",
                 .relative_to = "Boom",
                 .position = {-kLength, 0.02904, 0.1507},
                 .mass = load,
                 .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Boom"},
                {.name = "Hook",
                 .type = JointType::fixed,
                 .body1 = "Boom",
                 .point1 = {-kLength, 0.02904, 0.1507},
                 .body2 = "Load"}};
  const flex::BeamDef beam = flex::testing::jib_boom(20, youngs_modulus);
  def.flexible_bodies = {{.body = "Boom", .modes = slew::testing::modes_of(beam, flex::testing::with_modes(10), kept)}};
  return def;
}

// tip of a Timoshenko cantilever under its own weight and a load, small deflections
double sag(double load, double youngs_modulus) {
  const flex::BeamDef beam = flex::testing::jib_boom(20, youngs_modulus);
  const flex::Section section = flex::make_section(beam.sections[0], beam.materials[0].poisson_ratio);
  const double E = beam.materials[0].youngs_modulus, G = E / (2 * (1 + beam.materials[0].poisson_ratio));
  const double P = load * kGravity, w = beam.materials[0].density * section.area * kGravity, L = kLength;
  const double EI = E * section.second_moment_z, kGA = section.shear_factor_y * G * section.area;
  return P * L * L * L / (3 * EI) + P * L / kGA + w * std::pow(L, 4) / (8 * EI) + w * L * L / (2 * kGA);
}

// modes that bend in the plane of gravity, the first `count` of them, beside as many across it
std::vector<int> lowest(int count) {
  std::vector<int> kept;
  for (int k = 1; k <= 2 * count; ++k) kept.push_back(k);
  return kept;
}

TEST(FlexibleStart, SagsAsInBeamTheory) {
  for (const double youngs_modulus : {2e11, 2e10}) {
    for (const double load : {500.0, 1500.0}) {
      const double exact = sag(load, youngs_modulus);
      for (const auto& [modes, tolerance] : {std::pair(1, 0.04), {2, 0.01}}) {
        Mechanism boom(level_boom(load, youngs_modulus, lowest(modes)));
        const double y = boom.value("Boom.deflection.y");
        EXPECT_NEAR(y, -exact, tolerance * exact) << load << " kg, E " << youngs_modulus << ", " << modes << " a plane";
        RecordProperty("sag_" + std::to_string(modes) + "_" + std::to_string(static_cast<int>(load)),
                       std::to_string(-y / exact));
      }
    }
  }
}

class FlexibleStarts : public EveryFormulation {};

TEST_P(FlexibleStarts, StandStill) {
  Formulated boom = start(level_boom(500, 2e11, lowest(2)));
  const double before = boom.value("Boom.deflection.y");
  boom.run(0.5, 2.5e-4);
  EXPECT_NEAR(boom.value("Boom.deflection.y"), before, 1e-7 * std::fabs(before));
}

// The root by its node's name, and a clamped node beside it by its place: the same mechanism, without a loop.
TEST_P(FlexibleStarts, OfABodyHeldAtAClampedNodeIsThatOfItsFrame) {
  MechanicsDef named = level_boom(500, 2e11, lowest(2)), beside = named;
  const ModalBody& modes = *named.flexible_bodies[0].modes;
  const auto root = static_cast<std::size_t>(modes.root);
  named.joints[0].body2 = "Boom.Node" + std::to_string(modes.nodes[root].id);
  named.joints[0].point1 = modes.nodes[root].position.array();
  ModalBody wider = modes;
  ModalNode& second = wider.nodes[root == 0 ? 1 : root - 1];
  for (auto* by_mode : {&second.shift, &second.turn, &second.shortening})
    by_mode->assign(by_mode->size(), math::Vec3());
  beside.joints[0].point1 = beside.joints[0].point2 = second.position.array();
  beside.flexible_bodies[0].modes = std::make_shared<ModalBody>(wider);
  const auto after = [](const MechanicsDef& def) {
    Formulated boom = start(def);
    EXPECT_FALSE(boom.model.has_closing_rows());
    const double sagged = boom.value("Boom.deflection.y");
    boom.run(0.05, 2.5e-4);
    return std::pair(sagged, boom.value("Boom.deflection.y"));
  };
  for (const bool is_let_go : {false, true}) {
    MechanicsDef whole = level_boom(500, 2e11, lowest(2));
    for (MechanicsDef* def : {&whole, &named, &beside}) {
      if (is_let_go) def->flexible_bodies[0].start.assign(modes.modes(), 0.0);
    }
    const auto right = after(whole);
    for (const MechanicsDef* def : {&named, &beside}) {
      const auto found = after(*def);
      EXPECT_NEAR(found.first, right.first, 1e-9) << is_let_go;
      EXPECT_NEAR(found.second, right.second, 1e-9) << is_let_go;
    }
  }
}

// A prop under the load, from much softer to much stiffer than the boom: the sag without it over 1 + K c.
TEST_P(FlexibleStarts, RestOnASpring) {
  const auto sag_under = [](double load) {
    return Mechanism(level_boom(load, 2e11, lowest(2))).value("Boom.deflection.y");
  };
  const double free_sag = sag_under(500), compliance = (free_sag - sag_under(600)) / (100 * kGravity);
  for (const double share : {0.1, 0.9, 1.1, 10.0, 1e4}) {
    MechanicsDef def = level_boom(500, 2e11, lowest(2));
    TranslationalForceDef prop{.name = "Prop", .body1 = "Ground", .point1 = def.bodies[1].position, .body2 = "Load"};
    prop.point1[1] -= 2;
    prop.free_length = 2;
    prop.spring_constant = share / compliance;
    def.translational_forces = {prop};
    Formulated boom = start(def);
    const double expected = free_sag / (1 + share);
    EXPECT_NEAR(boom.value("Boom.deflection.y"), expected, 1e-4 * std::fabs(expected)) << share;
    boom.run(0.02, 2.5e-4);
    EXPECT_NEAR(boom.value("Boom.deflection.y"), expected, 1e-4 * std::fabs(expected)) << share;
  }
}

// Two modes on a fixed root, without gravity: q_1 = q cos(omega_1 t), q_2 = q'/omega_2 sin(omega_2 t).
TEST_P(FlexibleStarts, SwingFromGivenCoordinatesAndRates) {
  MechanicsDef def = level_boom(500, 2e11, {1, 2});
  def.bodies.resize(1);
  def.joints.resize(1);
  def.gravity = {};
  def.flexible_bodies[0].start = {0.02, 0};
  def.flexible_bodies[0].start_rates = {0, 0.3};
  Formulated boom = start(def);
  const ModalBody& modes = *def.flexible_bodies[0].modes;
  std::vector<std::size_t> places;
  for_each_mode(boom.model, [&](std::size_t q, std::size_t) { places.push_back(q); });
  ASSERT_EQ(places.size(), 2U);
  const double first = std::sqrt(modes.stiffness[0] / modes.mass_matrix[0]),
               second = std::sqrt(modes.stiffness[3] / modes.mass_matrix[3]);
  for (int i = 1; i <= 4; ++i) {
    boom.run(0.05, is(Formulation::augmented) ? 5e-5 : 1e-4);
    const double t = 0.05 * i;
    EXPECT_NEAR(boom.state.q[places[0]], 0.02 * std::cos(first * t), 1e-5 * 0.02);
    EXPECT_NEAR(boom.state.q[places[1]], 0.3 / second * std::sin(second * t), 1e-5 * 0.3 / second);
  }
}

// A body without modes is the rigid body of the beam's mass; so is one whose nodes carry others.
TEST_P(FlexibleStarts, BodiesWithoutModesAreRigid) {
  MechanicsDef flexible = level_boom(300, 2e11, {1, 2});
  flexible.joints[0].type = JointType::revolute;
  flexible.joints[1].type = JointType::spherical;
  flexible.joints[1].point1[1] -= 0.2;
  flexible.bodies[1].position[1] -= 0.2;
  flexible.bodies[1].center_of_mass = {0, -0.6, 0.1};
  flexible.flexible_bodies[0].modes = std::make_shared<ModalBody>(scene::modal_body(
      flex::select(flex::reduce(flex::build_beam(flex::testing::jib_boom()), flex::testing::with_modes(10)), {}),
      "none"));
  MechanicsDef rigid = flexible;
  take_mass(*flexible.flexible_bodies[0].modes, rigid.bodies[0]);
  rigid.bodies[0].type = BodyType::rigid;
  rigid.flexible_bodies.clear();
  Formulated one = start(flexible), other = start(rigid);
  EXPECT_EQ(one.model.links.size(), other.model.links.size()) << "nodes that do not move are no links";
  for (int i = 0; i < 20; ++i) {
    one.run(0.1, 1e-3);
    other.run(0.1, 1e-3);
    for (const char* variable : {"Root.position", "Load.position.x", "Load.position.y", "Load.position.z",
                                 "Load.velocity.x", "Load.velocity.y", "Load.velocity.z"}) {
      // a node's six rows are only as closed as penalty closes rows
      const double size = std::fmax(1, std::fabs(one.value(variable)));
      EXPECT_NEAR(one.value(variable), other.value(variable), (is(Formulation::penalty) ? 1e-6 : 1e-9) * size)
          << variable << " at " << 0.1 * (i + 1);
    }
  }
}

// 450 kg of the load as a force: in Ground's axes and in the body's, at the boom's node and at the body that it holds
TEST_P(FlexibleStarts, RestUnderForcesAsUnderWeights) {
  const double exact = sag(500, 2e11), force = 450 * kGravity;
  const PointForceDef pushes[] = {
      {.name = "Push", .body = "Load", .direction = {0, -1, 0}, .axes = LoadAxes::ground, .force = force},
      {.name = "Push", .body = "Boom", .point = {-kLength, 0.02904, 0.1507}, .direction = {0, -2, 0}, .force = force},
      {.name = "Push", .body = "Load", .direction = {0, -1, 0}, .force_table = {{0, force}, {1, force}}}};
  for (const PointForceDef& push : pushes) {
    MechanicsDef def = level_boom(50, 2e11, lowest(2));
    def.point_forces = {push};
    Formulated boom = start(def);
    const double before = boom.value("Boom.deflection.y");
    EXPECT_NEAR(before, -exact, 0.01 * exact);
    boom.run(0.2, 2.5e-4);
    EXPECT_NEAR(boom.value("Boom.deflection.y"), before, 1e-6 * std::fabs(before));
  }
}

INSTANTIATE_TEST_SUITE_P(In, FlexibleStarts, kEveryFormulation, kFormulationName);

TEST(FlexibleStart, TooFastModesAreRefusedByName) {
  const MechanicsDef def = level_boom(500, 2e11, {});
  Problems problems;
  validate(def, problems);
  ASSERT_EQ(problems.size(), 1U) << text_of(problems);
  EXPECT_EQ(problems[0].path, "Boom.flex_modes");
  EXPECT_NE(problems[0].what.find("which rk4 cannot follow in sub-steps of 0.001 s"), std::string::npos);
  MechanicsDef implicit = def;
  implicit.integrator = Integrator::trapezoidal;
  problems.clear();
  validate(implicit, problems);
  EXPECT_TRUE(problems.empty()) << text_of(problems);
}

// a motion just below the bound stays bounded, one just above it does not
TEST(FlexibleStart, TheBoundOfTheSubstepIsWhereRungeKuttaEnds) {
  MechanicsDef def = level_boom(0.1, 2e11, lowest(2));
  def.flexible_bodies[0].start = {1e-3, 1e-3, 1e-3, 1e-3};
  def.max_substep = 0.02;
  Problems problems;
  validate(def, problems);
  ASSERT_EQ(problems.size(), 1U);
  const std::string& text = problems[0].expected;
  const double longest = std::stod(text.substr(text.find("at most ") + 8));
  const auto largest_after = [&](double h) {
    MechanicsDef chosen = def;
    chosen.max_substep = h;
    const Model model = build_model(chosen);
    Workspace ws(model);
    State state = start_state(model);
    for (int i = 0; i < 2000; ++i) (void)advance_free(model, state, ws, h);
    double largest = 0;
    for (const double q : state.q) {
      if (!std::isfinite(q)) return std::numeric_limits<double>::infinity();
      largest = std::fmax(largest, std::fabs(q));
    }
    return largest;
  };
  EXPECT_LT(largest_after(0.98 * longest), 1);
  EXPECT_FALSE(largest_after(1.03 * longest) < 1e3);
}

TEST(FlexibleStart, LargeDeflectionsAreWarnedOf) {
  Problems warnings;
  find_start_changes(level_boom(1500, 2e11, lowest(1)), warnings);
  EXPECT_TRUE(warnings.empty()) << text_of(warnings);
  const MechanicsDef soft = level_boom(1500, 2e10, lowest(1));
  find_start_changes(soft, warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].what.find("node 20 is"), std::string::npos) << warnings[0].what;
  const Model model = build_model(soft);
  EXPECT_TRUE(is_bent_far(model, 0, model.start_q));
  EXPECT_FALSE(is_bent_far(model, 0, std::vector<double>(model.start_q.size())));
}

}  // namespace start_test
}  // namespace slew::multibody
