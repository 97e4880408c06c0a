// SPDX-License-Identifier: Apache-2.0
// What every element with two ends or more keeps, over random motions of its links: forces and moments balance, a
// motion of all bodies as one does not deform it, springs return their energy, dampers only dissipate.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "multibody/forces/element_set.h"
#include "multibody/formulations/formulation.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace elements_test {

using math::Mat3;
using math::Vec3;

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(generator_); }
  Vec3 vector(double size) { return {number(size), number(size), number(size)}; }
  Mat3 rotation(double size) { return math::rotation_zxz({number(size), number(size), number(size)}); }

 private:
  std::mt19937 generator_;
};

LinkMotion random_motion(Random& random, double turn) {
  LinkMotion motion;
  motion.R = random.rotation(turn);
  motion.p = random.vector(1);
  motion.v = random.vector(1);
  motion.w = random.vector(2);
  return motion;
}

// the link a time t later at constant velocities
LinkMotion moved(LinkMotion m, double t) {
  const double angle = norm(m.w) * t;
  const Vec3 axis = m.w * (1 / norm(m.w));
  const Mat3 K = math::skew(axis);
  m.R = (Mat3::identity() + K * std::sin(angle) + K * K * (1 - std::cos(angle))) * m.R;
  m.p += m.v * t;
  return m;
}

FramePair random_frames(Random& random) {
  FramePair pair;
  pair.link1 = 1;
  pair.link2 = 2;
  pair.R_L1 = random.rotation(1);
  pair.R_L2 = random.rotation(1);
  pair.p_L1 = random.vector(0.5);
  pair.p_L2 = random.vector(0.5);
  return pair;
}

Bushing random_bushing(Random& random) {
  Bushing bushing;
  bushing.frames = random_frames(random);
  double B[36];
  for (double& b : B) b = random.number(1);
  // B B^T: symmetric and positive
  for (std::size_t i = 0; i < 6; ++i) {
    bushing.spring[i] = 1 + random.number(1);
    bushing.preload[i] = random.number(1);
    for (std::size_t j = 0; j < 6; ++j) {
      for (std::size_t k = 0; k < 6; ++k) bushing.K[6 * i + j] += B[6 * i + k] * B[6 * j + k];
    }
  }
  bushing.has_coupling = true;
  const Table table = {{-1, -4}, {-0.2, -0.1}, {0, 0}, {0.5, 0.7}, {2, 3}};
  bushing.curves.push_back({1, false, math::monotone_cubic(table, math::Ends::continued)});
  bushing.curves.push_back({4, false, math::monotone_cubic(table, math::Ends::continued)});
  return bushing;
}

Beam random_beam(Random& random) {
  Beam beam;
  beam.frames = random_frames(random);
  beam.frames.rest = Vec3(0.8, 0, 0);
  beam.K = stiffness_of({.length = 0.8,
                         .youngs_modulus = 10,
                         .shear_modulus = 4,
                         .area = 0.5,
                         .second_moment_y = 0.2,
                         .second_moment_z = 0.1,
                         .torsion_constant = 0.15,
                         .shear_factor_y = 0.8,
                         .shear_factor_z = 0.7});
  return beam;
}

Rope random_rope(Random& random) {
  Rope rope;
  for (const int link : {0, 1, 2, 1, 2}) rope.points.push_back({link, link, random.vector(1)});
  rope.free_length = 0.5;
  rope.spring = 3;
  return rope;
}

// elements of one kind between links 1 and 2 and Ground
ElementSet one_kind(int kind, unsigned seed) {
  Random random(seed);
  ElementSet set;
  if (kind == 0) set.bushings.push_back(random_bushing(random));
  if (kind == 1) set.beams.push_back(random_beam(random));
  if (kind == 2) set.ropes.push_back(random_rope(random));
  return set;
}

struct MovingElements {
  MovingElements(int kind, std::uint32_t seed) : set(one_kind(kind, seed)), random(seed + 100) {
    motion[0].R = Mat3::identity();
    // rotations up to a third of a turn against each other, far from small angles
    for (std::size_t i = 1; i < 3; ++i) motion[i] = random_motion(random, 0.7);
  }
  [[nodiscard]] std::vector<LinkMotion> at(double t) const {
    std::vector<LinkMotion> later = motion;
    for (std::size_t i = 1; i < 3; ++i) later[i] = moved(motion[i], t);
    return later;
  }
  [[nodiscard]] double power() const {
    double sum = 0;
    for_each_wrench(set, motion, 0, [&](int link, int, const Wrench& wrench) {
      const LinkMotion& m = motion[static_cast<std::size_t>(link)];
      sum += dot(wrench.f, m.v) + dot(wrench.n, m.w);
    });
    return sum;
  }
  void add_dampers() {
    for (Bushing& bushing : set.bushings) bushing.damping = {1, 2, 3, 0.5, 0.4, 0.3};
    for (Bushing& bushing : set.bushings) bushing.D = bushing.K;
    for (Beam& beam : set.beams) beam.damping_time = 0.2;
    for (Rope& rope : set.ropes) rope.damping = 0.7;
  }

  ElementSet set;
  Random random;
  std::vector<LinkMotion> motion = std::vector<LinkMotion>(3);
};

// with bushings, beams and ropes
template <typename Claim>
void for_each_kind(Claim claim) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 16}}), [&](std::uint32_t seed) {
    for (int kind = 0; kind < 3; ++kind) {
      SCOPED_TRACE("kind " + std::to_string(kind));
      MovingElements elements(kind, seed);
      claim(elements);
    }
  });
}

TEST(Elements, BalanceForcesAndMoments) {
  for_each_kind([](MovingElements& elements) {
    elements.add_dampers();
    Vec3 force, moment;
    double size = 0;
    for_each_wrench(elements.set, elements.motion, 0, [&](int link, int, const Wrench& wrench) {
      force += wrench.f;
      moment += wrench.n + cross(elements.motion[static_cast<std::size_t>(link)].p, wrench.f);
      size += norm(wrench.f) + norm(wrench.n);
    });
    EXPECT_GT(size, 0.1);
    EXPECT_LT(norm(force), 1e-13 * size);
    EXPECT_LT(norm(moment), 1e-13 * size);
  });
}

TEST(Elements, DoNotFeelAMotionOfAllBodiesAsOne) {
  for_each_kind([](MovingElements& elements) {
    std::vector<Wrench> before;
    for_each_wrench(elements.set, elements.motion, 0,
                    [&](int, int, const Wrench& wrench) { before.push_back(wrench); });
    // everything turned and shifted, Ground's points included
    const Mat3 R = elements.random.rotation(2);
    const Vec3 shift = elements.random.vector(10);
    std::vector<LinkMotion> turned = elements.motion;
    for (LinkMotion& m : turned) {
      m.R = R * m.R;
      m.p = shift + R * m.p;
      m.v = R * m.v;
      m.w = R * m.w;
    }
    std::size_t i = 0;
    for_each_wrench(elements.set, turned, 0, [&](int, int, const Wrench& wrench) {
      EXPECT_LT(norm(wrench.f - R * before[i].f), 1e-11);
      EXPECT_LT(norm(wrench.n - R * before[i].n), 1e-11);
      ++i;
    });
    EXPECT_EQ(i, before.size());
  });
}

TEST(Elements, GiveBackTheEnergyThatTheirSpringsTook) {
  for_each_kind([](MovingElements& elements) {
    constexpr double h = 1e-4;
    // fourth-order difference along the motion
    const auto energy = [&](double t) { return stored_energy(elements.set, elements.at(t)); };
    const double rate = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
    EXPECT_GT(std::fabs(rate), 1e-3);
    EXPECT_NEAR(elements.power(), -rate, 1e-8 * (1 + std::fabs(rate)));
  });
}

TEST(Elements, OnlyTakeEnergyByTheirDampers) {
  for_each_kind([](MovingElements& elements) {
    const double of_springs = elements.power();
    elements.add_dampers();
    EXPECT_LT(elements.power() - of_springs, 0);
  });
}

TEST(Bushing, HasNoForceWhereItIsNotDeflected) {
  Bushing bushing;
  bushing.frames.link2 = 1;
  bushing.spring = {1e6, 1e6, 1e6, 1e5, 1e5, 1e5};
  LinkMotion ground, body;
  ground.R = body.R = Mat3::identity();
  body.R = math::rotation_zxz({0.4, 0.3, 0.2});
  bushing.frames.R_L1 = body.R;
  const Six Q = force_of(bushing, deflection_of(bushing.frames, ground, body));
  for (const double q : Q) EXPECT_NEAR(q, 0, 1e-9);
}

// a chain with every kind of element
MechanicsDef chain_with_all_elements() {
  MechanicsDef def;
  def.bodies = {{.name = "A", .mass = 3, .center_of_mass = {0.5, 0, 0}, .inertia = {0.1, 0.3, 0.3}},
                {.name = "B", .relative_to = "A", .position = {1, 0, 0}, .mass = 2, .inertia = {0.2, 0.2, 0.2}},
                {.name = "C", .position = {0.5, 1, 0}, .mass = 4, .inertia = {0.2, 0.3, 0.2}}};
  def.joints = {{.name = "Hinge", .body2 = "A", .initial_velocity = 0.5},
                {.name = "Ball", .type = JointType::spherical, .body1 = "A", .point1 = {1, 0, 0}, .body2 = "B"},
                {.name = "Flight", .type = JointType::floating, .body2 = "C"}};
  def.point_forces = {
      {.name = "Push", .body = "B", .point = {0, 0.1, 0}, .force = 3, .force_table = {{0, 0}, {1, 40}}}};
  def.point_torques = {{.name = "Turn", .body = "C", .axes = LoadAxes::ground, .torque = 2}};
  def.bushings = {{.name = "Mount",
                   .frames = {.body1 = "A", .point1 = {0.5, 1, 0}, .body2 = "C"},
                   .stiffness = {900, 700, 800},
                   .rotational_stiffness = {30, 20, 40},
                   .damping = {5, 5, 5},
                   .spring_tables = {.about_y = {{-1, -9}, {0, 0}, {1, 4}}}}};
  def.beams = {{.name = "Beam",
                .frames = {.body1 = "Ground", .body2 = "B"},
                .length = 1,
                .youngs_modulus = 1e9,
                .area = 1e-6,
                .second_moment_y = 2e-8,
                .second_moment_z = 1e-8,
                .torsion_constant = 1e-8,
                .damping_time = 1e-3}};
  def.ropes = {{.name = "Rope",
                .bodies = {"Ground", "A", "C"},
                .points = {{0, 2, 0}, {0.7, 0, 0}, {0.1, 0, 0}},
                .free_length = 3,
                .stiffness = 400,
                .damping_constant = 10}};
  def.tyre_dummies = {{.name = "Wheel",
                       .relative_to = "C",
                       .mass = 1,
                       .radius = 0.5,
                       .ground_height = 0.45,
                       .stiffness = 2000,
                       .damping = 10,
                       .slip_speed = 1}};
  return def;
}

TEST(AllElements, MoveAlikeInBothFormulations) {
  const MechanicsDef def = chain_with_all_elements();
  testing::Mechanism recursive(def), bodies(def);
  Dynamics in_joints(Formulation::recursive, recursive.model, recursive.state);
  Dynamics in_bodies(Formulation::lagrange, bodies.model, bodies.state);
  for (int i = 0; i < 500; ++i) {
    in_joints.evaluate(recursive.model, recursive.state, recursive.ws);
    ASSERT_TRUE(in_joints.advance(recursive.model, recursive.state, recursive.ws, 1e-3, {}, {}));
    in_bodies.evaluate(bodies.model, bodies.state, bodies.ws);
    ASSERT_TRUE(in_bodies.advance(bodies.model, bodies.state, bodies.ws, 1e-3, {}, {}));
  }
  EXPECT_NEAR(recursive.state.time, 0.5, 1e-12);
  EXPECT_NEAR(bodies.state.time, 0.5, 1e-12);
  recursive.see();
  EXPECT_NE(recursive.value("Rope.tension"), 0);
  EXPECT_NE(recursive.value("Wheel.normal_force"), 0);
  for (std::size_t i = 0; i < recursive.state.u.size(); ++i) {
    EXPECT_NEAR(recursive.state.u[i], bodies.state.u[i], 1e-7) << i;
  }
}

// what the joints carry is what the bodies' motion needs beyond the elements' forces: the sum over a floating body is
// zero
TEST(AllElements, AreTakenOffTheReactions) {
  testing::Mechanism mechanism(chain_with_all_elements());
  std::vector<JointReaction> reactions(mechanism.model.joints.size());
  joint_reactions(mechanism.model, mechanism.state, mechanism.ws, {}, reactions);
  const JointReaction& floating = reactions[2];
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(floating.force[k], 0, 1e-10);
    EXPECT_NEAR(floating.moment[k], 0, 1e-10);
    EXPECT_NEAR(reactions[1].moment[k], 0, 1e-10) << "a ball carries no moment";
  }
  EXPECT_NEAR(reactions[0].moment[2], 0, 1e-10) << "a hinge carries no moment about its axis";
}

TEST(FramePair, MeasuresTheRotationVectorAtAnyAngle) {
  FramePair pair;
  pair.R_L1 = pair.R_L2 = Mat3::identity();
  LinkMotion ground, body;
  ground.R = Mat3::identity();
  const Vec3 axis = Vec3(1, -2, 2) * (1.0 / 3);
  for (const double angle : {0.0, 1e-12, 1e-6, 1e-3, 2.1e-3, 0.5, 2.0, 3.1, 3.14159}) {
    body.R = Mat3::identity() + math::skew(axis) * std::sin(angle) +
             math::skew(axis) * math::skew(axis) * (2 * std::sin(angle / 2) * std::sin(angle / 2));
    const Deflection d = deflection_of(pair, ground, body);
    EXPECT_LT(norm(d.theta - axis * angle), 1e-13 + 1e-9 * (angle > 3)) << angle;
  }
}

}  // namespace elements_test
}  // namespace slew::multibody
