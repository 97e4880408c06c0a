// SPDX-License-Identifier: Apache-2.0
// Cases for peers, and differences between their results and ours, each relative to a stated scale.
//
// A peer is a class with
//   Peer(const MechanicsDef&)
//   void set_motion(const Motions&)                  takes poses and velocities
//   Motions accelerate(const Wrenches&)              with gravity and force elements; one wrench per body
#pragma once

#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "tests/peers/multibody/body_motion.h"
#include "tests/peers/multibody/def_laws.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

// The crane of scenes/truck_crane.yaml without its contacts, or a random tree
// (tests/properties/multibody/random_tree.h), at a random state.
// With loops: the crane with its cylinders as two bodies each (tests/validation/multibody/cylinder_bodies.h), a random
// mechanism (tests/properties/multibody/random_loops.h), or another scene, shortly after a start with random speeds
// that keep the loops closed.
struct Case {
  enum class Kind { truck_crane, random_tree, crane_cylinders, random_loops, scene } kind = Kind::random_tree;
  unsigned seed = 0;
  std::string scene{};  // in scenes/, without .yaml
};
[[nodiscard]] std::vector<Case> cases();
[[nodiscard]] std::vector<Case> loop_cases();
[[nodiscard]] std::string case_name(const ::testing::TestParamInfo<Case>& info);
void PrintTo(const Case& chosen, std::ostream* out);

enum class ForceDummies { with, without };

[[nodiscard]] bool has_loops(const Case& chosen);

struct Sample {
  Sample(const Case& chosen, ForceDummies dummies);

  MechanicsDef def;
  std::vector<std::string> rows;  // rows of a scene: its cylinders and drives, and joints with friction or limits
  State state;
  std::vector<double> row_forces;  // random, of the size that accelerates a row by 10 m/s2 or rad/s2
};

// Takes the larger of the two; non-finite values count as infinite, which std::max would ignore.
void grow(double& largest, double x);

[[nodiscard]] MechanicsDef truck_crane(std::vector<std::string>& rows);

// Masses and geometry alone: neither gravity nor laws of force elements.
[[nodiscard]] MechanicsDef bare(MechanicsDef def);
// Without dampers, so that energy is conserved.
[[nodiscard]] MechanicsDef undamped(MechanicsDef def);

// Loads of the row forces on the bodies.
[[nodiscard]] Wrenches row_wrenches(const Sample& sample, std::span<const double> row_forces, const Motions& motions);

[[nodiscard]] Motions at_rest(Motions motions);

// Largest difference over the bodies, relative to the largest quantity of all with 1 m between angular and linear ones,
// and at least to one SI unit.
[[nodiscard]] double velocity_difference(const Motions& a, const Motions& b);
[[nodiscard]] double acceleration_difference(const Motions& a, const Motions& b);
// Likewise of the joints' forces and moments.
[[nodiscard]] double reaction_difference(const std::vector<JointReaction>& a, const std::vector<JointReaction>& b);
// Whether joints hold more than they need, so that their reactions are not the only ones possible.
[[nodiscard]] bool has_redundant_rows(const Model& model);
// What two sets of joint reactions put on the bodies: the largest difference of the sums over a body's joints, as
// above.
[[nodiscard]] double load_difference(const MechanicsDef& def, const Motions& motions,
                                     const std::vector<JointReaction>& a, const std::vector<JointReaction>& b);
// Sum of squares of all forces [N] and moments [N m].
[[nodiscard]] double square_of(const std::vector<JointReaction>& reactions);
// Largest difference over the bodies [rad and m].
[[nodiscard]] double pose_difference(const Motions& a, const Motions& b);

// Rows: x [rad and m]; v and a relative to the largest, as above; W_kl to sqrt(W_kk W_ll).
struct RowDifference {
  double x = 0, v = 0, a = 0, W = 0;
};

// Ours under the sample's row forces, and the peer's.
template <typename Peer>
double accelerations_differ_by(const Sample& sample, const MechanicsDef& def_of_peer) {
  Mechanism ours(sample.def, sample.rows);
  forward_dynamics(ours.model, sample.state.q, sample.state.u, sample.row_forces, ours.ws);
  const Motions expected = motions_of(ours.model, ours.ws);
  Peer peer(def_of_peer);
  peer.set_motion(expected);
  const Motions got = peer.accelerate(row_wrenches(sample, sample.row_forces, expected));
  EXPECT_LT(pose_difference(got, expected), 1e-13) << "the peer's coordinates do not follow";
  EXPECT_LT(velocity_difference(got, expected), 1e-13) << "the peer's coordinates do not follow";
  return acceleration_difference(got, expected);
}

void expect_same_rows(const RowDifference& difference, double tolerance);

// A residual into the test's report.
void record(const std::string& name, double residual);

[[nodiscard]] RowDifference compare_rows(const Sample& sample, const Mechanism& ours, const Motions& free,
                                         const std::vector<double>& mobility);

// All values for a partner of the coupling. The peer's W: accelerations of the rows by unit forces on the bare
// mechanism at rest.
template <typename Peer>
RowDifference rows_differ_by(const Sample& sample) {
  Mechanism ours(sample.def, sample.rows);
  evaluate(ours.model, sample.state, ours.ws);
  const Motions moving = motions_of(ours.model, ours.ws), resting = at_rest(moving);
  Peer peer(sample.def), bare_peer(bare(sample.def));
  peer.set_motion(moving);
  const Motions free = peer.accelerate(Wrenches(moving.size()));
  bare_peer.set_motion(resting);
  std::vector<double> mobility;
  for (std::size_t k = 0; k < sample.rows.size(); ++k) {
    std::vector<double> unit_force(sample.rows.size(), 0.0);
    unit_force[k] = 1;
    const Motions pushed = bare_peer.accelerate(row_wrenches(sample, unit_force, resting));
    for (const std::string& row : sample.rows) mobility.push_back(row_motion(sample.def, row, pushed).a);
  }
  return compare_rows(sample, ours, free, mobility);
}

}  // namespace slew::multibody::testing
