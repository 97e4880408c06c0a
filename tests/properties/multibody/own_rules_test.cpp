// SPDX-License-Identifier: Apache-2.0
// Order of convergence of the rules that `augmented` (trapezoid, 2) and `penalty` (Runge-Kutta, 4) bring with them, on
// a tree and on loops. A penalty's motion is compared with its own in shorter steps: what its factor leaves does not
// fall with the step.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/multibody/chain_def.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/loop_defs.h"

namespace slew::multibody {
namespace own_rules_test {

using namespace testing;

class OwnRules : public EveryFormulation {
 protected:
  static std::vector<double> state_after(const MechanicsDef& def, double time, double step) {
    Formulated mechanism = start(def);
    mechanism.run(time, step);
    std::vector<double> all = mechanism.state.q;
    all.insert(all.end(), mechanism.state.u.begin(), mechanism.state.u.end());
    return all;
  }
  static void expect_order(const std::string& name, const MechanicsDef& def, double time, double step) {
    const std::vector<double> exact = state_after(def, time, step / 16);
    const auto error_at = [&](double h) {
      const std::vector<double> found = state_after(def, time, h);
      double largest = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, std::fabs(found[i] - exact[i]));
      return largest;
    };
    const double coarse = error_at(step), fine = error_at(step / 2), observed = std::log2(coarse / fine);
    EXPECT_NEAR(observed, order(), order() == 4 ? 0.5 : 0.25) << name << ": " << coarse << " and " << fine;
    RecordProperty(name, std::to_string(observed));
    if (std::getenv("SLEWRING_FIGURES") != nullptr) {
      std::printf("| %s | %s | %.2f |\n", name.c_str(), setting(step).c_str(), observed);
    }
  }
};

TEST_P(OwnRules, HaveTheirOrderOnAChain) {
  // in 10 ms penalties leave joints open by more than kHeldByPenalty
  expect_order("chain of three", chain_def({.links = 3}), 0.5, is(Formulation::augmented) ? 2e-3 : 5e-3);
}
TEST_P(OwnRules, HaveTheirOrderOnAFourBarThroughTheFlatPosition) {
  expect_order("four_bar", four_bars(1), 1, is(Formulation::augmented) ? 5e-3 : 4e-3);
}
TEST_P(OwnRules, HaveTheirOrderOnASpatialSliderCrank) {
  expect_order("slider_crank", slider_crank(), 0.1, is(Formulation::augmented) ? 2e-3 : 5e-3);
}

INSTANTIATE_TEST_SUITE_P(In, OwnRules, ::testing::Values(Formulation::augmented, Formulation::penalty),
                         kFormulationName);

}  // namespace own_rules_test
}  // namespace slew::multibody
