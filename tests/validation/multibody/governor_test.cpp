// SPDX-License-Identifier: Apache-2.0
// Case A05 (Chrono and Radau: 3e-11): flyball governor with struts of 8e5 N/m and 4e4 N s/m. Tolerance: slider within
// 1e-3 m at 10 s, in sub-steps of 1 ms and of 2 ms; in 5 and 10 ms, where the explicit rules leave the page, the slow
// motion's own error of the order h^2 shows.
#include "tests/support/nightly.h"
#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/governor_def.h"

namespace slew::multibody {
namespace governor_test {

using testing::Choice;
using testing::Formulated;

constexpr double kSliderAt1s = 0.5014209224, kSliderAt10s = 0.6196229171, kSpinAt10s = 5.5482036227;

class Governor : public ::testing::TestWithParam<Choice> {
 protected:
  [[nodiscard]] static Formulated start() {
    MechanicsDef def = testing::governor_def();
    std::tie(def.formulation, def.integrator) = GetParam();
    return Formulated(def);
  }
  static void expect_figures(const Formulated& governor, double error, double step) {
    const std::string setting = testing::name_of(std::get<0>(GetParam())) + " " +
                                testing::name_of(std::get<1>(GetParam())) + ", " + testing::in_milliseconds(step);
    testing::expect_figure("A05", setting, {"slider to 10 s [m]", error, 1e-3});
    testing::expect_figure("A05", setting, {"slider at 10 s [m]", std::abs(slider(governor) - kSliderAt10s), 1e-3});
    testing::expect_figure("A05", setting,
                           {"spin at 10 s [rad/s]", std::abs(governor.value("Spin.velocity") - kSpinAt10s), 1e-2});
  }
  [[nodiscard]] static double slider(const Formulated& governor) { return governor.pose("Slider").position[2]; }
};

class ExplicitGovernor : public Governor {};

// The rules of the formulations that hold joints by penalties are their own: `augmented` is implicit, `penalty` is
// Runge-Kutta, which needs sub-steps below the struts' own.
class HeldGovernor : public testing::EveryFormulation {};

TEST_P(Governor, FollowsTheReferenceInStepsOf1ms) {
  Formulated governor = start();
  double error = 0, time = 0;
  for (const auto& row : testing::read_table("A05_flyball_2pi.csv")) {
    governor.run(row[0] - time, 1e-3);
    time = row[0];
    error = std::max(error, std::abs(slider(governor) - row[1]));
  }
  EXPECT_NEAR(time, 10, 1e-9);
  expect_figures(governor, error, 1e-3);
}

TEST_P(Governor, IsStableAndNearInStepsOf10ms) {
  for (const double h : {2e-3, 5e-3, 10e-3}) {
    Formulated governor = start();
    governor.run(10, h);
    // second order: 1e-3 m at 4 ms in the coarsest of them
    EXPECT_NEAR(slider(governor), kSliderAt10s, std::max(1e-3, 1e-3 * h * h / 16e-6)) << h;
  }
}

// struts are stiff for Runge-Kutta beyond 2.78 / 8117 s, for Euler beyond 2 / 8117 s
TEST_P(ExplicitGovernor, FollowsTheReferenceInStepsBelowTheStrutsOwn) {
  const bool is_rk4 = std::get<1>(GetParam()) == Integrator::rk4;
  Formulated governor = start();
  governor.run(1, is_rk4 ? 2.5e-4 : 1e-4);
  EXPECT_NEAR(slider(governor), kSliderAt1s, is_rk4 ? 1e-8 : 1e-3);
}

TEST_P(HeldGovernor, FollowsTheReference) {
  const double step = is(Formulation::augmented) ? 1e-3 : 2.5e-4;
  // short steps: all 10 s in the nightly run
  const double end = is(Formulation::augmented) ? 10 : slew::testing::rounds(3.0, 10.0);
  Formulated governor = start(testing::governor_def());
  double error = 0, time = 0;
  for (const auto& row : testing::read_table("A05_flyball_2pi.csv")) {
    if (row[0] > end + 1e-9) break;
    if (row[0] > time) governor.run(row[0] - time, step);
    time = row[0];
    error = std::max(error, std::abs(governor.pose("Slider").position[2] - row[1]));
  }
  testing::expect_figure("A05", setting(step), {end == 10 ? "slider to 10 s [m]" : "slider to 3 s [m]", error, 1e-3});
  testing::expect_figure("A05", setting(step), {"constraint [m]", testing::opening(governor).position, 1e-8});
}

const testing::Rules kImplicit = {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2};
const testing::Rules kExplicit = {Integrator::rk4, Integrator::semi_implicit_euler};
const testing::Rules kImplicitInBodyCoordinates = {Integrator::trapezoidal};
const testing::Rules kExplicitInBodyCoordinates = {Integrator::rk4};
INSTANTIATE_TEST_SUITE_P(In, Governor,
                         ::testing::ValuesIn(testing::gate_choices(kImplicit, kImplicitInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, Governor,
                         ::testing::ValuesIn(testing::nightly_choices(kImplicit, kImplicitInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(In, ExplicitGovernor,
                         ::testing::ValuesIn(testing::gate_choices(kExplicit, kExplicitInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, ExplicitGovernor,
                         ::testing::ValuesIn(testing::nightly_choices(kExplicit, kExplicitInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(In, HeldGovernor, ::testing::Values(Formulation::augmented, Formulation::penalty),
                         testing::kFormulationName);

}  // namespace governor_test
}  // namespace slew::multibody
