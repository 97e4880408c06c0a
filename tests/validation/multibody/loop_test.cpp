// SPDX-License-Identifier: Apache-2.0
// Cases A02 (N four-bars through singular positions), A03 (Andrews' squeezer), A08 (spatial slider-crank).
//
// A02: IFToMM; the parallelogram branch is an ODE of one coordinate. Tolerances: position 1e-3 m at 10 s, energy 1e-4.
// A03: Bari IVP test set; angles within 1e-4 at a fixed step of 1e-5 s, loops within 1e-9 m.
// A08: Haug, IFToMM; slider within 2e-4 m, crank within 1e-2 rad at 5 s.
// Figures: docs/validation/A02_four_bars.md, A03_squeezer.md, A08_slider_crank.md.
#include "multibody/build/validate.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"
#include "tests/validation/multibody/loop_defs.h"
#include "tests/validation/multibody/squeezer_def.h"

namespace slew::multibody {
namespace loop_test {

using testing::expect_figure;
using testing::Formulated;
using testing::four_bars;
using testing::opening;
using testing::slider_crank;

class FourBars : public testing::EveryFormulation {
 protected:
  static void follow_table(Formulated& bars, int n, const std::string& table, double step) {
    const double begin = bars.total_energy();
    double error = 0, drift = 0, time = 0, open = 0;
    for (const auto& row : testing::read_table(table)) {
      if (row[0] > time) bars.run(row[0] - time, step);
      time = row[0];
      const BodyPose pose = bars.pose("Coupler0");
      error = std::max({error, std::abs(pose.position[0] - row[1]), std::abs(pose.position[1] - row[2])});
      drift = std::max(drift, std::abs(bars.total_energy() - begin) / begin);
      open = std::max(open, opening(bars).position);
    }
    EXPECT_NEAR(time, 10, 1e-9);
    const std::string which = "N=" + std::to_string(n) + ": ";
    expect_figure("A02", setting(step), {which + "B0 to 10 s [m]", error, 1e-3});
    expect_figure("A02", setting(step), {which + "energy, relative", drift, 1e-4});
    expect_figure("A02", setting(step), {which + "constraint [m]", open, 1e-8});
  }
};

class Squeezer : public testing::EveryFormulation {};
class SliderCrank : public testing::EveryFormulation {};

TEST_P(FourBars, OneFollowsItsBranchThroughTheFlatPositions) {
  Formulated bars = start(four_bars(1));
  follow_table(bars, 1, "A02_N1_spatial_redundant.csv", 1e-3);
}

TEST_P(FourBars, TwoFollowTheirBranchThroughTheFlatPositions) {
  Formulated bars = start(four_bars(2));
  follow_table(bars, 2, "A02_N2.csv", 1e-3);
}

// The first and the last coupler's left ends against theta'' = g S/J sin theta, the parallelogram by hand.
double error_of(Formulated& bars, int n, double end, double step) {
  const double k = bars.model.gravity[1] * (0.5 * (n + 1) + n) / ((n + 1) / 3.0 + n);
  const auto slope = [k](double theta) { return -k * std::sin(theta); };
  double theta = 0, rate = 1, error = 0;
  for (int i = 0; i < std::lround(end / step); ++i) {
    bars.run(step, step);
    constexpr int kParts = 4;
    for (int j = 0; j < kParts; ++j) {
      const double h = step / kParts, r1 = rate, a1 = slope(theta), r2 = rate + h / 2 * a1,
                   a2 = slope(theta + h / 2 * r1), r3 = rate + h / 2 * a2, a3 = slope(theta + h / 2 * r2),
                   r4 = rate + h * a3, a4 = slope(theta + h * r3);
      theta += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
      rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    for (const int last : {0, n - 1}) {
      const BodyPose pose = bars.pose("Coupler" + std::to_string(last));
      error = std::max(
          {error, std::abs(pose.position[0] - last - std::sin(theta)), std::abs(pose.position[1] - std::cos(theta))});
    }
  }
  return error;
}

// What a flat position sets free is of the size of one bar, what holds it of all bars' mass: the more loops and the
// larger the factor, the shorter the passage that steps must resolve.
TEST(PenaltyFourBars, OfFortyLoopsFollowTheirBranch) {
  for (const double factor : slew::testing::is_nightly() ? std::vector{1e7, 1e9} : std::vector{1e9}) {
    MechanicsDef def = four_bars(40);
    def.formulation = Formulation::penalty;
    def.penalty_factor = factor;
    Formulated bars(def);
    expect_figure("A02", "penalty, 1 ms",
                  {"N=40: pins to 0.9 s, f " + std::to_string(factor), error_of(bars, 40, 0.9, 1e-3), 1e-5});
  }
}

TEST(PenaltyFourBars, NeverGetWorseWithALargerFactor) {
  for (const int n : slew::testing::is_nightly() ? std::vector{1, 2, 5} : std::vector{2}) {
    double before = 1;
    for (const double factor : {1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
      MechanicsDef def = four_bars(n);
      def.formulation = Formulation::penalty;
      def.penalty_factor = factor;
      Formulated bars(def);
      const double error = error_of(bars, n, 4, 1e-3);
      expect_figure("A02", "penalty, 1 ms",
                    {"N=" + std::to_string(n) + ": pins to 4 s, f " + std::to_string(factor), error,
                     std::max(1e-6, 50 / factor)});
      // the residual of the step does not decrease any more
      EXPECT_LT(error, before + 1e-6) << n << ", " << factor;
      before = error;
    }
  }
}

// The crank's torque acts through a row.
TEST_P(Squeezer, FollowsTheReferenceTo30ms) {
  MechanicsDef def = tuned(testing::squeezer(), 1e9, 1000);
  def.formulation = GetParam();
  const std::vector<std::string> rows = {"Crank"};
  const Model model = build_model(def, rows);
  EXPECT_EQ(model.degrees_of_freedom(), 1);
  State state = start_state(model);
  Workspace ws(model);
  Dynamics dynamics(GetParam(), model, state);
  const double torque[] = {0.033}, slope[] = {0};
  dynamics.evaluate(model, state, ws);
  // joints that are held by penalties give by a share of about 1 / factor
  EXPECT_NEAR(row_free_accelerations(ws)[0] + row_mobility(ws)[0] * 0.033, 14222.4439199541,
              is(Formulation::penalty) ? 1e-2 : 1e-5);
  bool is_closed = true;
  for (int i = 0; i < 3000; ++i) {
    dynamics.evaluate(model, state, ws);
    is_closed = dynamics.advance(model, state, ws, 1e-5, torque, slope) && is_closed;
  }
  EXPECT_TRUE(is_closed);
  dynamics.observe(model, state, ws);
  const double open = JointGauge(model).measure(ws).position;
  observe(model, state, ws);
  const std::vector<ElementVariable> names = variables(model);
  std::vector<double> values(names.size());
  read_variables(model, state, ws, {}, values);
  double error = 0;
  for (const auto& [joint, angle] : testing::kSqueezerAngles) {
    const auto found = std::find_if(names.begin(), names.end(), [&joint = joint](const ElementVariable& variable) {
      return variable.name == std::string(joint) + ".position";
    });
    ASSERT_NE(found, names.end()) << joint;
    error = std::max(error, std::abs(values[static_cast<std::size_t>(found - names.begin())] - angle));
  }
  expect_figure("A03", setting(1e-5), {"angles at 30 ms [rad]", error, 1e-4});
  expect_figure("A03", setting(1e-5), {"loops at 30 ms [m]", open, 1e-9});
}

TEST_P(SliderCrank, InSpaceFollowsTheReference) {
  Formulated crank = start(tuned(slider_crank(), 1e9, 30));
  EXPECT_EQ(crank.model.degrees_of_freedom(), 1);
  EXPECT_NEAR(crank.pose("Slider").velocity[0], 0.24, 1e-9);
  const Triple w = crank.pose("Conrod").angular_velocity;
  EXPECT_NEAR(w[0], 1.92, 1e-9);
  EXPECT_NEAR(w[1], -0.96, 1e-9);
  EXPECT_NEAR(w[2], 0.48, 1e-9);
  EXPECT_NEAR(crank.total_energy(), 0.76643568, 1e-8);
  // second order against fourth
  const double step = is(Formulation::augmented) ? 5e-4 : 1e-3;
  double time = 0, slider = 0, angle = 0, speed = 0, open = 0;
  for (const auto& row : testing::read_table("haug_slider_crank3d.csv")) {
    if (row[0] > time) crank.run(row[0] - time, step);
    time = row[0];
    slider = std::max(slider, std::abs(crank.pose("Slider").position[0] - row[1]));
    angle = std::max(angle, std::abs(crank.value("Pivot.position") - row[2]));
    speed = std::max(speed, std::abs(crank.pose("Slider").velocity[0] - row[3]));
    open = std::max(open, opening(crank).position);
  }
  EXPECT_NEAR(time, 5, 1e-9);
  expect_figure("A08", setting(step), {"slider to 5 s [m]", slider, 2e-4});
  expect_figure("A08", setting(step), {"crank to 5 s [rad]", angle, 1e-2});
  expect_figure("A08", setting(step), {"slider's speed [m/s]", speed, 1e-2});
  expect_figure("A08", setting(step), {"constraint [m]", open, 1e-8});
}

class FlatStart : public testing::EveryFormulation {};

std::string problems_of(const MechanicsDef& def) {
  Problems problems;
  validate(def, problems);
  return testing::text_of(problems);
}

// From a flat position a parallelogram goes on as one, or crossed: with the speeds (w3 - w1) (r (w3 - w1) - (w3 + w1))
// = 0, r = 0.3.
constexpr double kCrossed = -1.3 / 0.7;

TEST_P(FlatStart, WithOneSpeedIsRefusedAsSingular) {
  for (const double base : {0.0, 0.3, M_PI / 4}) {
    for (const double second : {kNotGiven, 8.01, -8.0, 0.0}) {
      MechanicsDef def = testing::parallelogram(base, 0, 8, second);
      def.formulation = GetParam();
      EXPECT_NE(
          problems_of(def).find("J4: the loop that it closes with 'J1', 'J2', 'J3' starts in a singular position"),
          std::string::npos)
          << base << ", " << second << ": " << problems_of(def);
    }
  }
}

TEST_P(FlatStart, WithBothSpeedsFollowsThem) {
  for (const double base : {0.0, 0.3, M_PI / 4}) {
    EXPECT_EQ(problems_of(testing::parallelogram(base, 0, 8, 8 * kCrossed)), "") << base;
    // one coordinate: J theta'' = g S cos(base + theta)
    const double J = 2 * (0.01 + 0.15 * 0.15) + 2 * 0.09, S = 2 * 0.15 + 2 * 0.3;
    Formulated bars = start(testing::parallelogram(base, 0, 8, 8));
    const auto slope = [&](double theta) { return bars.model.gravity[1] * S / J * std::cos(base + theta); };
    double theta = 0, rate = 8;
    constexpr int kParts = 4000;
    for (int i = 0; i < kParts; ++i) {
      const double h = 1.0 / kParts, r1 = rate, a1 = slope(theta), r2 = rate + h / 2 * a1,
                   a2 = slope(theta + h / 2 * r1), r3 = rate + h / 2 * a2, a3 = slope(theta + h / 2 * r2),
                   r4 = rate + h * a3, a4 = slope(theta + h * r3);
      theta += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
      rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    bars.run(1, 1e-3);
    EXPECT_NEAR(bars.value("J1.position"), base + theta, 1e-3) << base;
    EXPECT_NEAR(bars.value("J3.velocity"), rate, 1e-2) << base;
  }
}

// The remedy of the refusal.
TEST(FlatStarts, OffTheFlatPositionOneSpeedIsEnough) {
  for (const double base : {0.0, 0.3, M_PI / 4}) {
    for (const double crank : {1e-3, -1e-3, 1e-4}) {
      Formulated bars(testing::parallelogram(base, crank, 8, kNotGiven));
      EXPECT_NEAR(bars.value("J3.velocity"), 8, 1e-6) << base << ", " << crank;
    }
  }
}

TEST(FlatStarts, AtRestAreWarnedOf) {
  const auto warnings_of = [](double crank) {
    Problems warnings;
    find_start_changes(testing::parallelogram(0, crank, kNotGiven, kNotGiven), warnings);
    return testing::text_of(warnings);
  };
  EXPECT_NE(warnings_of(0).find("starts at rest in a singular position"), std::string::npos) << warnings_of(0);
  EXPECT_EQ(warnings_of(1e-3).find("singular"), std::string::npos) << warnings_of(1e-3);
}

// A motion that drives one crank of it selects no way either.
TEST(FlatStarts, ThatAMotionDrivesAreRefused) {
  for (const double second : {kNotGiven, 8.0}) {
    MechanicsDef def = testing::parallelogram(0, 0, kNotGiven, second);
    def.motions.push_back({.name = "Drive", .shape = MotionShape::speed, .joint = "J1", .speed = 8});
    EXPECT_EQ(problems_of(def).find("singular") == std::string::npos, is_given(second)) << problems_of(def);
  }
}

INSTANTIATE_TEST_SUITE_P(In, FlatStart, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, FourBars, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, Squeezer, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, SliderCrank, testing::kEveryFormulation, testing::kFormulationName);

}  // namespace loop_test
}  // namespace slew::multibody
