// SPDX-License-Identifier: Apache-2.0
// What every mechanism keeps: momentum, energy, dissipation, power at the rows, frames, order of the integrator.
#include <gtest/gtest.h>

#include <cmath>

#include "math/rotation.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace invariants_test {

using namespace testing;
using namespace slew::testing;

double size_of(const Triple& t) {
  return std::hypot(t[0], t[1], t[2]);
}

double distance(const Triple& a, const Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

const std::vector<std::uint32_t> kSeeds = seeds(
    {{1, 16}, {kFirstWithModes, 16}, {kFirstWithShortening, 16}, {kFirstWithNodeDummies, 20}, {kFirstWithBoth, 10}});

RandomTree tree_of(std::uint32_t seed, const TreeOptions& options) {
  return random_tree(seed, with_modes_of(seed, options));
}

Mechanism moving(std::uint32_t seed, const RandomTree& tree, const std::vector<std::string>& rows = {}) {
  Mechanism mechanism(tree.def, rows);
  mechanism.state = random_state(seed, mechanism.model);
  // gentle enough for fixed steps of a random mechanism
  for (double& u : mechanism.state.u) u *= 0.25;
  mechanism.see();
  return mechanism;
}

TEST(Invariants, FloatingMechanismsKeepTheirMomentum) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    // inner springs, dampers and cylinders with mass; nothing from outside
    Mechanism mechanism = moving(
        seed, tree_of(seed, {.bodies = 5, .with_gravity = false, .lines_to_ground = false, .floating_root = true}));
    const Momentum before = momentum(mechanism.model, mechanism.ws);
    mechanism.run(0.5, 1e-4);
    const Momentum after = momentum(mechanism.model, mechanism.ws);
    EXPECT_LT(distance(before.linear, after.linear), 1e-8 * (1 + size_of(before.linear)));
    EXPECT_LT(distance(before.angular, after.angular), 1e-8 * (1 + size_of(before.angular)));
  });
}

RandomTree without_dampers(RandomTree tree) {
  for (auto& force : tree.def.translational_forces) force.damping_constant = force.end_damping_constant = 0;
  for (auto& force : tree.def.rotational_forces) force.damping_constant = 0;
  for (auto& body : tree.def.flexible_bodies) body.relative_damping = {0};
  // a rotational spring has no energy where its angle is not defined; lines and gravity suffice here
  tree.def.rotational_forces.clear();
  return tree;
}

TEST(Invariants, EnergyIsKeptWithoutDampers) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    Mechanism mechanism = moving(seed, without_dampers(tree_of(seed, {.bodies = 5})));
    const double before = mechanism.total_energy();
    double scale = std::abs(before), drift = 0;
    const int steps = slew::testing::rounds(250, 1000);
    for (int i = 0; i < steps; ++i) {
      // modes are faster
      mechanism.run(2e-4, seed < kFirstWithModes ? 2e-4 : 4e-5);
      scale = std::max(scale, energy(mechanism.model, mechanism.ws).kinetic);
      drift = std::max(drift, std::abs(mechanism.total_energy() - before));
    }
    EXPECT_LT(drift, 1e-7 * scale);
  });
}

TEST(Invariants, DampersOnlyTakeEnergy) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree = tree_of(seed, {.bodies = 5, .with_gravity = false});
    for (auto& force : tree.def.translational_forces) force.spring_constant = force.end_spring_constant = 0;
    for (auto& force : tree.def.rotational_forces) force.spring_constant = 0;
    Mechanism mechanism = moving(seed, tree);
    double before = mechanism.total_energy();
    for (int i = 0; i < 200; ++i) {
      mechanism.run(1e-3, 1e-3);
      EXPECT_LE(mechanism.total_energy(), before * (1 + 1e-9) + 1e-12);
      before = mechanism.total_energy();
    }
  });
}

TEST(Invariants, RowForcesDoTheWorkThatTheEnergyGains) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree = without_dampers(tree_of(seed, {.bodies = 4}));
    std::erase_if(tree.rows, [](const std::string& row) { return row[0] == 'R'; });
    Mechanism mechanism = moving(seed, tree, tree.rows);
    const std::size_t rows = tree.rows.size();
    const std::vector<double> force(rows, 2.0), zero(rows, 0.0);
    const double before = mechanism.total_energy();
    std::vector<double> start(rows);
    evaluate(mechanism.model, mechanism.state, mechanism.ws);
    for (std::size_t k = 0; k < rows; ++k) start[k] = row_positions(mechanism.ws)[k];
    for (int i = 0; i < 500; ++i) {
      evaluate(mechanism.model, mechanism.state, mechanism.ws);
      advance(mechanism.model, mechanism.state, mechanism.ws, 2e-4, force, zero);
    }
    evaluate(mechanism.model, mechanism.state, mechanism.ws);
    double work = 0;
    for (std::size_t k = 0; k < rows; ++k) work += force[k] * (row_positions(mechanism.ws)[k] - start[k]);
    mechanism.see();
    const double scale = 1 + std::abs(before) + std::abs(work) + energy(mechanism.model, mechanism.ws).kinetic;
    EXPECT_NEAR(mechanism.total_energy() - before, work, 1e-7 * scale);
  });
}

TEST(Invariants, TurnedAndMovedScenesMoveAlike) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const RandomTree tree = tree_of(seed, {.bodies = 6, .only_one_coordinate = true});
    RandomTree turned = tree;
    // everything hangs on one body that a fixed joint holds somewhere else
    const Triple place = {100, -50, 20}, angles = {0.4, 1.1, -0.7};
    const math::Mat3 R = math::rotation_zxz(angles);
    for (BodyDef& body : turned.def.bodies) {
      if (body.relative_to == "Ground") body.relative_to = "Frame";
    }
    for (JointDef& joint : turned.def.joints) {
      if (joint.body1 == "Ground") joint.body1 = "Frame";
      if (joint.body2 == "Ground") joint.body2 = "Frame";
    }
    for (auto& force : turned.def.translational_forces) {
      if (force.body1 == "Ground") force.body1 = "Frame";
      if (force.body2 == "Ground") force.body2 = "Frame";
    }
    turned.def.bodies.push_back(
        {.name = "Frame", .position = place, .orientation = angles, .mass = 1, .inertia = {1, 1, 1}});
    turned.def.joints.push_back({.name = "Hold", .type = JointType::fixed, .point1 = place, .body2 = "Frame"});
    JointDef& hold = turned.def.joints.back();
    hold.orientation1 = {std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0))};
    turned.def.gravity = (R * math::Vec3(tree.def.gravity)).array();

    Mechanism plain = moving(seed, tree, tree.rows), other(turned.def, tree.rows);
    // coordinates may come in another order: take them joint by joint
    for (const Joint& joint : plain.model.joints) {
      if (joint.link == 0) continue;
      const Link& from = plain.model.links[static_cast<std::size_t>(joint.link)];
      const Joint& twin = other.model.joints[static_cast<std::size_t>(find_joint(other.model, joint.name))];
      const Link& to = other.model.links[static_cast<std::size_t>(twin.link)];
      other.state.q[static_cast<std::size_t>(to.q)] = plain.state.q[static_cast<std::size_t>(from.q)];
      other.state.u[static_cast<std::size_t>(to.u)] = plain.state.u[static_cast<std::size_t>(from.u)];
    }
    for (std::size_t k = 0; k < plain.model.parts.size(); ++k) {
      const FlexiblePart &from = plain.model.parts[k], &to = other.model.parts[k];
      for (std::size_t j = 0; j < from.modes; ++j) {
        other.state.q[static_cast<std::size_t>(to.q) + j] = plain.state.q[static_cast<std::size_t>(from.q) + j];
        other.state.u[static_cast<std::size_t>(to.u) + j] = plain.state.u[static_cast<std::size_t>(from.u) + j];
      }
    }
    evaluate(plain.model, plain.state, plain.ws);
    evaluate(other.model, other.state, other.ws);
    const auto compare = [](std::span<const double> a, std::span<const double> b) {
      double scale = 1;
      for (const double x : a) scale = std::max(scale, std::abs(x));
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-9 * scale);
    };
    compare(row_positions(plain.ws), row_positions(other.ws));
    compare(row_speeds(plain.ws), row_speeds(other.ws));
    compare(row_free_accelerations(plain.ws), row_free_accelerations(other.ws));
    compare(row_mobility(plain.ws), row_mobility(other.ws));
  });
}

TEST(Invariants, ReactionsOnGroundChangeTheMomentum) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const RandomTree tree = tree_of(seed, {.bodies = 5, .with_forces = false, .lines_to_ground = false});
    Mechanism mechanism = moving(seed, tree);
    std::vector<JointReaction> reactions(mechanism.model.joints.size());
    joint_reactions(mechanism.model, mechanism.state, mechanism.ws, {}, reactions);
    Triple expected{};
    double mass = 0;
    for (const LumpedMass& part : mechanism.model.lumped) mass += part.link > 0 ? part.mass : 0;
    for (const CoupledMass& part : mechanism.model.coupled) mass += part.m1 + part.m2;
    for (std::size_t k = 0; k < 3; ++k) expected[k] = mass * mechanism.model.gravity[static_cast<int>(k)];
    for (std::size_t j = 0; j < reactions.size(); ++j) {
      const Joint& joint = mechanism.model.joints[j];
      if (joint.body1 != 0 && joint.body2 != 0) continue;
      const double sign = joint.body1 == 0 ? -1 : 1;
      for (std::size_t k = 0; k < 3; ++k) expected[k] += sign * reactions[j].force[k];
    }
    // bodies welded to Ground do not move: their weight is in their joints' reactions
    for (const LumpedMass& part : mechanism.model.lumped) {
      if (part.link != 0 || part.owner == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) expected[k] += part.mass * mechanism.model.gravity[static_cast<int>(k)];
    }
    for (const CoupledMass& part : mechanism.model.welded) {
      if (mechanism.model.lines[static_cast<std::size_t>(part.line)].link1 != 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        expected[k] += (part.m1 + part.m2) * mechanism.model.gravity[static_cast<int>(k)];
      }
    }
    State ahead = mechanism.state, back = mechanism.state;
    constexpr double kStep = 1e-4;
    advance_free(mechanism.model, ahead, mechanism.ws, kStep);
    advance_free(mechanism.model, back, mechanism.ws, -kStep);
    observe(mechanism.model, ahead, mechanism.ws);
    const Momentum p1 = momentum(mechanism.model, mechanism.ws);
    observe(mechanism.model, back, mechanism.ws);
    const Momentum p0 = momentum(mechanism.model, mechanism.ws);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR((p1.linear[k] - p0.linear[k]) / (2 * kStep), expected[k], 1e-4 * (1 + size_of(expected)));
    }
  });
}

TEST(Invariants, ReactionsDoNoWorkThroughTheFreeDirections) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const RandomTree tree = tree_of(seed, {.bodies = 6});
    Mechanism mechanism = moving(seed, tree);
    std::vector<JointReaction> reactions(mechanism.model.joints.size());
    joint_reactions(mechanism.model, mechanism.state, mechanism.ws, {}, reactions);
    for (std::size_t j = 0; j < reactions.size(); ++j) {
      const Joint& joint = mechanism.model.joints[j];
      const math::Vec3 f(reactions[j].force), n(reactions[j].moment);
      const double scale = 1 + math::norm(f) + math::norm(n);
      const math::Vec3 axis = mechanism.ws.motion[static_cast<std::size_t>(joint.link)].axis;
      if (joint.type == JointType::revolute) {
        EXPECT_NEAR(math::dot(n, axis), 0, 1e-10 * scale);
      }
      if (joint.type == JointType::prismatic) {
        EXPECT_NEAR(math::dot(f, axis), 0, 1e-10 * scale);
      }
      if (joint.type == JointType::spherical) {
        EXPECT_NEAR(math::norm(n), 0, 1e-10 * scale);
      }
      if (joint.type == JointType::floating) {
        EXPECT_NEAR(math::norm(n) + math::norm(f), 0, 1e-10 * scale);
      }
    }
  });
}

// final state of the actuated crane with forces that are linear in time over the whole run
std::vector<double> crane_after(double h) {
  MechanicsDef def = crane_def();
  const std::vector<std::string> rows = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};
  Mechanism crane(def, rows);
  const std::vector<double> slope = {2e4, -5e3, 3e3};
  const std::vector<double> start = {2.4e5, 1.05e5, 1e3};
  std::vector<double> mean(3);
  const int steps = static_cast<int>(std::lround(0.4 / h));
  for (int i = 0; i < steps; ++i) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] = start[k] + slope[k] * (i + 0.5) * h;
    evaluate(crane.model, crane.state, crane.ws);
    advance(crane.model, crane.state, crane.ws, h, mean, slope);
  }
  return crane.state.u;
}

TEST(Integrator, ConvergesWithFourthOrderUnderRowForces) {
  const auto error = [](const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
  };
  const std::vector<double> exact = crane_after(2.5e-4);
  const double coarse = error(crane_after(8e-3), exact), fine = error(crane_after(4e-3), exact);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3);
}

TEST(Integrator, KeepsQuaternionsUnit) {
  Mechanism crane(crane_def());
  crane.run(2, 1e-3);
  const Link& bag = crane.model.links.back();
  double square = 0;
  for (int k = 0; k < 4; ++k) square += std::pow(crane.state.q[static_cast<std::size_t>(bag.q + k)], 2);
  EXPECT_NEAR(square, 1, 1e-15);
}

}  // namespace invariants_test
}  // namespace slew::multibody
