// SPDX-License-Identifier: Apache-2.0
// Reactions of random trees and loops: they do no work through any velocity that the joints allow, they and the weight
// are what every body's momenta gain, and where rows are redundant they are the smallest ones, against a
// pseudo-inverse. Redundant rows do not change the motion.
#include "multibody/constraints/constraint.h"
#include "multibody/joints/joint_gauge.h"
#include "tests/properties/multibody/random_motion.h"
#include "tests/support/nightly.h"
#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace reactions_test {

using namespace testing;
using math::Vec3;
using slew::testing::Index;
using Matrix = slew::testing::Dense<long double>;
using Vector = slew::testing::Dense<long double>;

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

std::vector<JointReaction> reactions_of(Mechanism& mechanism) {
  std::vector<JointReaction> reactions(mechanism.model.joints.size());
  joint_reactions(mechanism.model, mechanism.state, mechanism.ws, {}, reactions);
  mechanism.see();
  return reactions;
}

// the joint's point of body 2, in Ground
Vec3 point_of(const Mechanism& mechanism, const Joint& joint) {
  const Body& body = mechanism.model.bodies[at(joint.body2)];
  const LinkMotion& m = mechanism.ws.motion[at(body.link)];
  return m.p + m.R * (body.p_LB + body.R_LB * joint.p_B2);
}

Vec3 velocity_at(const Mechanism& mechanism, int body, Vec3 point) {
  const LinkMotion& m = mechanism.ws.motion[at(mechanism.model.bodies[at(body)].link)];
  return m.v + cross(m.w, point - m.p);
}

// two seeds of three have loops, whose joints are of every type in twelve of them
constexpr std::uint32_t kGateSeeds = 24;

TEST(Reactions, DoNoWorkThroughAnyVelocityThatTheJointsAllow) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 600}}, kGateSeeds), [&](std::uint32_t seed) {
    Mechanism mechanism(random_mechanism(seed));
    if (mechanism.model.degrees_of_freedom() == 0) return;
    set_random_speeds(mechanism, seed, 1);
    const std::vector<JointReaction> reactions = reactions_of(mechanism);
    for (unsigned trial = 0; trial < 3; ++trial) {
      set_random_speeds(mechanism, seed + 100 * (trial + 1), 1);
      for (std::size_t j = 0; j < reactions.size(); ++j) {
        const Joint& joint = mechanism.model.joints[j];
        const Vec3 point = point_of(mechanism, joint), f(reactions[j].force), n(reactions[j].moment);
        const auto w = [&](int body) { return mechanism.ws.motion[at(mechanism.model.bodies[at(body)].link)].w; };
        const double power =
            dot(f, velocity_at(mechanism, joint.body1, point) - velocity_at(mechanism, joint.body2, point)) +
            dot(n, w(joint.body1) - w(joint.body2));
        EXPECT_NEAR(power, 0, 1e-10 * (1 + norm(f) + norm(n))) << joint.name << ", seed " << seed;
      }
    }
  });
}

// linear momentum, then angular momentum about the centre of mass, of every body of the scene
std::vector<Vec3> momenta(const Mechanism& mechanism) {
  std::vector<Vec3> result;
  for (std::size_t i = 1; i < mechanism.model.bodies.size(); ++i) {
    const Body& body = mechanism.model.bodies[i];
    const LinkMotion& m = mechanism.ws.motion[at(body.link)];
    const math::Mat3 R = m.R * body.R_LB;
    const Vec3 center = m.p + m.R * body.p_LB + R * body.c_B;
    const double mass = mechanism.model.lumped[at(body.lumped)].mass;
    result.push_back(velocity_at(mechanism, static_cast<int>(i), center) * mass);
    result.push_back(R * (body.I_B * (transpose(R) * m.w)));
  }
  return result;
}

// joints and weight only: the joints' load on each body equals the rate of its momenta, by differences in time
TEST(Reactions, MoveEveryBodyAsInNewtonAndEuler) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 360}}, kGateSeeds), [&](std::uint32_t seed) {
    MechanicsDef def = random_mechanism(seed);
    def.translational_forces.clear();
    def.rotational_forces.clear();
    def.force_dummies.clear();
    def.static_dummies.clear();
    Mechanism mechanism(def);
    if (mechanism.model.degrees_of_freedom() == 0) return;
    set_random_speeds(mechanism, seed, 0.5);
    const std::vector<JointReaction> reactions = reactions_of(mechanism);
    std::vector<Vec3> gained;
    for (std::size_t i = 1; i < mechanism.model.bodies.size(); ++i) {
      gained.push_back(mechanism.model.gravity * mechanism.model.lumped[at(mechanism.model.bodies[i].lumped)].mass);
      gained.emplace_back();
    }
    for (std::size_t j = 0; j < reactions.size(); ++j) {
      const Joint& joint = mechanism.model.joints[j];
      const Vec3 point = point_of(mechanism, joint), f(reactions[j].force), n(reactions[j].moment);
      for (const auto& [index, sign] : {std::pair{joint.body1, 1.0}, {joint.body2, -1.0}}) {
        if (index == 0) continue;
        const Vec3 center(mechanism.pose(mechanism.model.bodies[at(index)].name).center_of_mass);
        gained[2 * at(index) - 2] += f * sign;
        gained[2 * at(index) - 1] += (n + cross(point - center, f)) * sign;
      }
    }
    constexpr double kTiny = 1e-5;
    const State now = mechanism.state;
    ASSERT_TRUE(advance_free(mechanism.model, mechanism.state, mechanism.ws, kTiny));
    mechanism.see();
    const std::vector<Vec3> later = momenta(mechanism);
    copy_state(now, mechanism.state);
    ASSERT_TRUE(advance_free(mechanism.model, mechanism.state, mechanism.ws, -kTiny));
    mechanism.see();
    const std::vector<Vec3> earlier = momenta(mechanism);
    for (std::size_t k = 0; k < gained.size(); ++k) {
      const Vec3 rate = (later[k] - earlier[k]) * (0.5 / kTiny);
      EXPECT_LT(norm(rate - gained[k]), 1e-5 * (1 + norm(rate))) << "seed " << seed << ", body " << k / 2;
    }
  });
}

// Wrenches that a joint's rows can transmit to body 1, orthonormal, as force and moment about the joint's point.
Matrix transmitted(const Mechanism& mechanism, const std::vector<Constraint>& constraints, int joint) {
  const auto found = std::find_if(constraints.begin(), constraints.end(),
                                  [&](const Constraint& constraint) { return constraint.joint == joint; });
  const Joint& named = mechanism.model.joints[at(joint)];
  // a fixed joint within a link transmits everything
  if (found == constraints.end()) return named.type == JointType::fixed ? Matrix::identity(6) : Matrix(6, 0);
  if (found->rows.empty()) return Matrix(6, 0);
  std::vector<RowValue> rows(found->rows.size());
  const LinkMotion& m1 = mechanism.ws.motion[at(found->link1)];
  evaluate(*found, m1, mechanism.ws.motion[at(found->link2)], {}, rows);
  const Vec3 point = point_of(mechanism, named);
  Matrix B(6, static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vec3 f = rows[k].G.v1, n = rows[k].G.w1 + cross(m1.p - point, f);
    for (int i = 0; i < 3; ++i) {
      B(i, static_cast<Index>(k)) = f[i];
      B(3 + i, static_cast<Index>(k)) = n[i];
    }
  }
  return slew::testing::column_basis(B, 1e-12L);
}

// Total load of the joints on each body, by the wrenches of all of them: force and moment about the origin.
Matrix loads(const Mechanism& mechanism) {
  const auto bodies = static_cast<Index>(mechanism.model.bodies.size()) - 1;
  const auto joints = static_cast<Index>(mechanism.model.joints.size());
  Matrix A(6 * bodies, 6 * joints);
  for (Index j = 0; j < joints; ++j) {
    const Joint& joint = mechanism.model.joints[static_cast<std::size_t>(j)];
    const Vec3 p = point_of(mechanism, joint);
    Matrix shift = Matrix::identity(6);
    shift(4, 0) = p[2], shift(5, 0) = -p[1], shift(5, 1) = p[0];
    shift(3, 1) = -p[2], shift(3, 2) = p[1], shift(4, 2) = -p[0];
    // the two bodies of a joint differ, so that neither block is written twice
    if (joint.body1 > 0) A.put(6 * (joint.body1 - 1), 6 * j, shift);
    if (joint.body2 > 0) A.put(6 * (joint.body2 - 1), 6 * j, -shift);
  }
  return A;
}

Vector stacked(const std::vector<JointReaction>& reactions) {
  Vector w(6 * static_cast<Index>(reactions.size()));
  for (std::size_t j = 0; j < reactions.size(); ++j) {
    for (std::size_t k = 0; k < 3; ++k) {
      w[static_cast<Index>(6 * j + k)] = reactions[j].force[k];
      w[static_cast<Index>(6 * j + 3 + k)] = reactions[j].moment[k];
    }
  }
  return w;
}

// the joint that was added last once more, with the same frames: all of its rows are redundant
MechanicsDef doubled(MechanicsDef def) {
  JointDef twin = def.joints.back();
  twin.name += "_Twin";
  def.joints.push_back(twin);
  return def;
}

// r: what the joints put on the bodies, which the motion prescribes. Of all wrenches w = B x with A w = r the library's
// is the smallest one.
TEST(Reactions, OfRedundantLoopsAreThoseOfThePseudoInverse) {
  int redundant = 0;
  for (unsigned seed = 1; seed <= slew::testing::rounds(36U, 360U); ++seed) {
    Mechanism mechanism(doubled(random_loops(seed).def));
    if (mechanism.model.degrees_of_freedom() == 0) continue;
    set_random_speeds(mechanism, seed, 1);
    const Vector found = stacked(reactions_of(mechanism));
    const std::vector<Constraint> constraints = joint_constraints(mechanism.model);
    const auto joints = static_cast<Index>(mechanism.model.joints.size());
    Matrix B(6 * joints, 0);
    for (Index j = 0; j < joints; ++j) {
      const Matrix own = transmitted(mechanism, constraints, static_cast<int>(j));
      Matrix wrenches(6 * joints, own.cols());
      wrenches.put(6 * j, 0, own);
      B.append_columns(wrenches);
    }
    const Matrix A = loads(mechanism);
    const auto [x, rank] = slew::testing::smallest_solution(A * B, A * found, 1e-11L);
    if (rank < B.cols()) ++redundant;
    EXPECT_LT((B * x - found).largest(), 1e-9L * (1 + found.largest())) << "seed " << seed;
  }
  EXPECT_GT(redundant, 20);
}

class RedundantJoints : public EveryFormulation {};

TEST_P(RedundantJoints, DoNotChangeTheMotion) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 240}}, kGateSeeds), [&](std::uint32_t seed) {
    MechanicsDef def = random_loops(seed).def;
    def.formulation = GetParam();
    const MechanicsDef twice = doubled(def);
    Formulated single(def), twin(twice);
    if (single.model.degrees_of_freedom() == 0) return;
    ASSERT_EQ(single.model.degrees_of_freedom(), twin.model.degrees_of_freedom()) << "seed " << seed;
    set_random_speeds(single, seed, 0.5);
    copy_state(single.state, twin.state);
    restart(single, def);
    restart(twin, twice);
    EXPECT_TRUE(single.try_run(0.02, 1e-3) && twin.try_run(0.02, 1e-3)) << "seed " << seed;
    double error = 0, scale = 1;
    for (std::size_t i = 0; i < single.state.u.size(); ++i) {
      scale = std::max(scale, std::abs(single.state.u[i]));
      error = std::max(error, std::abs(single.state.u[i] - twin.state.u[i]));
    }
    EXPECT_LT(error, (is(Formulation::penalty) ? 1e-5 : 1e-7) * scale) << "seed " << seed;
  });
}

INSTANTIATE_TEST_SUITE_P(In, RedundantJoints, kEveryFormulation, kFormulationName);

}  // namespace reactions_test
}  // namespace slew::multibody
