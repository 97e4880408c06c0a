// SPDX-License-Identifier: Apache-2.0
// B03: flexible pendulum. Tolerance 5 % of the largest distance of the middle from the chord. Card:
// docs/validation/B03_pendulum.md.
#include "tests/support/nightly.h"
#include "tests/validation/flexible/drawing.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/linearised.h"
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace pendulum_test {

using namespace testing;

class FlexiblePendulum : public EveryFormulation {};

struct RodChoice {
  std::size_t modes = 3;
  int nodes = 21;
};

MechanicsDef pendulum(const RodChoice& choice = {}) {
  MechanicsDef def;
  def.bodies = {{.name = "Rod", .type = BodyType::flexible, .mass = 1, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Pin", .body2 = "Rod"}};
  flex::SectionDef section{.shape = flex::SectionShape::solid_rectangle, .width = 0.01, .height = 0.02};
  section.shear_factor_y = section.shear_factor_z = 5.0 / 6;
  const flex::BeamDef beam =
      flex::testing::straight(section, flex::testing::steel(7e10, 2700), {1, 0, 0}, choice.nodes);
  const auto all = slew::testing::modes_of(beam, flex::testing::with_modes(12), {});
  std::vector<int> kept;
  for (std::size_t k = 0; k < all->modes() && kept.size() < choice.modes; ++k) {
    if (std::abs(all->nodes.back().shift[k].y()) > 0.5 * norm(all->nodes.back().shift[k])) {
      kept.push_back(static_cast<int>(k) + 1);
    }
  }
  def.flexible_bodies = {{.body = "Rod",
                          .modes = slew::testing::modes_of(beam, flex::testing::with_modes(12), kept),
                          .start = std::vector<double>(kept.size())}};
  def.max_substep = 2e-5;
  def.static_dummies = {{.name = "Tip", .relative_to = "Rod", .position = {1, 0, 0}},
                        {.name = "Middle", .relative_to = "Rod", .position = {0.5, 0, 0}}};
  return def;
}

struct Swing {
  double error = 0;                // m, of the tip's place
  double bend = 0, reference = 0;  // m, largest distance of the middle from the chord
  std::vector<double> time, middle, exact;
};

// nodes: odd, so that one is in the middle
Swing swing(Formulated& rod, double step, const RodChoice& choice = {}) {
  Swing result;
  double time = 0;
  const auto place = [&](int node) { return rod.pose("Rod.Node" + std::to_string(node)).position; };
  for (const auto& row : read_table("flex_pendulum_stiff.csv")) {
    if (row[0] > time) rod.run(row[0] - time, step);
    time = row[0];
    const Triple tip = place(choice.nodes), middle = place(choice.nodes / 2 + 1);
    result.error = std::max({result.error, std::abs(tip[0] - row[1]), std::abs(tip[1] - row[2])});
    const double length = std::hypot(tip[0], tip[1]);
    const double bend = (tip[0] * middle[1] - tip[1] * middle[0]) / length;
    result.bend = std::max(result.bend, std::abs(bend));
    result.reference = std::max(result.reference, std::abs(row[4]));
    result.time.push_back(time);
    result.middle.push_back(1e3 * bend);
    result.exact.push_back(1e3 * row[4]);
  }
  return result;
}

TEST_P(FlexiblePendulum, SwingsAndBendsAsTheExactBeam) {
  Formulated rod = start(pendulum());
  const Swing result = swing(rod, is(Formulation::augmented) ? 1e-4 : 2e-4);
  EXPECT_LT(result.error, 1e-3);
  EXPECT_NEAR(result.bend, result.reference, 0.05 * result.reference);
}

INSTANTIATE_TEST_SUITE_P(In, FlexiblePendulum, kEveryFormulation, kFormulationName);

// 36.0687 Hz is Euler's pinned and free beam; shear and rotary inertia take 2.5e-4 of it
TEST(FlexiblePendulums, VibrateWithTheFrequencyOfThePinnedBeam) {
  constexpr double kFirst = 36.0687;
  for (const auto& [modes, tolerance] : {std::pair<std::size_t, double>(1, 0.5), {3, 1e-3}, {6, 5e-4}}) {
    MechanicsDef def = pendulum({.modes = modes});
    def.gravity = {0, 0, 0};
    Mechanism rod(def);
    const std::vector<double> f = Linearised(rod, {}).frequencies();
    ASSERT_FALSE(f.empty());
    expect_figure("B03", std::to_string(modes) + " modes",
                  {"first frequency less 36.0687 Hz, relative", std::fabs(f[0] / kFirst - 1), tolerance});
  }
}

// The reference vibrates 0.4 % faster than theory has it: it judges how far the middle leaves the chord, not the phase.
// What modes and nodes do is judged by the finest of the models here.
TEST(FlexiblePendulums, NightlyConvergeWithModesAndNodes) {
  slew::plotting::MarkGroup by_modes{"modes, 21 nodes"}, by_nodes{"nodes, 6 modes"};
  const auto run = [](const RodChoice& choice) {
    Formulated rod(pendulum(choice));
    return swing(rod, 2e-5, choice);
  };
  const Swing finest = run({.modes = 6, .nodes = 41});
  const auto look = [&](const RodChoice& choice, double bound, double label, slew::plotting::MarkGroup& group) {
    const Swing result = run(choice);
    double off = 0;
    for (std::size_t i = 0; i < finest.middle.size(); ++i) {
      off = std::max(off, 1e-3 * std::abs(result.middle[i] - finest.middle[i]));
    }
    EXPECT_LT(off, bound) << choice.modes << " modes, " << choice.nodes << " nodes";
    EXPECT_LT(result.error, 1e-3);
    if (choice.modes > 1) {
      EXPECT_NEAR(result.bend, result.reference, 0.05 * result.reference);
    }
    group.marks.push_back({label, off, std::to_string(static_cast<int>(label))});
    if (std::getenv("SLEWRING_FIGURES") != nullptr) {
      std::printf("| %zu | %d | %.2e | %.3e | %.1e | %.1e |\n", choice.modes, choice.nodes, result.error, result.bend,
                  std::abs(result.bend / result.reference - 1), off);
    }
  };
  const double bounds[] = {4e-4, 1.2e-4, 2e-5, 5e-6, 2e-6, 2e-6};
  for (std::size_t modes = 1; modes <= 6; ++modes) {
    look({.modes = modes}, bounds[modes - 1], static_cast<double>(modes), by_modes);
  }
  for (const auto& [nodes, bound] : {std::pair(5, 7e-5), {11, 3e-6}, {21, 2e-6}}) {
    look({.modes = 6, .nodes = nodes}, bound, nodes, by_nodes);
  }
  slew::testing::write_figure(
      "B03_convergence.svg",
      slew::plotting::scatter_svg({.title = "B03: largest error of the middle's distance from the chord",
                                   .subtitle = "to 2 s, against 6 modes of 41 nodes",
                                   .x_label = "modes or nodes",
                                   .y_label = "error [m]",
                                   .groups = {by_modes, by_nodes}}));
  const std::vector<slew::plotting::Series> curves = {{"exact beam, steps of 1 ms", "mm", finest.time, finest.exact},
                                                      {"6 modes", "mm", finest.time, finest.middle}};
  slew::testing::write_figure("B03_pendulum.svg",
                              slew::plotting::plot_svg(curves, {.title = "B03: flexible pendulum",
                                                                .subtitle = "distance of the middle from the chord",
                                                                .panel_height = 260}));
}

}  // namespace pendulum_test
}  // namespace slew::multibody
