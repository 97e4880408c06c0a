// SPDX-License-Identifier: Apache-2.0
// B02: spin-up of a rotating beam (Simo and Vu-Quoc 1988). Tolerances 1 % of v with geometric stiffening, 0.2 % in the
// slow case, where linear theory must give its own wrong answer; in the fast one it must run away. Card:
// docs/validation/B02_spin_up.md.
#include <limits>

#include "tests/validation/flexible/drawing.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace spin_up_test {

using namespace testing;

constexpr double kLength = 10, kSpinUp = 15;

flex::BeamDef beam(int nodes) {
  // EI 1.4e4 N m2, EA 2.8e7 N, GA 1e7 N, 1.2 kg/m, 6e-4 kg m
  flex::SectionDef section{.area = 1, .second_moment_y = 5e-4, .second_moment_z = 5e-4, .torsion_constant = 1e-3};
  section.shear_factor_y = section.shear_factor_z = 1;
  flex::Material material{.youngs_modulus = 2.8e7, .poisson_ratio = 0.3, .shear_modulus = 1e7, .density = 1.2};
  return flex::testing::straight(section, material, {kLength, 0, 0}, nodes);
}

// hub angle of the case until after the spin-up
Table hub_angle(double speed) {
  Table table;
  for (int i = 0; i <= 1200; ++i) {
    const double t = i * 0.025, turn = 2 * M_PI / kSpinUp;
    const double angle = t <= kSpinUp ? speed / kSpinUp * (t * t / 2 + (std::cos(turn * t) - 1) / (turn * turn))
                                      : speed * t - speed * kSpinUp / 2;
    table.push_back({t, angle});
  }
  return table;
}

struct BeamChoice {
  flex::GeometricStiffening stiffening = flex::GeometricStiffening::straight_beam;
  std::size_t modes = 3;
  int nodes = 21;
  bool is_stretching = false;  // the first mode along the beam as well
};

MechanicsDef spinning(double speed, const BeamChoice& choice) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Beam", .type = BodyType::flexible, .mass = 12, .inertia = {1, 100, 100}}};
  def.joints = {{.name = "Hub", .body2 = "Beam"}};
  def.motions = {{.name = "SpinUp", .joint = "Hub", .points = hub_angle(speed)}};
  flex::ReductionDef reduction = flex::testing::with_modes(12);
  reduction.stiffening = choice.stiffening;
  // the lowest modes that bend in the plane
  const auto all = slew::testing::modes_of(beam(choice.nodes), reduction, {});
  std::vector<int> kept;
  std::size_t bending = 0, stretching = choice.is_stretching ? 0 : 1;
  for (std::size_t k = 0; k < all->modes(); ++k) {
    const math::Vec3 shift = all->nodes.back().shift[k];
    const bool bends = std::abs(shift.y()) > 0.5 * norm(shift), stretches = std::abs(shift.x()) > 0.5 * norm(shift);
    if ((bends && bending++ < choice.modes) || (stretches && stretching++ < 1)) kept.push_back(static_cast<int>(k) + 1);
  }
  def.flexible_bodies = {{.body = "Beam", .modes = slew::testing::modes_of(beam(choice.nodes), reduction, kept)}};
  // something must hold the tip's node to have it as a link
  def.static_dummies = {{.name = "Tip", .relative_to = "Beam", .position = {kLength, 0, 0}}};
  return def;
}

constexpr const char *kFast = "spinup_svq.csv", *kSlow = "spinup_slow.csv";

struct SpinUpRun {
  double worst = 0, lowest = 0;  // m, of the lateral deflection: error and smallest value
  double drawn_in = 0;           // m, error of the deflection along the beam
  std::vector<double> time, v, exact;
  double steady = 0;  // m, deflection along the beam at the end
  [[nodiscard]] double at(double t) const {
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (std::abs(time[i] - t) < 1e-9) return v[i];
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
};

SpinUpRun run(const char* table, const BeamChoice& choice, double until = 30) {
  constexpr double kStep = 2e-3;
  Formulated beam(spinning(table == kFast ? 6 : 1, choice));
  SpinUpRun result;
  double time = 0;
  for (const auto& row : read_table(table)) {
    if (row[0] > until + 1e-6) break;
    if (row[0] > time) beam.run(row[0] - time, kStep);
    time = row[0];
    const BodyPose tip = beam.pose("Beam.Node" + std::to_string(choice.nodes));
    const double c = std::cos(row[4]), s = std::sin(row[4]);
    const double u = c * tip.position[0] + s * tip.position[1] - kLength;
    const double v = -s * tip.position[0] + c * tip.position[1];
    result.worst = std::max(result.worst, std::abs(v - row[2]));
    result.steady = u;
    result.drawn_in = std::max(result.drawn_in, std::abs(u - row[1]));
    result.lowest = std::min(result.lowest, v);
    result.time.push_back(time);
    result.v.push_back(v);
    result.exact.push_back(row[2]);
  }
  return result;
}

void print_row(const char* which, const BeamChoice& choice, const SpinUpRun& run) {
  if (std::getenv("SLEWRING_FIGURES") == nullptr) return;
  std::printf("| %s%s | %zu | %d | %.6f | %.5f | %.5f | %.5f | %.1e | %.1e |\n", which,
              choice.stiffening == flex::GeometricStiffening::none ? ", linear" : "", choice.modes, choice.nodes,
              run.lowest, run.at(5), run.at(7.5), run.at(10), run.worst, run.drawn_in);
}

TEST(SpinUp, WithStiffeningFollowsTheExactBeam) {
  const SpinUpRun fast = run(kFast, {});
  EXPECT_NEAR(fast.lowest, -0.57386, 0.01 * 0.57386);
  EXPECT_LT(fast.worst, 0.01 * 0.57386);
  const SpinUpRun slow = run(kSlow, {});
  EXPECT_NEAR(slow.lowest, -0.10444, 0.002 * 0.10444);
  EXPECT_LT(slow.worst, 0.002 * 0.10444);
  print_row("6 rad/s", {}, fast);
  print_row("1 rad/s", {}, slow);
}

// 3 modes of Euler's beam without stiffening, of an independent computation: they give what linear theory gives
TEST(SpinUp, WithoutStiffeningIsWrongAsLinearTheoryIs) {
  const BeamChoice linear{.stiffening = flex::GeometricStiffening::none};
  const SpinUpRun slow = run(kSlow, linear);
  constexpr double kTolerance = 0.002 * 0.107011;
  EXPECT_NEAR(slow.lowest, -0.107011, kTolerance);
  EXPECT_NEAR(slow.at(5), -0.079731, kTolerance);
  EXPECT_NEAR(slow.at(7.5), -0.106626, kTolerance);
  EXPECT_NEAR(slow.at(10), -0.083329, kTolerance);
  print_row("1 rad/s", linear, slow);
}

// 6 rad/s is above the first frequency, 3.80 rad/s: the missing stiffness exceeds the beam's own
TEST(SpinUp, WithoutStiffeningRunsAwayAboveTheFirstFrequency) {
  const BeamChoice linear{.stiffening = flex::GeometricStiffening::none};
  const SpinUpRun fast = run(kFast, linear, 10);
  EXPECT_GT(std::abs(fast.at(7.5)), 1.4);
  EXPECT_GT(std::abs(fast.at(10)), 70);
  print_row("6 rad/s", linear, fast);
}

// rho A omega^2 L^3/(3 E A) when the beam turns steadily; one mode along it reaches 32/pi^4 of a third
TEST(SpinUp, StretchesAsFarAsCentrifugalForceDrawsIt) {
  constexpr double kStretch = 5.142857e-4;
  const SpinUpRun fast = run(kFast, {.is_stretching = true});
  EXPECT_NEAR(fast.steady, kStretch, 0.02 * kStretch);
  EXPECT_LT(fast.worst, 0.01 * 0.57386);
  print_row("6 rad/s, stretching", {.is_stretching = true}, fast);
}

// More modes come closer until the difference is that of the beam's theory: the tables of the card.
TEST(SpinUp, ConvergesWithModesAndNodes) {
  const double bounds[] = {7e-3, 5e-3, 1e-3, 1e-3, 1e-3, 1e-3};
  slew::plotting::MarkGroup by_modes{"modes, 21 nodes"}, by_nodes{"nodes, 3 modes"};
  for (std::size_t modes = 1; modes <= 6; ++modes) {
    const SpinUpRun fast = run(kFast, {.modes = modes});
    EXPECT_LT(fast.worst, bounds[modes - 1]) << modes;
    print_row("6 rad/s", {.modes = modes}, fast);
    by_modes.marks.push_back({static_cast<double>(modes), fast.worst, std::to_string(modes)});
  }
  for (const int nodes : {5, 10, 20, 40}) {
    const SpinUpRun fast = run(kFast, {.nodes = nodes});
    EXPECT_LT(fast.worst, 1e-3) << nodes;
    print_row("6 rad/s", {.nodes = nodes}, fast);
    by_nodes.marks.push_back({static_cast<double>(nodes), fast.worst, std::to_string(nodes)});
  }
  slew::testing::write_figure("B02_convergence.svg",
                              slew::plotting::scatter_svg({.title = "B02: largest error of the tip's deflection",
                                                           .subtitle = "6 rad/s, with geometric stiffening; exact beam",
                                                           .x_label = "modes or nodes",
                                                           .y_label = "error of v [m]",
                                                           .groups = {by_modes, by_nodes}}));
}

// the card's pictures
TEST(SpinUp, IsDrawn) {
  if (std::getenv("SLEWRING_FIGURE_FOLDER") == nullptr) GTEST_SKIP() << "no SLEWRING_FIGURE_FOLDER";
  for (const char* table : {kSlow, kFast}) {
    const SpinUpRun stiff = run(table, {}, 20);
    SpinUpRun linear = run(table, {.stiffening = flex::GeometricStiffening::none}, 10);
    if (table == kFast) std::erase_if(linear.time, [](double t) { return t > 7.3; });
    linear.v.resize(linear.time.size());
    const std::vector<slew::plotting::Series> curves = {{"exact beam", "m", stiff.time, stiff.exact},
                                                        {"with stiffening", "m", stiff.time, stiff.v},
                                                        {"linear theory", "m", linear.time, linear.v}};
    slew::testing::write_figure(
        table == kFast ? "B02_spin_up_fast.svg" : "B02_spin_up_slow.svg",
        slew::plotting::plot_svg(curves,
                                 {.title = table == kFast ? "B02: spin-up to 6 rad/s" : "B02: spin-up to 1 rad/s",
                                  .subtitle = "lateral deflection of the tip over time, 3 modes",
                                  .panel_height = 260}));
  }
}

}  // namespace spin_up_test
}  // namespace slew::multibody
