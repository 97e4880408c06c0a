// SPDX-License-Identifier: Apache-2.0
// Graphs of loops: trees of links that closing rows connect at random, beside each other, in rows, rings and nets. The
// entries that the sparse closing system omits are zero, its bits are those of the dense one, and body coordinates,
// which use no tree, find the same motion and the same rows.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "multibody/build/validate.h"
#include "multibody/constraints/loops.h"
#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/formulation.h"
#include "multibody/model/topology.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/loop_defs.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace loop_graph_test {

using namespace testing;
using namespace slew::testing;
using math::Vec3;

// relative to the largest entry
constexpr double kTolerance = 1e-9;
const std::vector<std::uint32_t> kSeeds = seeds({{1, 60}}, 12);

struct Graph {
  MechanicsDef def;
  std::vector<std::string> rows;
};

// Trees of links on balls and hinges; rods with balls at both ends between links of any two of them.
class RandomGraph {
 public:
  explicit RandomGraph(std::uint32_t seed) : random_(seed) {
    const int trees = integer(2, 7), depth = integer(1, 3);
    for (int i = 0; i < trees; ++i) plant(i, depth);
    const int bodies = static_cast<int>(graph_.def.bodies.size()), rods = integer(1, bodies);
    for (int i = 0; i < rods; ++i) close(i, integer(0, bodies - 1), integer(0, bodies - 1));
    for (int i = 0; i < 3; ++i) connect(i, integer(-1, bodies - 1), integer(0, bodies - 1));
  }

  [[nodiscard]] const Graph& graph() const { return graph_; }

 private:
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Triple point() { return {number(-0.3, 0.3), number(-0.3, 0.3), number(-0.3, 0.3)}; }
  static std::string body_of(int body) { return body < 0 ? "Ground" : "B" + std::to_string(body); }

  void plant(int tree, int depth) {
    for (int level = 0; level < depth; ++level) {
      const int body = static_cast<int>(graph_.def.bodies.size());
      const Triple position = {1.0 * tree, -0.7 * level, number(-0.2, 0.2)};
      graph_.def.bodies.push_back({.name = body_of(body),
                                   .position = position,
                                   .mass = number(0.5, 2),
                                   .center_of_mass = point(),
                                   .inertia = {0.1, 0.15, 0.2}});
      JointDef joint{.name = "J" + std::to_string(body), .body2 = body_of(body)};
      joint.type = number(0, 1) < 0.6 ? JointType::spherical : JointType::revolute;
      joint.body1 = level == 0 ? "Ground" : body_of(body - 1);
      const Triple above = level == 0 ? Triple{} : graph_.def.bodies[static_cast<std::size_t>(body) - 1].position;
      joint.point1 = (Vec3(position) - Vec3(above)).array();
      graph_.def.joints.push_back(joint);
    }
  }

  void close(int number_of_rod, int a, int b) {
    if (a == b) return;
    JointDef rod{.name = "Rod" + std::to_string(number_of_rod), .type = JointType::spherical_spherical};
    rod.body1 = body_of(a);
    rod.body2 = body_of(b);
    rod.point1 = point();
    rod.point2 = point();
    graph_.def.joints.push_back(rod);
  }

  void connect(int number_of_force, int a, int b) {
    if (a == b) return;
    const std::string name = "F" + std::to_string(number_of_force);
    graph_.def.translational_forces.push_back(
        {.name = name, .body1 = body_of(a), .point1 = point(), .body2 = body_of(b), .point2 = point()});
    graph_.rows.push_back(name);
  }

  std::mt19937 random_;
  Graph graph_;
};

struct Moving {
  explicit Moving(std::uint32_t seed) : graph(RandomGraph(seed).graph()), mechanism(graph.def, graph.rows) {
    std::mt19937 random(seed);
    State& state = mechanism.state;
    for (double& speed : state.u) speed = std::uniform_real_distribution<double>(-1, 1)(random);
    forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
    is_closed = !mechanism.model.has_closing_rows() || project(mechanism.model, state.q, state.u, mechanism.ws);
    evaluate(mechanism.model, state, mechanism.ws);
  }

  Graph graph;
  Mechanism mechanism;
  bool is_closed = false;
};

double difference(std::span<const double> a, std::span<const double> b) {
  double largest = 0, scale = 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::fabs(a[i] - b[i]));
    scale = std::max(scale, std::fabs(b[i]));
  }
  return largest / scale;
}

// entries not stored are zero, and the solution is the dense one, bit by bit
void expect_only_zeros_left_out(const Mechanism& mechanism) {
  const LoopWorkspace& loops = mechanism.ws.loops;
  const std::size_t rows = loops.rows.size(), speeds = mechanism.state.u.size();
  std::vector<double> W(rows * rows);
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t l = 0; l <= k; ++l) {
      double& sum = W[k * rows + l];
      for (std::size_t j = 0; j < speeds; ++j) sum += loops.residual[k * speeds + j] * loops.rate[l * speeds + j];
      const int entry = loops.factor.entry(static_cast<int>(k), static_cast<int>(l));
      ASSERT_EQ(entry < 0 ? 0.0 : loops.W[static_cast<std::size_t>(entry)], sum) << k << ", " << l;
    }
  }
  math::Semidefinite dense(static_cast<int>(rows));
  dense.factorize(W, mechanism.model.cut_reference, kDependent);
  EXPECT_EQ(loops.factor.rank(), dense.rank());
  EXPECT_EQ(loops.factor.smallest_pivot(), dense.smallest_pivot());
  std::vector<double> x(rows), y;
  for (std::size_t k = 0; k < rows; ++k) x[k] = std::sin(1.0 + static_cast<double>(k));
  y = x;
  loops.factor.solve(x);
  dense.solve(y);
  EXPECT_EQ(x, y);
}

// response of the closed mechanism to a port's unit force, with all rows and speeds
void expect_ports_reduced_by_all_rows(const Mechanism& mechanism) {
  const Model& model = mechanism.model;
  Workspace ws(mechanism.model);
  State state = mechanism.state;
  evaluate(model, state, ws);
  const std::size_t speeds = state.u.size();
  for (std::size_t port = 0; port < model.rows.size(); ++port) {
    // the loops stay closed under it
    for (std::size_t k = 0; k < ws.loops.rows.size(); ++k) {
      if (ws.loops.factor.is_redundant(static_cast<int>(k))) continue;
      double opening = 0, scale = 0;
      for (std::size_t j = 0; j < speeds; ++j) {
        const double part = ws.loops.residual[k * speeds + j] * ws.row_rate[port * speeds + j];
        opening += part;
        scale += std::fabs(part);
      }
      // below: the rounding of responses of about 1, at a port that can hardly move
      EXPECT_LE(std::fabs(opening), kTolerance * std::max(scale, 1e-5)) << port << ", " << k;
    }
    for (std::size_t other = 0; other <= port; ++other) {
      double w = 0;
      for (std::size_t j = 0; j < speeds; ++j)
        w += ws.row_residual[port * speeds + j] * ws.row_rate[other * speeds + j];
      EXPECT_EQ(ws.row_W[port * model.rows.size() + other], w) << port << ", " << other;
    }
  }
}

TEST(LoopGraph, LeavesOutZerosAlone) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const Moving moving(seed);
    expect_only_zeros_left_out(moving.mechanism);
    expect_ports_reduced_by_all_rows(moving.mechanism);
  });
}

// Rods may hold two joints in a ratio, which a gear then contradicts.
void leave_out_gears_in_conflict(MechanicsDef& def) {
  std::size_t left = 0;
  do {
    left = def.gears.size();
    Problems problems;
    validate(def, problems);
    for (const Problem& problem : problems) {
      std::erase_if(def.gears, [&](const GearDef& gear) { return gear.name == problem.path; });
    }
  } while (def.gears.size() < left);
}

// trees of every joint, with gears, flexible bodies, and dummies at their nodes
TEST(LoopGraph, LeavesOutZerosAloneBesideGearsAndFlexibleBodies) {
  int flexible = 0, geared = 0;
  for_each_seed(seeds({{1, 40}, {kFirstWithModes, 40}, {kFirstWithNodeDummies, 40}}), [&](std::uint32_t seed) {
    RandomTree tree = random_tree(seed, with_modes_of(seed, {.bodies = 3 + static_cast<int>(seed) % 8}));
    std::mt19937 random(seed);
    const auto body = [&] { return tree.def.bodies[random() % tree.def.bodies.size()].name; };
    for (int i = 0; i < 3; ++i) {
      JointDef rod{.name = "Rod" + std::to_string(i), .type = JointType::spherical_spherical};
      rod.body1 = body();
      rod.body2 = body();
      rod.point1 = {0.3, 0.1 * i, -0.2};
      if (rod.body1 != rod.body2) tree.def.joints.push_back(rod);
    }
    const JointDef* before = nullptr;
    for (const JointDef& joint : tree.def.joints) {
      if (joint.type != JointType::revolute) continue;
      if (before != nullptr && random() % 2 == 0) {
        tree.def.gears.push_back({.name = "Gear_" + joint.name, .joint1 = before->name, .joint2 = joint.name});
      }
      before = &joint;
    }
    for (JointDef& joint : tree.def.joints) joint.initial_velocity = kNotGiven;
    leave_out_gears_in_conflict(tree.def);
    Mechanism mechanism(tree.def, tree.rows);
    flexible += mechanism.model.parts.empty() ? 0 : 1;
    geared += mechanism.model.gears.empty() ? 0 : 1;
    evaluate(mechanism.model, mechanism.state, mechanism.ws);
    expect_only_zeros_left_out(mechanism);
    expect_ports_reduced_by_all_rows(mechanism);
  });
  EXPECT_GT(flexible, 0);
  EXPECT_GT(geared, 0);
}

TEST(LoopGraph, MovesAsInBodyCoordinates) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    Moving moving(seed);
    ASSERT_TRUE(moving.is_closed);
    Mechanism& mechanism = moving.mechanism;
    const Model& model = mechanism.model;
    const BodyModel body = build_body_model(model);
    Workspace ws(model);
    BodyWorkspace bws(model, body);
    State joints = mechanism.state;
    ASSERT_TRUE(evaluate(model, body, body_state(model, mechanism.state), joints, ws, bws));
    std::vector<double> forces;
    for (std::size_t k = 0; k < model.rows.size(); ++k) forces.push_back(10.0 * static_cast<double>(k) - 7);
    std::vector<double> udot(mechanism.state.u.size()), found, expected(6 * (model.links.size() - 1));
    accelerations(model, mechanism.ws, forces, udot);
    for (std::size_t i = 1; i < model.links.size(); ++i) {
      const LinkMotion& m = mechanism.ws.motion[i];
      for (const double x : (m.a + mechanism.ws.delta_a[i] + model.gravity).array()) found.push_back(x);
      for (const double x : (m.alpha + mechanism.ws.delta_alpha[i]).array()) found.push_back(x);
    }
    accelerations(model, body, bws, forces, expected);
    EXPECT_LT(difference(found, expected), kTolerance);
    EXPECT_LT(difference(mechanism.ws.row_a_free, ws.row_a_free), kTolerance);
    EXPECT_LT(difference(mechanism.ws.row_W, ws.row_W), kTolerance);
  });
}

TEST(LoopGraph, GoesTheWayOfTheAugmentedFormulation) {
  for_each_seed(seeds({{1, 20}}, 4), [](std::uint32_t seed) {
    const Moving moving(seed);
    const Model& model = moving.mechanism.model;
    std::vector<std::vector<double>> ends;
    for (const Formulation formulation : {Formulation::recursive, Formulation::augmented}) {
      Mechanism mechanism(moving.graph.def, moving.graph.rows);
      Dynamics dynamics(formulation, model, moving.mechanism.state);
      State state = moving.mechanism.state;
      const std::vector<double> none(model.rows.size(), 0.0);
      for (int i = 0; i < 500; ++i) {
        dynamics.evaluate(model, state, mechanism.ws);
        ASSERT_TRUE(dynamics.advance(model, state, mechanism.ws, 1e-4, none, none));
      }
      ends.emplace_back(state.q);
    }
    EXPECT_LT(difference(ends[0], ends[1]), 1e-5);
  });
}

// entries of the closing system for each loop: the same for five loops as for forty
TEST(LoopGraph, OfFourBarsInARowHasAsManyEntriesALoop) {
  const auto entries = [](int loops) {
    const Mechanism mechanism(four_bars(loops));
    return mechanism.ws.loops.factor.entry_count();
  };
  const int first = entries(5), second = entries(6), added = second - first;
  EXPECT_EQ(entries(12), first + 7 * added);
  EXPECT_EQ(entries(20), first + 15 * added);
}

// the four-bars loop by loop: every pin to Ground but the first is the last joint of a loop
MechanicsDef listed_by_loops(int loops) {
  MechanicsDef def = four_bars(loops);
  const std::vector<JointDef> joints = std::exchange(def.joints, {});
  const auto take = [&](int joint) { def.joints.push_back(joints[static_cast<std::size_t>(joint)]); };
  take(0);
  for (int i = 0; i < loops; ++i) {
    take(loops + 1 + 2 * i);
    take(loops + 2 + 2 * i);
    take(i + 1);
  }
  return def;
}

TEST(LoopGraph, OfManyLoopsDoesNotLeadThroughAllOfThemWhateverTheFilesOrder) {
  Mechanism by_kind(four_bars(20)), by_loops(listed_by_loops(20));
  EXPECT_EQ(by_loops.ws.loops.factor.entry_count(), by_kind.ws.loops.factor.entry_count());
  for (Mechanism* mechanism : {&by_kind, &by_loops}) mechanism->run(0.2, 1e-3);
  for (const char* body : {"Rod0", "Rod20", "Coupler11"}) {
    const math::Vec3 p(by_kind.pose(body).position), other(by_loops.pose(body).position);
    EXPECT_LT(norm(p - other), 1e-9) << body;
  }
}

// a few loops are cut by the order of the file
TEST(LoopGraph, OfFewLoopsHasTheTreeOfTheFile) {
  Problems problems;
  const MechanicsDef def = listed_by_loops(4);
  std::vector<std::string> cuts;
  for (const int joint : cut_joints(def, find_tree(def, problems))) {
    cuts.push_back(def.joints[static_cast<std::size_t>(joint)].name);
  }
  EXPECT_EQ(cuts, (std::vector<std::string>{"Pin1", "Pin2", "Pin3", "Pin4"}));
}

TEST(LoopGraph, OfLoopsBesideEachOtherHasThoseOfEachAlone) {
  const auto beside = [](int count) {
    MechanicsDef def;
    for (int i = 0; i < count; ++i) {
      MechanicsDef one = four_bars(1);
      const std::string mark = "_" + std::to_string(i);
      for (BodyDef& body : one.bodies) {
        body.name += mark;
        body.position[0] += 3.0 * i;
        def.bodies.push_back(body);
      }
      for (JointDef& joint : one.joints) {
        joint.name += mark;
        if (joint.body1 == "Ground") joint.point1[0] += 3.0 * i;
        if (joint.body1 != "Ground") joint.body1 += mark;
        joint.body2 += mark;
        def.joints.push_back(joint);
      }
    }
    return def;
  };
  const Mechanism one(beside(1)), many(beside(9));
  EXPECT_EQ(many.ws.loops.factor.entry_count(), 9 * one.ws.loops.factor.entry_count());
  EXPECT_EQ(many.ws.loops.pattern.blocks.size(), 9 * one.ws.loops.pattern.blocks.size());
}

}  // namespace loop_graph_test
}  // namespace slew::multibody
