// SPDX-License-Identifier: Apache-2.0
// Selection, evaluation and recovery of reduced bodies.
#include "flex/reduced_body.h"

#include <gtest/gtest.h>

#include "core/allocation_guard.h"
#include "tests/support/flex_beams.h"

namespace slew::flex {
namespace reduced_body_test {

using namespace testing;
using math::Vec3;

Reduction stiffened_jib() {
  ReductionDef def = with_modes(4);
  def.stiffening = GeometricStiffening::straight_beam;
  return reduce(build_beam(jib_boom(8)), def);
}

TEST(ReducedBody, SelectionKeepsTheNumbersOfItsModes) {
  const Reduction all = stiffened_jib();
  const std::vector<int> ordinals = {5, 1, 2};  // any order
  const Reduction some = select(all, ordinals);
  const std::size_t from[] = {0, 1, 4};
  ASSERT_EQ(some.body.modes(), 3u);
  EXPECT_EQ(some.body.mass, all.body.mass);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(some.body.omega[k], all.body.omega[from[k]]);
    EXPECT_EQ(some.body.C[k].array(), all.body.C[from[k]].array());
    EXPECT_EQ(some.body.nodes[7].phi[k].array(), all.body.nodes[7].phi[from[k]].array());
    EXPECT_EQ(some.body.nodes[7].psi[k].array(), all.body.nodes[7].psi[from[k]].array());
    for (std::size_t l = 0; l < 3; ++l) {
      const std::size_t p = some.body.pair(k, l), q = all.body.pair(from[k], from[l]);
      EXPECT_EQ(some.body.K[p], all.body.K[q]);
      EXPECT_EQ(some.body.Y[p](1, 1), all.body.Y[q](1, 1));
      EXPECT_EQ(some.body.G[p].array(), all.body.G[q].array());
      EXPECT_EQ(some.body.H[p](0, 0), all.body.H[q](0, 0));
      EXPECT_EQ(some.body.nodes[3].g[p].array(), all.body.nodes[3].g[q].array());
    }
    EXPECT_EQ(some.recovery.normal[3 * 5 + k], all.recovery.normal[all.body.modes() * 5 + from[k]]);
  }
}

TEST(ReducedBody, ListsOfModesAreRead) {
  EXPECT_EQ(mode_list("1;2"), (std::vector<int>{1, 2}));
  EXPECT_EQ(mode_list(" 7 ; 3"), (std::vector<int>{7, 3}));
  for (const char* text : {"", "1;", "1;;2", "1,2", "a", "1.5", "1 2"})
    EXPECT_NE(error_of([&] { (void)mode_list(text); }).find("is no whole number"), std::string::npos) << text;
}

TEST(ReducedBody, WrongSelectionsAreNamed) {
  const Reduction all = stiffened_jib();
  const auto text = [&](std::vector<int> ordinals) { return error_of([&] { (void)select(all.body, ordinals); }); };
  EXPECT_NE(text({0}).find("there is no mode 0; expected 1 to 10"), std::string::npos);
  EXPECT_NE(text({11}).find("there is no mode 11; expected 1 to 10"), std::string::npos);
  EXPECT_EQ(text({2, 2}), "mode 2 is given twice; expected each once");
}

TEST(ReducedBody, HighestFrequencySelects) {
  const Reduction all = stiffened_jib();
  EXPECT_EQ(modes_up_to(all.body, all.body.omega[3]), (std::vector<int>{1, 2, 3, 4}));
  EXPECT_TRUE(modes_up_to(all.body, 1).empty());
}

TEST(ReducedBody, ShorteningIsPartOfTheDeflection) {
  const Reduction r = stiffened_jib();
  std::vector<double> q(r.body.modes());
  q[0] = 0.3;
  const ReducedNode& tip = r.body.nodes.back();
  const Vec3 straight_part = tip.phi[0] * 0.3, short_part = tip.g[0] * (0.5 * 0.09);
  EXPECT_LT(norm(deflection(tip, q) - straight_part - short_part), 1e-15);
  EXPECT_GT(short_part.x(), 0) << "the tip at -x comes back";
}

// tip force F on a cantilever of one section: at the root sigma = F L c/I, at the tip 0; torque T: tau = T/W_t
TEST(Recovery, StressIsThatOfStatics) {
  const double F = 1000, T = 300, L = 2, I = std::pow(0.1, 4) / 12;
  const FeModel model = build_beam(straight(square(0.1), steel(), {L, 0, 0}, 11));
  const Reduction r = reduce(model, with_modes(20));
  std::vector<double> q(r.body.modes());
  const ReducedNode& tip = r.body.nodes.back();
  for (std::size_t k = 0; k < q.size(); ++k)
    q[k] = (F * tip.phi[k].y() + T * tip.psi[k].x()) / (r.body.omega[k] * r.body.omega[k]);
  const Section& section = model.elements[0].section;
  ASSERT_FALSE(r.recovery.points.empty());
  for (std::size_t i = 0; i < r.recovery.points.size(); ++i) {
    const StressPoint& point = r.recovery.points[i];
    const PointStress stress = stress_at(r.recovery, i, q);
    const double x = model.nodes[static_cast<std::size_t>(point.node) - 1].position.x();
    EXPECT_NEAR(stress.normal, -F * (L - x) * point.y / I, 1e-6 * F * L * 0.05 / I) << i;
    EXPECT_NEAR(stress.shear, T / *section.points[i % 8].torsion_modulus, 1e-6 * T / *section.points[4].torsion_modulus)
        << i;
    EXPECT_TRUE(point.has_shear);
  }
  // energy of both loads
  const double phi = 12 * 2.1e11 * I / (section.shear_factor_y * 2.1e11 / 2.6 * 0.01 * L * L);
  const double by_force = F * F * L * L * L * (1 + phi / 4) / (3 * 2.1e11 * I) / 2;
  const double by_torque = T * T * L / (2.1e11 / 2.6 * section.torsion_constant) / 2;
  EXPECT_NEAR(strain_energy(r.body, q), by_force + by_torque, 1e-9 * by_force);
}

TEST(Recovery, EvaluationAllocatesNothing) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  const Reduction r = stiffened_jib();
  const std::vector<double> q(r.body.modes(), 0.1);
  const AllocationGuard guard;
  double sum = strain_energy(r.body, q);
  for (std::size_t i = 0; i < r.recovery.points.size(); ++i) sum += stress_at(r.recovery, i, q).normal;
  for (const ReducedNode& node : r.body.nodes) sum += deflection(node, q).x() + rotation(node, q).y();
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_NE(sum, 0);
}

}  // namespace reduced_body_test
}  // namespace slew::flex
