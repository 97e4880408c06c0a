// SPDX-License-Identifier: Apache-2.0
// What contacts cost: the parts into which they divide a step of 1 ms. What rests or is pressed takes those of
// contact_substep, however fast its load is damped, and follows the law all the same; a blow takes what it needs.
//
// Figures of docs/models/multibody_contact.md: SLEWRING_SHOW=1 bin/validation_multibody_contact
// --gtest_filter='*Parts*'
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "core/allocation_guard.h"
#include "scene_cases.h"

namespace slew::multibody {
namespace parts_test {

using namespace testing;

constexpr double kStep = 1e-3, kStiffness = 1e5, kSlowest = 0.05, kPush = 12;
constexpr int kPartsOfSubstep = 10;  // contact_substep is a tenth of kStep
// beyond them the implicit rule takes over
constexpr int kMostParts = 2 * kPartsOfSubstep;

contact::NormalLawDef law_of(double restitution) {
  return {.stiffness = kStiffness, .restitution = restitution, .smallest_impact_speed = kSlowest};
}

ShapeDef skin_of(const std::string& kind) {
  ShapeDef shape = ball_shape("Skin", "Body", 0.01);
  if (kind == "capsule") {
    shape.type = contact::ShapeType::capsule;
    shape.length = 0.04;
  } else if (kind == "box") {
    shape = box_shape("Skin", "Body", {0.02, 0.02, 0.04});
  } else if (kind == "mesh") {
    shape = box_shape("Skin", "Body", {});
    shape.type = contact::ShapeType::convex_mesh;
    for (const double x : {-0.01, 0.01}) {
      for (const double y : {-0.01, 0.01}) {
        for (const double z : {-0.02, 0.02}) shape.vertices.insert(shape.vertices.end(), {x, y, z});
      }
    }
    shape.triangles = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                       2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
  }
  return shape;
}

MechanicsDef body_above_floor(const std::string& kind, double height, double restitution) {
  MechanicsDef def;
  add_free(def, free_body("Body", 0.045, {1e-5, 1e-5, 1e-5}, {0, 0.01 + height, 0}));
  def.shapes = {skin_of(kind), ground_shape("Floor")};
  def.frictions = {dry_friction("Dry", 0.7)};
  def.frictions[0].law.stiffness = 1e4;
  def.frictions[0].law.damping = 10;
  def.contacts = {pair_of("Skin", "Floor", law_of(restitution), "Dry")};
  return def;
}

// between a pad that stands and one that a force pushes along a rail, all as deep in each other as the force makes them
MechanicsDef body_between_pads(const std::string& kind, double restitution, double pad_mass = 1) {
  MechanicsDef def = body_above_floor(kind, -0.01, restitution);
  const double depth = kPush / kStiffness;
  def.bodies[0].position = def.joints[0].point1 = {-depth, 0, 0};
  const Triple position = {0.03 - 2 * depth, 0, 0};
  def.bodies.push_back(free_body("Right", pad_mass, {1e-3, 1e-3, 1e-3}, position));
  JointDef rail;
  rail.name = "Rail";
  rail.type = JointType::prismatic;
  rail.body2 = "Right";
  rail.point1 = position;
  rail.orientation1 = rail.orientation2 = {0, M_PI / 2, 0};
  def.joints.push_back(rail);
  PointForceDef push;
  push.name = "Push";
  push.body = "Right";
  push.direction = {-1, 0, 0};
  push.force = kPush;
  def.point_forces.push_back(push);
  def.shapes.resize(1);
  def.shapes.push_back(box_shape("Left", "Ground", {0.04, 0.06, 0.06}));
  def.shapes.back().position = {-0.03, 0, 0};
  def.shapes.push_back(box_shape("RightPad", "Right", {0.04, 0.06, 0.06}));
  def.contacts = {pair_of("Skin", "Left", law_of(restitution), "Dry"),
                  pair_of("Skin", "RightPad", law_of(restitution), "Dry")};
  return def;
}

double processor_time() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Cost {
  double parts = 0, settling = 0, time = 0;  // of a step, mean
  int most = 0;
};

Cost cost_of(Motion& motion, int steps) {
  Cost cost;
  const double start = processor_time();
  for (int i = 0; i < steps; ++i) {
    motion.is_sound = motion.step(kStep) && motion.is_sound;
    cost.parts += 1.0 * motion.dynamics.contact_parts() / steps;
    cost.settling += 1.0 * motion.dynamics.settling_parts() / steps;
    cost.most = std::max(cost.most, motion.dynamics.contact_parts());
  }
  cost.time = (processor_time() - start) / steps;
  motion.see();
  return cost;
}

struct Case {
  Formulation formulation;
  std::string kind;
  double restitution;
};

std::string name_of_case(const ::testing::TestParamInfo<Case>& test) {
  return name_of(test.param.formulation) + "_" + test.param.kind + "_" +
         std::to_string(std::lround(100 * test.param.restitution));
}

void show(const Case& chosen, const char* situation, const Cost& cost) {
  if (std::getenv("SLEWRING_SHOW") == nullptr) return;
  std::printf("%-9s %-8s %-8s e %-5g %6.1f parts (%4.1f), at most %4d  %7.1f us\n", name_of(chosen.formulation).c_str(),
              situation, chosen.kind.c_str(), chosen.restitution, cost.parts, cost.settling, cost.most,
              1e6 * cost.time);
}

constexpr double kRestitutions[] = {0.01, 0.1, 0.5, 0.9};
const char* const kKinds[] = {"sphere", "capsule", "box", "mesh"};

// The gate has each shape and each restitution once.
enum class Run { gate, nightly };
std::vector<Case> cases_of(Run run) {
  std::vector<Case> cases;
  for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
    for (int kind = 0; kind < 4; ++kind) {
      for (int e = 0; e < 4; ++e) {
        const bool is_in_gate = e == (kind + (formulation == Formulation::recursive ? 0 : 2)) % 4;
        if (is_in_gate == (run == Run::gate)) cases.push_back({formulation, kKinds[kind], kRestitutions[e]});
      }
    }
  }
  return cases;
}

class ContactParts : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(All, ContactParts, ::testing::ValuesIn(cases_of(Run::gate)), name_of_case);
INSTANTIATE_TEST_SUITE_P(AllNightly, ContactParts, ::testing::ValuesIn(cases_of(Run::nightly)), name_of_case);

// was 200 and more parts a step
TEST_P(ContactParts, OfWhatIsPressedAreThoseOfTheSubstep) {
  Motion motion(body_between_pads(GetParam().kind, GetParam().restitution), GetParam().formulation);
  motion.run(0.3, kStep);
  const math::Vec3 start(motion.pose("Body").position);
  const Cost cost = cost_of(motion, 100);
  show(GetParam(), "pressed", cost);
  EXPECT_LE(cost.most, kMostParts);
  EXPECT_TRUE(motion.is_sound);
  for (const char* pair : {"Skin_Left", "Skin_RightPad"}) {
    EXPECT_NEAR(std::fabs(motion.value(std::string(pair) + ".normal_force.x")), kPush, 1e-3 * kPush);
    EXPECT_NEAR(motion.value(std::string(pair) + ".depth"), kPush / kStiffness, 1e-3 * kPush / kStiffness);
  }
  // bristles hold the weight: the body does not creep
  const double weight = 0.045 * 9.81;
  const double held = motion.value("Skin_Left.friction_force.y") + motion.value("Skin_RightPad.friction_force.y");
  EXPECT_NEAR(held, weight, 1e-3 * weight);
  EXPECT_LT(norm(math::Vec3(motion.pose("Body").position) - start), 1e-7);
}

TEST_P(ContactParts, OfWhatRestsAreThoseOfTheSubstep) {
  Motion motion(body_above_floor(GetParam().kind, 0, GetParam().restitution), GetParam().formulation);
  motion.run(1, kStep);
  const Cost cost = cost_of(motion, 100);
  show(GetParam(), "rests", cost);
  EXPECT_LE(cost.most, kMostParts);
  EXPECT_TRUE(motion.is_sound);
  const double weight = 0.045 * 9.81;
  EXPECT_NEAR(motion.value("Skin_Floor.normal_force.y"), weight, 1e-3 * weight);
  EXPECT_LT(norm(math::Vec3(motion.pose("Body").velocity)), 1e-5);
}

// a blow takes parts of 0.1 / rate under it, which was 15 of them here at rest too
TEST(ContactParts, OfWhatRestsUnderSemiImplicitEulerNeedOnlyBeStable) {
  MechanicsDef def = body_above_floor("sphere", 0.002, 0.5);
  def.frictions.clear();
  def.contacts[0].friction.clear();
  def.contact_substep = kStep;
  Motion motion(def, {Formulation::recursive, Integrator::semi_implicit_euler});
  EXPECT_GE(cost_of(motion, 40).most, 15);  // falls and rebounds
  motion.run(0.5, kStep);
  EXPECT_LE(cost_of(motion, 100).most, 2);
  EXPECT_TRUE(motion.is_sound);
  const double weight = 0.045 * 9.81;
  EXPECT_NEAR(motion.value("Skin_Floor.normal_force.y"), weight, 1e-3 * weight);
  EXPECT_LT(norm(math::Vec3(motion.pose("Body").velocity)), 1e-5);
}

// whichever rule takes what part of a blow
TEST_P(ContactParts, OfABlowGiveNoEnergyBack) {
  Motion motion(body_above_floor(GetParam().kind, 0.1, GetParam().restitution), GetParam().formulation);
  double energy = motion.total_energy();
  const double start = energy;
  for (int i = 0; i < 400; ++i) {
    motion.run(kStep, kStep);
    ASSERT_LT(motion.total_energy(), energy + 1e-3 * start) << i;
    energy = std::min(energy, motion.total_energy());
  }
  EXPECT_TRUE(motion.is_sound);
}

class Parts : public EveryWay {};
INSTANTIATE_TEST_SUITE_P(All, Parts, ::testing::Values(Formulation::recursive, Formulation::lagrange), name_of_way);

TEST_P(Parts, OfTheImplicitRuleDoNotAllocate) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  Motion motion(body_between_pads("capsule", 0.1), GetParam());
  motion.run(0.02, kStep);
  int settling = 0;
  const AllocationGuard guard;
  for (int i = 0; i < 20; ++i) {
    motion.is_sound = motion.step(kStep) && motion.is_sound;
    settling += motion.dynamics.settling_parts();
  }
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_EQ(guard.frees(), 0u);
  EXPECT_GT(settling, 100);
}

// only the state is carried from part to part
TEST_P(Parts, OfTheImplicitRuleGoOnFromASavedStateWithTheSameBits) {
  const MechanicsDef def = body_between_pads("capsule", 0.1);
  Motion whole(def, GetParam()), resumed(def, GetParam());
  whole.run(0.05, kStep);
  whole.dynamics.evaluate(whole.model, whole.state, whole.ws);
  std::vector<std::byte> bytes;
  StateWriter writer(bytes, {});
  save(whole.model, whole.state, writer);
  whole.dynamics.save(writer);
  writer.finish();
  StateReader reader(bytes, {});
  load(resumed.model, resumed.state, reader);
  resumed.dynamics.load(reader);
  ASSERT_TRUE(reader.finish("mechanics").is_ok());
  for (Motion* motion : {&whole, &resumed}) motion->run(0.05, kStep);
  EXPECT_GT(resumed.dynamics.settling_parts(), 0);
  EXPECT_EQ(whole.state.q, resumed.state.q);
  EXPECT_EQ(whole.state.u, resumed.state.u);
}

// Into the depth of its load a light body creeps as its damping lets it, m = 0:  F = k d (1 + a d'/v_min)  gives
//   t = (a/v_min) (d_0 - d + (F/k) ln((F/k - d_0)/(F/k - d)))
TEST_P(Parts, FollowTheSlowWayIntoTheDepthOfALoad) {
  for (const double e : {0.01, 0.1}) {
    SCOPED_TRACE(e);
    MechanicsDef def = body_above_floor("sphere", -3 / kStiffness, e);
    def.gravity = {};
    def.bodies[0].mass = 0.005;
    PointForceDef push;
    push.name = "Push";
    push.body = "Body";
    push.axes = LoadAxes::ground;
    push.direction = {0, -1, 0};
    push.force_table = {{0, 3}, {0.1, 3}, {0.1001, kPush}, {10, kPush}};
    def.point_forces.push_back(push);
    Motion motion(def, GetParam());
    // the blow of the new load is over in 1 ms
    motion.run(0.105, kStep);
    const double a = contact::damping_number(e), end = kPush / kStiffness, piece = 5 * a * kStep / 10;
    const double before = motion.value("Skin_Floor.depth");
    for (int i = 1; i <= 5; ++i) {
      motion.run(std::round(piece / kStep) * kStep, kStep);
      const double time = i * std::round(piece / kStep) * kStep, d = motion.value("Skin_Floor.depth");
      const double expected = a / kSlowest * (before - d + end * std::log((end - before) / (end - d)));
      EXPECT_NEAR(expected, time, 2e-3 * time) << i;
    }
    EXPECT_GT(motion.dynamics.settling_parts(), 0);
    EXPECT_TRUE(motion.is_sound);
  }
}

}  // namespace parts_test
}  // namespace slew::multibody
