// SPDX-License-Identifier: Apache-2.0
// The crane's jib boom as a beam (thesis, chapter 3.2; section chosen): frequency, mass, and what few modes reach.
#include "flex/reduction_report.h"
#include "tests/support/flex_beams.h"
#include "tests/validation/flex/figure.h"

namespace slew::flex {
namespace jib_boom_test {

using namespace testing;

// share of the tip's compliance across the beam that the modes reach
double reached(Attachment attachment, std::vector<int> kept, Shear shear = Shear::timoshenko) {
  BeamDef beam = jib_boom();
  beam.sections[0].shear = shear;
  const FeModel model = build_beam(beam);
  const ReductionDef def = with_modes(16, attachment);
  const ReductionReport report = report_reduction(model, def, reduce(model, def), kept);
  EXPECT_EQ(report.compliance.size(), 3u);
  // both planes alike
  EXPECT_NEAR(report.compliance[1].share(), report.compliance[2].share(), 1e-6);
  return report.compliance[1].share();
}

TEST(JibBoom, HasItsMassAndFirstFrequency) {
  for (const int nodes : {20, 200}) {
    const Reduction r = reduce(build_beam(jib_boom(nodes)), with_modes(4));
    const std::string with = ", " + std::to_string(nodes) + " nodes";
    expect_figure("jib", "mass less 127.56 kg" + with, std::abs(r.body.mass - 127.56), 0.01);
    expect_figure("jib", "first frequency less 8.2 Hz" + with, std::abs(hertz(r.body.omega[0]) - 8.2), 0.05);
    EXPECT_NEAR(r.body.omega[1] / r.body.omega[0], 1, 1e-9) << "square: the same in both planes";
  }
}

TEST(JibBoom, FewClampedModesReachWhatFreeOnesDoNot) {
  const double one = reached(Attachment::clamped, {1, 2}), two = reached(Attachment::clamped, {1, 2, 3, 4});
  const double free_one = reached(Attachment::free, {1, 2});
  expect_figure("jib", "clamped, one mode a plane: share of compliance less 0.97", std::abs(one - 0.97), 0.005);
  expect_figure("jib", "clamped, two modes a plane: less 0.995", std::abs(two - 0.995), 0.001);
  // Euler's beam: 3 (2 (b L) sigma)^2/(b L)^4 = 0.5178 of the first free mode; with shear the root's section
  // turns less
  expect_figure("jib", "free, one mode a plane: less 0.52", std::abs(free_one - 0.52), 0.02);
  expect_figure("jib", "free, one mode a plane, shear-rigid: less 0.5178",
                std::abs(reached(Attachment::free, {1, 2}, Shear::none) - 0.5178), 0.003);
}

TEST(JibBoom, AllModesReachTheWholeCompliance) {
  const FeModel model = build_beam(jib_boom());
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    const ReductionDef def = with_modes(16, attachment);
    const ReductionReport report = report_reduction(model, def, reduce(model, def), {});
    for (const ComplianceFigures& c : report.compliance)
      expect_figure("jib", std::string("all modes, along ") + c.direction + ", share less 1", std::abs(c.share() - 1),
                    1e-8);
  }
}

TEST(JibBoom, SoftSteelScalesFrequenciesByRootTen) {
  const Reduction stiff = reduce(build_beam(jib_boom()), with_modes(8));
  const Reduction soft = reduce(build_beam(jib_boom(20, 2e10)), with_modes(8));
  double worst = 0;
  for (std::size_t k = 0; k < stiff.body.modes(); ++k)
    worst = std::max(worst, std::abs(stiff.body.omega[k] / soft.body.omega[k] / std::sqrt(10.0) - 1));
  expect_figure("jib", "E 2e11 over 2e10 against sqrt(10), worst mode", worst, 1e-9);
}

// 500 kg at the tip of the horizontal beam: 68 mm with the beam's own weight left out is F L^3/3EI and shear
TEST(JibBoom, SagsByTheCraneData) {
  const FeModel model = build_beam(jib_boom());
  const Reduction r = reduce(model, with_modes(16));
  std::vector<double> q(r.body.modes());
  const math::Vec3 weight(0, -(500 + 20) * 9.81, 0), g(0, -9.81, 0);
  for (std::size_t k = 0; k < q.size(); ++k)
    q[k] = (dot(r.body.nodes.back().phi[k], weight) + dot(r.body.C[k], g)) / (r.body.omega[k] * r.body.omega[k]);
  expect_figure("jib", "sag under 520 kg and its own weight, less 68 mm [m]",
                std::abs(-deflection(r.body.nodes.back(), q).y() - 0.068), 0.003);
}

}  // namespace jib_boom_test
}  // namespace slew::flex
