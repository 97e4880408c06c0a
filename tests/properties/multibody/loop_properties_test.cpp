// SPDX-License-Identifier: Apache-2.0
// What random trees and loops keep in every formulation: degrees of freedom, momentum, rates that are derivatives, and
// the same motion under each.
#include "multibody/constraints/constraint.h"
#include "tests/properties/multibody/random_motion.h"
#include "tests/support/nightly.h"
#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace loop_properties_test {

using namespace testing;
using math::Vec3;
using slew::testing::Index;
using Matrix = slew::testing::Dense<long double>;

// ---- degrees of freedom -------------------------------------------------------------------------------------------

// Gradients of all rows of all joints with respect to the six speeds of every link.
Matrix jacobian(const Model& model, const Workspace& ws) {
  const std::vector<Constraint> joints = joint_constraints(model);
  const auto links = static_cast<Index>(model.links.size()) - 1;
  Matrix G(0, 6 * links);
  for (const Constraint& joint : joints) {
    std::vector<RowValue> values(joint.rows.size());
    const auto motion = [&](int link) -> const LinkMotion& { return ws.motion[static_cast<std::size_t>(link)]; };
    evaluate(joint, motion(joint.link1), motion(joint.link2), {}, values);
    for (const RowValue& value : values) {
      G.append_rows(Matrix(1, G.cols()));
      const auto put = [&](int link, Vec3 v, Vec3 w) {
        if (link == 0) return;
        for (int k = 0; k < 3; ++k) {
          G(G.rows() - 1, 6 * (link - 1) + k) += v[k];
          G(G.rows() - 1, 6 * (link - 1) + 3 + k) += w[k];
        }
      };
      put(joint.link1, value.G.v1, value.G.w1);
      put(joint.link2, value.G.v2, value.G.w2);
    }
  }
  return G;
}

// two seeds of three have loops, whose joints are of every type in twelve of them
constexpr std::uint32_t kGateSeeds = 24;
const std::vector<std::uint32_t> kSeeds = slew::testing::seeds({{1, 240}}, kGateSeeds);

TEST(DegreesOfFreedom, AreSixALinkLessTheRankOfAllRows) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 600}}, kGateSeeds), [&](std::uint32_t seed) {
    Mechanism mechanism(random_mechanism(seed));
    const auto links = static_cast<Index>(mechanism.model.links.size()) - 1;
    if (links == 0) return;
    const Matrix G = jacobian(mechanism.model, mechanism.ws);
    const Index rank = G.rows() == 0 ? 0 : slew::testing::column_rank(G, 1e-9L);
    EXPECT_EQ(mechanism.model.degrees_of_freedom(), 6 * links - rank) << "seed " << seed;
    const Description text = describe(mechanism.model);
    EXPECT_EQ(text.degrees_of_freedom, 6 * links - rank) << "seed " << seed;
    // the number of redundant rows equals the rank deficiency
    Index redundant = 0;
    for (const CutDescription& cut : text.cuts) redundant += static_cast<Index>(cut.redundant.size());
    EXPECT_EQ(redundant, G.rows() - rank) << "seed " << seed;
  });
}

// ---- momentum, energy ---------------------------------------------------------------------------------------------

class LoopProperties : public EveryFormulation {
 protected:
  // Near a singular position what a row gives is divided by little: joints that are held by penalties then give much,
  // and the trapezoid of `augmented` is far from its limit.
  [[nodiscard]] static bool is_left_out(Mechanism& mechanism) {
    if (mechanism.model.degrees_of_freedom() == 0) return true;
    if (is(Formulation::recursive) || is(Formulation::lagrange) || mechanism.model.cuts.empty()) return false;
    renew_matrix(mechanism.model, mechanism.state.q, mechanism.state.u, mechanism.ws);
    const bool is_near = is_near_singular(mechanism.ws);
    mechanism.see();
    return is_near;
  }
};

TEST_P(LoopProperties, FloatingLoopsKeepTheirMomentum) {
  slew::testing::for_each_seed(kSeeds, [&](std::uint32_t seed) {
    MechanicsDef def = random_floating_loops(seed).def;
    def.formulation = GetParam();
    Formulated mechanism(def);
    set_random_speeds(mechanism, seed, 0.5);
    restart(mechanism, def);
    const Momentum before = momentum(mechanism.model, mechanism.ws);
    EXPECT_TRUE(mechanism.try_run(0.1, 5e-4)) << "seed " << seed;
    const Momentum after = momentum(mechanism.model, mechanism.ws);
    const double scale = 1 + norm(Vec3(before.linear)) + norm(Vec3(before.angular));
    // speeds of the trapezoid are those of origins, not of centres of mass: momentum is kept to second order
    const double turning = is(Formulation::augmented) ? 1e-4 : is(Formulation::penalty) ? 1e-5 : 1e-7;
    const double moving = is(Formulation::augmented) ? 1e-4 : is(Formulation::penalty) ? 1e-5 : 1e-7;
    EXPECT_LT(norm(Vec3(after.linear) - Vec3(before.linear)), moving * scale) << "seed " << seed;
    EXPECT_LT(norm(Vec3(after.angular) - Vec3(before.angular)), turning * scale) << "seed " << seed;
  });
}

TEST_P(LoopProperties, EnergyIsKeptWithoutDampers) {
  slew::testing::for_each_seed(kSeeds, [&](std::uint32_t seed) {
    MechanicsDef def = random_mechanism(seed);
    def.formulation = GetParam();
    for (auto& force : def.translational_forces) force.damping_constant = force.end_spring_constant = 0;
    for (auto& force : def.translational_forces) force.end_damping_constant = 0;
    def.rotational_forces.clear();
    Formulated mechanism(def);
    if (is_left_out(mechanism)) return;
    set_random_speeds(mechanism, seed, 0.3);
    restart(mechanism, def);
    const double before = mechanism.total_energy();
    double scale = 1 + std::abs(before), drift = 0;
    for (int i = 0; i < 10; ++i) {
      EXPECT_TRUE(mechanism.try_run(0.01, 5e-4)) << "seed " << seed;
      scale = std::max(scale, energy(mechanism.model, mechanism.ws).kinetic);
      drift = std::max(drift, std::abs(mechanism.total_energy() - before));
    }
    const double bound = is(Formulation::augmented) ? 1e-4 : is(Formulation::penalty) ? 1e-5 : 1e-7;
    EXPECT_LT(drift, bound * scale) << "seed " << seed;
  });
}

// ---- derivatives --------------------------------------------------------------------------------------------------

// Rows of the forces: their speeds are the derivative of their coordinates, their free accelerations of their speeds.
TEST_P(LoopProperties, SpeedsAndAccelerationsOfRowsAreDerivatives) {
  slew::testing::for_each_seed(kSeeds, [&](std::uint32_t seed) {
    MechanicsDef def = random_mechanism(seed);
    def.formulation = GetParam();
    std::vector<std::string> rows;
    for (const TranslationalForceDef& force : def.translational_forces) {
      Problems problems;
      validate_rows(def, std::vector<std::string>{force.name}, problems);
      if (problems.empty()) rows.push_back(force.name);
    }
    Formulated mechanism(def, rows);
    if (is_left_out(mechanism) || rows.empty()) return;
    set_random_speeds(mechanism, seed, 0.5);
    restart(mechanism, def);
    mechanism.dynamics.evaluate(mechanism.model, mechanism.state, mechanism.ws);
    const Workspace& ws = mechanism.ws;
    const std::vector<double> x0 = ws.row_x, v0 = ws.row_v, a0 = ws.row_a_free, none(rows.size());
    constexpr double kTiny = 2e-5;
    mechanism.run(2 * kTiny, kTiny);
    mechanism.dynamics.evaluate(mechanism.model, mechanism.state, mechanism.ws);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double scale = 1 + std::abs(v0[k]) + std::abs(a0[k]) + std::abs(ws.row_a_free[k]);
      const double mean_a = 0.5 * (a0[k] + ws.row_a_free[k]), mean_v = 0.5 * (v0[k] + ws.row_v[k]);
      EXPECT_NEAR((ws.row_v[k] - v0[k]) / (2 * kTiny), mean_a, 1e-4 * scale) << rows[k] << ", seed " << seed;
      EXPECT_NEAR((ws.row_x[k] - x0[k]) / (2 * kTiny), mean_v, 1e-6 * scale) << rows[k] << ", seed " << seed;
    }
  });
}

// Rows of the joints: g' and g'' = G a + b are the derivatives of g and g', away from where they are zero: links that
// fly past each other.
TEST(JointRows, OfRandomMechanismsHaveTheirRatesAsDerivatives) {
  slew::testing::for_each_seed(slew::testing::seeds({{1, 300}}, kGateSeeds), [&](std::uint32_t seed) {
    Mechanism mechanism(random_mechanism(seed));
    const std::vector<Constraint> joints = joint_constraints(mechanism.model);
    std::mt19937 random(seed);
    const auto vector = [&](double size) {
      std::uniform_real_distribution<double> number(-size, size);
      return Vec3{number(random), number(random), number(random)};
    };
    // Ground falls upwards in the place of gravity
    mechanism.ws.motion[0].a = Vec3();
    for (std::size_t i = 1; i < mechanism.ws.motion.size(); ++i) {
      LinkMotion& m = mechanism.ws.motion[i];
      m.R = math::rotation_xyz(vector(0.3).array()) * m.R;
      m.p += vector(0.2);
      m.v = vector(1);
      m.w = vector(1);
      m.a = vector(1);
      m.alpha = vector(1);
    }
    // w and v grow evenly: R(t) = exp(t w + t^2/2 alpha) R to second order, which central differences see
    const auto at_time = [&](double t) {
      std::vector<LinkMotion> moved = mechanism.ws.motion;
      for (std::size_t i = 1; i < moved.size(); ++i) {
        LinkMotion& m = moved[i];
        const Vec3 turn = m.w * t + m.alpha * (0.5 * t * t);
        const double angle = norm(turn);
        const Vec3 axis = turn * (std::sin(0.5 * angle) / angle);
        m.R = math::rotation_of({std::cos(0.5 * angle), axis[0], axis[1], axis[2]}) * m.R;
        m.p += m.v * t + m.a * (0.5 * t * t);
        m.v += m.a * t;
        m.w += m.alpha * t;
      }
      return moved;
    };
    constexpr double h = 1e-4;
    const std::vector<LinkMotion> now = mechanism.ws.motion, before = at_time(-h), after = at_time(h);
    for (const Constraint& joint : joints) {
      const std::size_t count = joint.rows.size(), l1 = static_cast<std::size_t>(joint.link1),
                        l2 = static_cast<std::size_t>(joint.link2);
      std::vector<RowValue> here(count), back(count), ahead(count);
      evaluate(joint, now[l1], now[l2], {}, here);
      evaluate(joint, before[l1], before[l2], {}, back);
      evaluate(joint, after[l1], after[l2], {}, ahead);
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_NEAR(here[k].rate, (ahead[k].g - back[k].g) / (2 * h), 1e-6) << "seed " << seed;
        EXPECT_NEAR(acceleration_of(here[k], now[l1], now[l2]), (ahead[k].rate - back[k].rate) / (2 * h), 1e-5)
            << "seed " << seed;
      }
    }
  });
}

// ---- one motion ---------------------------------------------------------------------------------------------------

TEST_P(LoopProperties, MovesAsTheRecursionDoes) {
  slew::testing::for_each_seed(kSeeds, [&](std::uint32_t seed) {
    MechanicsDef def = random_mechanism(seed);
    Formulated recursive(def);
    if (is_left_out(recursive)) return;
    set_random_speeds(recursive, seed, 0.5);
    def.formulation = GetParam();
    Formulated other(def);
    copy_state(recursive.state, other.state);
    restart(other, def);
    def.formulation = Formulation::recursive;
    restart(recursive, def);
    EXPECT_TRUE(recursive.try_run(0.02, 2e-4) && other.try_run(0.02, 2e-4)) << "seed " << seed;
    double error = 0, scale = 1;
    for (const BodyDef& body : def.bodies) {
      const BodyPose a = recursive.pose(body.name), b = other.pose(body.name);
      scale = std::max({scale, norm(Vec3(a.velocity)), norm(Vec3(a.angular_velocity))});
      error = std::max({error, norm(Vec3(a.center_of_mass) - Vec3(b.center_of_mass)),
                        norm(Vec3(a.velocity) - Vec3(b.velocity)),
                        norm(Vec3(a.angular_velocity) - Vec3(b.angular_velocity))});
    }
    const double bound = is(Formulation::augmented) ? 1e-4 : is(Formulation::penalty) ? 1e-4 : 1e-8;
    EXPECT_LT(error, bound * scale) << "seed " << seed;
  });
}

INSTANTIATE_TEST_SUITE_P(In, LoopProperties, kEveryFormulation, kFormulationName);

}  // namespace loop_properties_test
}  // namespace slew::multibody
