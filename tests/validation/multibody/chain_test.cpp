// SPDX-License-Identifier: Apache-2.0
// Case A11: chains with extreme mass ratios, in every formulation.
//
// Ten rods of 1 kg and 0.5 m on hinges fall from the horizontal, alone and with 1000 kg at the tip: minimal-coordinate
// solutions, position 1e-3 m, constraints 1e-8. Hanging: joint forces by statics, 1e-8 relative; frequencies from the
// stiffness and mass matrices of the chain's angles, which statics and geometry give in closed form.
// Figures: docs/validation/A11_chains.md.

#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/chain_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace chain_test {

using namespace testing;

constexpr int kLinks = 10;
constexpr double kLength = 0.5, kGravity = 9.81;

class Chain : public EveryFormulation {
 protected:
  static void expect(const Figure& figure, double step) { expect_figure("A11", setting(step), figure); }
};

Triple tip_of(const Mechanism& mechanism) {
  // the tip is twice as far from the hinge as the centre of the rod
  const BodyPose pose = mechanism.pose("Rod9");
  const auto& [w, x, y, z] = pose.orientation;
  return (math::Vec3(pose.position) + math::rotation_of({w, x, y, z}) * math::Vec3(kLength, 0, 0)).array();
}

struct Fall {
  double position = 0, open = 0;
  bool is_sound = true;
};

// along the table, until `end`
Fall fall(Formulated& chain, const char* table, double end, double step) {
  Fall worst;
  for (const auto& row : read_table(table)) {
    if (row[0] > end + 1e-9) break;
    if (row[0] > 0) worst.is_sound = chain.try_run(0.01, step) && worst.is_sound;
    const Triple tip = tip_of(chain);
    const double error = std::hypot(tip[0] - row[1], tip[1] - row[2]);
    if (!(error <= worst.position)) worst.position = error;
    worst.open = std::max(worst.open, opening(chain).position);
  }
  return worst;
}

TEST_P(Chain, OfTenRodsFallsAsTheReference) {
  const double step = is(Formulation::augmented) ? 2e-4 : 1e-3;
  Formulated chain = start(tuned(chain_def({}), 1e9, 30));
  const Fall worst = fall(chain, "chain10_uniform.csv", 1, step);
  EXPECT_TRUE(worst.is_sound);
  expect({"uniform: tip to 1 s [m]", worst.position, 1e-3}, step);
  expect({"uniform: constraint [m]", worst.open, 1e-8}, step);
}

TEST_P(Chain, WithAThousandfoldTipMassFallsAsTheReference) {
  const double step = is(Formulation::augmented) ? 2e-4 : 1e-3;
  Formulated chain = start(chain_def({.tip_mass = 1000}));
  const Fall worst = fall(chain, "chain10_tip1000.csv", 1, step);
  EXPECT_TRUE(worst.is_sound);
  expect({"1000 kg: tip to 1 s [m]", worst.position, 1e-3}, step);
  expect({"1000 kg: constraint [m]", worst.open, 1e-8}, step);
}

TEST_P(Chain, HangingCarriesItsWeightInItsJoints) {
  for (const auto& [tip, first, last] : {std::tuple{0.0, 98.1, 9.81}, {1000.0, 9908.1, 9819.81}}) {
    Formulated chain = start(chain_def({.tip_mass = tip, .direction = {0, -1, 0}}));
    chain.run(0.1, 1e-3);
    std::vector<JointReaction> reactions(kLinks);
    joint_reactions(chain.model, chain.state, chain.ws, {}, reactions);
    const double error =
        std::max({std::abs(reactions[0].force[1] / -first - 1), std::abs(reactions[9].force[1] / -last - 1),
                  std::abs(reactions[0].force[0]) / first});
    expect({tip > 0 ? "1000 kg: joint forces, relative" : "uniform: joint forces, relative", error, 1e-8}, 1e-3);
  }
}

// Small swings from the hanging position in one mode of the chain's angles follow cos(omega t): K v = omega^2 M v with
// K = diag(weight below the rod's centre x length), M from the rods' centres. Published: first and last frequency.
struct Mode {
  double omega;
  slew::testing::Dense<double> angles;
};
Mode mode_of(double tip_mass, int which) {
  slew::testing::Dense<double> M(kLinks, kLinks), K = M;
  const auto add = [&](double mass, int rods, double last) {
    for (int i = 0; i <= rods; ++i) {
      const double li = i == rods ? last : kLength;
      K(i, i) += mass * kGravity * li;
      for (int j = 0; j <= rods; ++j) M(i, j) += mass * li * (j == rods ? last : kLength);
    }
  };
  for (int i = 0; i < kLinks; ++i) {
    add(1, i, 0.5 * kLength);
    M(i, i) += kLength * kLength / 12;
  }
  add(tip_mass, kLinks - 1, kLength);
  const slew::testing::SymmetricModes modes = slew::testing::symmetric_modes(K, M);
  return {std::sqrt(modes.lambda[static_cast<std::size_t>(which)]), modes.vectors.col(which)};
}

TEST_P(Chain, HangingSwingsWithItsFrequencies) {
  constexpr struct {
    double tip, first, last;
  } kTable[] = {{0, 1.684746866468, 37.671398767}, {1000, 1.401875486544, 469.105906}};
  for (const auto& row : kTable) {
    for (const int which : {0, kLinks - 1}) {
      const double published = which == 0 ? row.first : row.last;
      const Mode mode = mode_of(row.tip, which);
      EXPECT_NEAR(mode.omega, published, 1e-7 * published);
      Formulated chain = start(chain_def({.tip_mass = row.tip, .direction = {0, -1, 0}}));
      const slew::testing::Dense<double> start_angles = mode.angles * (1e-5 / mode.angles.largest());
      for (int i = 0; i < kLinks; ++i) {
        chain.state.q[static_cast<std::size_t>(i)] = start_angles[i] - (i > 0 ? start_angles[i - 1] : 0);
      }
      chain.dynamics = Dynamics(GetParam(), chain.model, chain.state);
      // after a quarter of the period the angle is zero, or shows by how much the phase is missed
      const double quarter = 0.5 * M_PI / published, step = quarter / 400;
      chain.run(quarter, step);
      const double missed = std::abs(chain.state.q[0] / start_angles[0]) / (0.5 * M_PI);
      const std::string name = (row.tip > 0 ? "1000 kg: " : "uniform: ") + std::string(which == 0 ? "first" : "last") +
                               " frequency, relative";
      expect({name, missed, 1e-5}, step);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(In, Chain, kEveryFormulation, kFormulationName);

}  // namespace chain_test
}  // namespace slew::multibody
