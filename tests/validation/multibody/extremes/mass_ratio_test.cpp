// SPDX-License-Identifier: Apache-2.0
// Mass ratios to a million, both ways, and long chains: against the equations of a planar chain (planar_chain.h) and
// of the parallelogram's one coordinate, in every formulation. Bounds and figures: docs/extremes.md.
#include "tests/support/nightly.h"
#include "tests/validation/multibody/chain_def.h"
#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/extremes/outcome.h"
#include "tests/validation/multibody/extremes/planar_chain.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::multibody {
namespace mass_ratio_test {

using namespace testing;

constexpr double kLength = 0.5;

struct Weights {
  std::string name;
  std::vector<double> rods;  // kg
  double tip = 0;            // kg
};

MechanicsDef def_of(const Weights& weights) {
  MechanicsDef def = chain_def({.links = static_cast<int>(weights.rods.size()), .tip_mass = weights.tip});
  for (std::size_t i = 0; i < weights.rods.size(); ++i) {
    def.bodies[i].mass *= weights.rods[i];
    for (double& inertia : def.bodies[i].inertia) inertia *= weights.rods[i];
  }
  return def;
}

PlanarChain reference_of(const Weights& weights) {
  std::vector<PlanarRod> rods;
  for (const double mass : weights.rods) rods.push_back({mass, kLength});
  return {rods, weights.tip};
}

// largest distance of a rod's end from where it should be, and of what joints stand open [m]
double error_of(Formulated& chain, const PlanarChain& reference) {
  double error = opening(chain).position, angle = 0, x = 0, y = 0, x_ref = 0, y_ref = 0;
  const std::vector<double> angles = reference.angles();
  for (std::size_t i = 0; i < angles.size(); ++i) {
    angle += chain.state.q[i];
    x += kLength * std::cos(angle);
    y += kLength * std::sin(angle);
    x_ref += kLength * std::cos(angles[i]);
    y_ref += kLength * std::sin(angles[i]);
    const double distance = std::hypot(x - x_ref, y - y_ref);
    if (!(distance <= error)) error = distance;
  }
  return error;
}

class Extreme : public EveryFormulation {
 protected:
  static Outcome fall(const Weights& weights, double time, double step, int reference_steps) {
    Formulated chain = start(def_of(weights));
    PlanarChain reference = reference_of(weights);
    reference.run(time, reference_steps);
    Outcome outcome;
    outcome.is_flagged = !chain.try_run(time, step) || !is_finite(chain.state);
    outcome.error = error_of(chain, reference);
    return outcome;
  }
};

class MassRatio : public Extreme {};
class LongChain : public Extreme {};

const Weights kHeavyTip = {"1 kg carry 1e6 kg", std::vector<double>(10, 1.0), 1e6};
const Weights kLightTip = {"1 kg carry 1e-6 kg", {1, 1, 1, 1, 1, 1, 1, 1, 1, 1e-6}, 0};
const Weights kLightOnHeavy = {"1e6 kg carry 1 kg", {1e6, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 0};
const Weights kAlternating = {"1e6, 1, 1e6, 1, .. kg", {1e6, 1, 1e6, 1, 1e6, 1, 1e6, 1, 1e6, 1}, 0};

// Rods that carry a million times their mass are strings under a tension of 1e7 N, of up to 15e3 rad/s: steps of 0.1 ms
// resolve them. Those of 1 ms do not: an explicit rule drives them up, which is flagged at the latest when rods turn by
// more than half a radian a step or the state is not finite; augmented is implicit, penalty goes in parts.
TEST_P(MassRatio, OfAMillionOnAChainsTipIsRightWhereItsStringsAreResolved) {
  expect_outcome(kHeavyTip.name, setting(1e-4), fall(kHeavyTip, 0.5, 1e-4, 10000), 1e-3, Ending::right);
  // the parts of penalty take 20 s for half a second
  const double seconds = is(Formulation::penalty) && !slew::testing::is_nightly() ? 0.1 : 0.5;
  expect_outcome(kHeavyTip.name, setting(1e-3), fall(kHeavyTip, seconds, 1e-3, 10000), 1e-3,
                 is(Formulation::augmented) || is(Formulation::penalty) ? Ending::right : Ending::flagged);
}

TEST_P(MassRatio, OfAMillionElsewhereInAChainIsRight) {
  for (const Weights& weights : {kLightTip, kLightOnHeavy, kAlternating}) {
    expect_outcome(weights.name, setting(1e-3), fall(weights, 0.5, 1e-3, 5000), 1e-3, Ending::right);
  }
}

// parallelogram: (2 m_r / 3 + m_c) l^2 theta'' = (m_r + m_c) g l sin theta
TEST_P(MassRatio, OfAMillionInALoopEndsRight) {
  for (const auto& [rod, coupler] : {std::pair{1.0, 1e6}, {1e6, 1.0}, {1.0, 1e-6}}) {
    MechanicsDef def = four_bars(1);
    for (BodyDef& body : def.bodies) {
      const double mass = body.name[0] == 'R' ? rod : coupler;
      body.mass = mass;
      for (double& inertia : body.inertia) inertia *= mass;
    }
    const double rate = 9.81 * (rod + coupler) / (2 * rod / 3 + coupler);
    double theta = 0, omega = 1;
    constexpr int kSteps = 20000;
    constexpr double h = 2.0 / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double a1 = rate * std::sin(theta), w2 = omega + 0.5 * h * a1;
      const double a2 = rate * std::sin(theta + 0.5 * h * omega), w3 = omega + 0.5 * h * a2;
      const double a3 = rate * std::sin(theta + 0.5 * h * w2), w4 = omega + h * a3;
      const double a4 = rate * std::sin(theta + h * w3);
      theta += h / 6 * (omega + 2 * w2 + 2 * w3 + w4);
      omega += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    Formulated bars = start(def);
    Outcome outcome;
    outcome.is_flagged = !bars.try_run(2, 1e-3);
    const Triple tip = bars.pose("Coupler0").position;
    outcome.error = std::hypot(tip[0] - std::sin(theta), tip[1] - std::cos(theta)) + opening(bars).position;
    char name[64];
    std::snprintf(name, sizeof name, "four-bar, rods %g kg, coupler %g kg", rod, coupler);
    expect_outcome(name, setting(1e-3), outcome, 1e-3, Ending::right);
  }
}

TEST_P(LongChain, OfTenAHundredAndThreeHundredLinksFallsRight) {
  for (const int links : {10, 100, 300}) {
    const Weights weights = {std::to_string(links) + " links",
                             std::vector<double>(static_cast<std::size_t>(links), 1.0), 0};
    const double time = slew::testing::rounds(0.05, 0.5);
    const Outcome outcome = fall(weights, time, 1e-3, static_cast<int>(std::lround(time / 1e-3)));
    expect_outcome(weights.name, setting(1e-3), outcome, 1e-3, Ending::right);
  }
}

// the other rules, at the step of 1 ms: an iteration without convergence is flagged
class MassRatioUnder : public ::testing::TestWithParam<Choice> {};

TEST_P(MassRatioUnder, OfAMillionIsRightOrFlagged) {
  for (const Weights& weights : {kHeavyTip, kLightOnHeavy}) {
    const double time = slew::testing::rounds(0.2, 0.5);
    MechanicsDef def = def_of(weights);
    std::tie(def.formulation, def.integrator) = GetParam();
    Formulated chain(def);
    PlanarChain reference = reference_of(weights);
    reference.run(time, 10000);
    Outcome outcome;
    outcome.is_flagged = !chain.try_run(time, 1e-3) || !is_finite(chain.state);
    outcome.error = error_of(chain, reference);
    const bool is_euler = def.integrator == Integrator::semi_implicit_euler;
    const bool is_easy = weights.tip == 0;
    expect_outcome(weights.name, name_of(def.formulation) + " " + name_of(def.integrator) + ", 1 ms", outcome,
                   is_euler ? 5e-2 : 1e-3, is_easy ? Ending::right : Ending::settled);
  }
}

const Rules kRules = {Integrator::semi_implicit_euler, Integrator::trapezoidal, Integrator::generalised_alpha,
                      Integrator::sdirk2};
const Rules kInBodyCoordinates = {Integrator::trapezoidal};
INSTANTIATE_TEST_SUITE_P(In, MassRatioUnder, ::testing::ValuesIn(gate_choices(kRules, kInBodyCoordinates)),
                         kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, MassRatioUnder, ::testing::ValuesIn(nightly_choices(kRules, kInBodyCoordinates)),
                         kChoiceName);
INSTANTIATE_TEST_SUITE_P(In, MassRatio, kEveryFormulation, kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, LongChain, kEveryFormulation, kFormulationName);

}  // namespace mass_ratio_test
}  // namespace slew::multibody
