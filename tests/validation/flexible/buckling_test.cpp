// SPDX-License-Identifier: Apache-2.0
// Compression of a cantilever close to Euler's load: geometric stiffening of the floating frame, segments, and the
// linear body without stiffening. Reference: slender_beam.h. Figures: docs/extremes.md.
#include "multibody/results/observe.h"
#include "tests/support/nightly.h"
#include "tests/validation/flexible/strip.h"

namespace slew::multibody {
namespace buckling_test {

using namespace testing;

void compress(MechanicsDef& def, double share) {
  def.point_forces = {{.name = "Load",
                       .body = "Strip",
                       .point = {1, 0, 0},
                       .direction = {-1, 0, 0},
                       .axes = LoadAxes::ground,
                       .force = share * slender().euler_load()}};
}

MechanicsDef compressed(int modes, double share, double q = 0) {
  MechanicsDef def = clamped_strip(strip_modes(modes), q);
  compress(def, share);
  return def;
}

double exact_square(double share) {
  slew::testing::SlenderBeam beam = slender();
  beam.compression = share * beam.euler_load();
  return beam.lowest_square();
}

TEST(SlenderBeam, HasThePublishedFigures) {
  slew::testing::SlenderBeam beam;
  EXPECT_NEAR(std::sqrt(beam.lowest_square()), 3.516015, 1e-6);
  beam.compression = beam.euler_load();
  EXPECT_NEAR(beam.lowest_square(), 0, 1e-6);
  // flapping at a spin of 5 and 10 (Wright, Smith, Thresher and Wang 1982)
  beam = {.spin = 5};
  EXPECT_NEAR(std::sqrt(beam.lowest_square()), 6.4495, 1e-4);
  beam = {.spin = 10};
  EXPECT_NEAR(std::sqrt(beam.lowest_square()), 11.2023, 1e-4);
  // m + 33/140 rho A L (Rayleigh)
  beam = {.tip_mass = 100};
  EXPECT_NEAR(beam.lowest_square(), 3 / (100 + 33.0 / 140), 1e-6);
  beam = {};
  EXPECT_NEAR(beam.tip_under(-1), -1.0 / 8, 1e-9);
  // Timoshenko and Gere, table 2-4: 20 degrees at the tip, p = sin 10
  EXPECT_NEAR(slew::testing::elastica_tip(1.0154), 0.2195, 5e-4);
}

// one mode is 7.8 % too strong: Rayleigh's quotient of the shape of free vibration, 2.660 for 2.467
TEST(Buckling, TheLoadIsEulersFromTheSecondModeOn) {
  const double exact = slender().euler_load();
  for (const auto& [modes, bound] : {std::pair(1, 0.08), {2, 0.01}, {3, 3e-3}, {4, 1e-3}, {6, 5e-4}}) {
    if (modes > 2 && !slew::testing::is_nightly()) continue;
    double low = 0.5, high = 1.5;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (low + high);
      (squares_of(compressed(modes, middle)).front() > 0 ? low : high) = middle;
    }
    expect_outcome("buckling load", std::to_string(modes) + " modes in the plane", {.error = low - 1}, bound,
                   Ending::right);
    if (modes == 1) {
      EXPECT_NEAR(low * exact, 2.660 / 2.4674 * exact, 1e-3 * exact);
    }
  }
}

TEST(Buckling, TheFrequencyFallsToNothingAtTheLoad) {
  const double unloaded = slender().lowest_square();
  for (const double share : {0.5, 0.9, 0.99, 1.01, 1.1}) {
    const double exact = exact_square(share);
    // the law 1 - P/P_E is that of beams whose shape stays
    EXPECT_NEAR(exact / unloaded, 1 - share, 0.15 * share * std::fabs(1 - share)) << share;
    const std::string which = "omega^2 at " + std::to_string(share).substr(0, 4) + " of Euler's load, of the unloaded";
    expect_outcome(which, "6 modes", {.error = std::fabs(squares_of(compressed(6, share)).front() - exact) / unloaded},
                   1e-3, Ending::right);
    MechanicsDef segments = clamped_segments(20);
    compress(segments, share);
    segments.segmented_bodies[0].start = SegmentStart::at_rest;  // straight, under compression
    expect_outcome(which, "20 segments", {.error = std::fabs(squares_of(segments).front() - exact) / unloaded}, 3e-3,
                   Ending::right);
  }
}

struct Rule {
  Formulation formulation;
  Integrator integrator;
  double step;
};
const Rule kRules[] = {
    {Formulation::recursive, Integrator::rk4, 1e-4},    {Formulation::recursive, Integrator::trapezoidal, 1e-3},
    {Formulation::recursive, Integrator::sdirk2, 1e-3}, {Formulation::lagrange, Integrator::trapezoidal, 1e-3},
    {Formulation::augmented, Integrator::own, 1e-3},    {Formulation::penalty, Integrator::rk4, 1e-4}};

std::string text_of(const Rule& rule) {
  return name_of(rule.formulation) + ", " +
         (rule.integrator == Integrator::own ? std::string("own") : name_of(rule.integrator)) + ", " +
         in_milliseconds(rule.step);
}

Formulated start(MechanicsDef def, const Rule& rule) {
  def.formulation = rule.formulation;
  def.integrator = rule.integrator;
  def.max_substep = rule.step;
  return Formulated(def);
}

// 1e-8 of the length aside: below the load it swings about straight, half a period later it is as far on the other side
TEST(Buckling, AHundredthBelowTheLoadItSwings) {
  const double half = M_PI / std::sqrt(exact_square(0.99));
  for (const Rule& rule : kRules) {
    Formulated strip = start(compressed(6, 0.99, 1e-6), rule);
    const double begin = strip.value("Strip.deflection.y");
    Outcome outcome;
    outcome.is_flagged = !strip.try_run(half, rule.step);
    outcome.error = std::fabs(strip.value("Strip.deflection.y") / begin + 1);
    expect_outcome("0.99 of Euler's load: half a period later", text_of(rule), outcome, 0.05, Ending::right);
  }
}

// above it leaves straight with the rate that theory has, and is flagged when it is a tenth of its length off
TEST(Buckling, AHundredthAboveTheLoadItLeavesAsInTheory) {
  const double growth = std::sqrt(-exact_square(1.01));
  for (const Rule& rule : kRules) {
    Formulated strip = start(compressed(6, 1.01, 1e-6), rule);
    Outcome outcome;
    outcome.is_flagged = !strip.try_run(1, rule.step);
    const double before = strip.value("Strip.deflection.y");
    outcome.is_flagged = !strip.try_run(0.5, rule.step) || outcome.is_flagged;
    const double after = strip.value("Strip.deflection.y");
    outcome.error = std::fabs(std::log(after / before) / (0.5 * growth) - 1);
    expect_outcome("1.01 of Euler's load: rate of growth", text_of(rule), outcome, 0.03, Ending::right);
    EXPECT_FALSE(is_bent_far(strip.model, 0, strip.state.q));
    static_cast<void>(strip.try_run(0.9, rule.step));
    EXPECT_TRUE(is_bent_far(strip.model, 0, strip.state.q)) << text_of(rule);
  }
}

// linear bodies do not buckle at all
TEST(Buckling, WithoutStiffeningNothingHappens) {
  MechanicsDef def = clamped_strip(strip_modes(6, flex::GeometricStiffening::none));
  compress(def, 2);
  const double exact = slender().lowest_square();
  EXPECT_NEAR(squares_of(def).front(), exact, 1e-3 * exact);
}

// Segments go on to where the elastica rests: kicked aside, damped, 1 % above the load 18 % of the length. What n of
// them buckle at is off by (pi/(2 n))^2/3, and a hundredth above it counts a hundred times.
TEST(Buckling, SegmentsEndAtTheElastica) {
  for (const auto& [share, segments, bound] :
       {std::tuple(1.01, 20, 0.2), {1.01, 40, 0.03}, {1.1, 20, 0.01}, {1.5, 20, 0.01}}) {
    MechanicsDef def = clamped_segments(segments);
    compress(def, share);
    def.point_forces.push_back({.name = "Kick",
                                .body = "Strip",
                                .point = {1, 0, 0},
                                .direction = {0, 1, 0},
                                .axes = LoadAxes::ground,
                                .force_table = {{0, 1}, {0.1, 1}, {0.101, 0}}});
    def.segmented_bodies[0].relative_damping = 0.1;
    def.integrator = Integrator::sdirk2;
    def.max_substep = 5e-3;
    Formulated strip(def);
    Outcome outcome;
    outcome.is_flagged = !strip.try_run(6, 5e-3);
    const double tip = strip.value("Strip.deflection.y");
    outcome.error = std::fabs(tip / slew::testing::elastica_tip(share) - 1);
    expect_outcome("elastica at " + std::to_string(share).substr(0, 4) + " of Euler's load",
                   std::to_string(segments) + " segments", outcome, bound, Ending::right);
  }
}

}  // namespace buckling_test
}  // namespace slew::multibody
