// SPDX-License-Identifier: Apache-2.0
// The steps of the reduction, choices of modes and signs, and refused input.
#include "flex/craig_bampton.h"

#include <gtest/gtest.h>

#include "tests/support/flex_beams.h"

namespace slew::flex {
namespace craig_bampton_test {

using namespace testing;
using Eigen::MatrixXd;
using math::Vec3;

// bent, two sections, no symmetry
BeamDef crooked() {
  BeamDef def;
  def.sections = {square(0.06), {.shape = SectionShape::tube, .wall = 0.004, .diameter = 0.05}};
  def.materials = {steel()};
  def.nodes = {{1, {0, 0, 0}},        {2, {0.4, 0.1, 0}},    {3, {0.9, 0.1, 0.2}}, {4, {1.3, 0, 0.5}},
               {5, {1.5, -0.4, 0.6}}, {6, {1.6, -0.9, 0.6}}, {7, {1.7, -1.2, 0.9}}};
  def.elements = {{1, 2, 0, 0, {}}, {2, 3, 0, 0, {}}, {3, 4, 1, 0, {}},
                  {4, 5, 1, 0, {}}, {5, 6, 0, 0, {}}, {6, 7, 0, 0, {}}};
  return def;
}

TEST(CraigBampton, ModesDiagonaliseBothMatrices) {
  for (const MassKind mass : {MassKind::consistent, MassKind::lumped}) {
    BeamDef def = crooked();
    def.mass = mass;
    const FeModel model = build_beam(def);
    for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
      const CraigBampton cb = craig_bampton(model, {.attachment = attachment, .fixed_interface_modes = 8});
      const MatrixXd M = cb.Phi.transpose() * (model.M * cb.Phi), K = cb.Phi.transpose() * (model.K * cb.Phi);
      const double largest = std::pow(cb.omega.back(), 2);
      for (Eigen::Index i = 0; i < M.rows(); ++i) {
        for (Eigen::Index j = 0; j < M.cols(); ++j) {
          const double omega2 = std::pow(cb.omega[static_cast<std::size_t>(i)], 2);
          EXPECT_NEAR(M(i, j), i == j ? 1 : 0, 1e-9);
          EXPECT_NEAR(K(i, j), i == j ? omega2 : 0, 1e-9 * largest);
        }
      }
    }
  }
}

TEST(CraigBampton, AllModesOfTheInsideGiveTheWholeModel) {
  const FeModel model = build_beam(crooked());
  const CraigBampton cb = craig_bampton(model, {.fixed_interface_modes = 66});
  const std::vector<double> full = full_frequencies(model, cb.held, 72, 0);
  ASSERT_EQ(cb.omega.size(), 72u);
  for (std::size_t k = 0; k < 72; ++k) EXPECT_NEAR(cb.omega[k] / full[k], 1, 1e-9) << k;
}

TEST(CraigBampton, ClampedFreedomsDoNotMove) {
  const FeModel model = build_beam(crooked());
  const CraigBampton cb =
      craig_bampton(model, {.clamped_nodes = {3}, .interface_nodes = {1, 7}, .fixed_interface_modes = 3});
  EXPECT_EQ(cb.omega.size(), 15u);
  EXPECT_EQ(cb.boundary.size(), 12u);
  EXPECT_EQ(cb.interior.size(), 60u);
  for (int a = 0; a < 6; ++a) EXPECT_EQ(cb.Phi.row(12 + a).cwiseAbs().maxCoeff(), 0);
}

TEST(CraigBampton, FreeModesCarryNoMomentum) {
  const FeModel model = build_beam(crooked());
  const CraigBampton cb = craig_bampton(model, {.attachment = Attachment::free, .fixed_interface_modes = 6});
  EXPECT_EQ(cb.omega.size(), 12u);
  EXPECT_EQ(cb.rigid.size(), 6u);
  for (const double lambda : cb.rigid) EXPECT_LT(std::abs(lambda), 1e-9 * cb.omega[0] * cb.omega[0]);
  const MatrixXd momentum = rigid_motions(model).transpose() * (model.M * cb.Phi);
  EXPECT_LT(momentum.cwiseAbs().maxCoeff(), 1e-12 * std::sqrt(rigid_mass(model).mass));
}

TEST(CraigBampton, SquareBeamBendsInItsOwnPlanes) {
  BeamDef def = straight(square(0.05), steel(), {1, 1, 0.5}, 12);
  def.y_axis = {-1, 1, 0.3};
  const FeModel model = build_beam(def);
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    const CraigBampton cb = craig_bampton(model, {.attachment = attachment, .fixed_interface_modes = 9});
    for (Eigen::Index pair = 0; pair < 2; ++pair) {
      EXPECT_EQ(cb.omega[static_cast<std::size_t>(2 * pair)], cb.omega[static_cast<std::size_t>(2 * pair + 1)]);
      for (const FeNode& node : model.nodes) {
        const auto moved = [&](Eigen::Index k) {
          return Vec3(cb.Phi(node.first, k), cb.Phi(node.first + 1, k), cb.Phi(node.first + 2, k));
        };
        EXPECT_NEAR(dot(moved(2 * pair), model.axes.c[2]), 0, 1e-8) << "the first bends along y";
        EXPECT_NEAR(dot(moved(2 * pair + 1), model.axes.c[1]), 0, 1e-8) << "the second along z";
      }
    }
  }
}

TEST(CraigBampton, LargestTranslationIsPositive) {
  const CraigBampton cb = craig_bampton(build_beam(crooked()), {.fixed_interface_modes = 8});
  for (Eigen::Index k = 0; k < cb.Phi.cols(); ++k) {
    double largest = 0;
    for (Eigen::Index node = 0; node < 7; ++node) {
      for (Eigen::Index a = 0; a < 3; ++a) {
        const double value = cb.Phi(6 * node + a, k);
        if (std::abs(value) > (1 + 1e-6) * std::abs(largest)) largest = value;
      }
    }
    EXPECT_GT(largest, 0) << k;
  }
}

TEST(CraigBampton, DenseAndLanczosAgree) {
  const FeModel model = build_beam(jib_boom(40));
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    CraigBamptonDef def{.attachment = attachment, .fixed_interface_modes = 12, .method = EigenMethod::dense};
    const CraigBampton dense = craig_bampton(model, def);
    def.method = EigenMethod::lanczos;
    const CraigBampton lanczos = craig_bampton(model, def);
    for (std::size_t k = 0; k < dense.omega.size(); ++k) EXPECT_NEAR(lanczos.omega[k] / dense.omega[k], 1, 1e-9) << k;
    EXPECT_LT((dense.Phi - lanczos.Phi).cwiseAbs().maxCoeff(), 1e-6 * dense.Phi.cwiseAbs().maxCoeff());
    const auto a = full_frequencies(model, dense.held, 14, 2500, EigenMethod::dense);
    const auto b = full_frequencies(model, dense.held, 14, 2500, EigenMethod::lanczos);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(b[k] / a[k], 1, 1e-9) << k;
  }
}

// the bits must not depend on where the numbers lie
TEST(CraigBampton, SameBitsWhateverWasAllocatedBefore) {
  const FeModel model = build_beam(jib_boom());
  for (const EigenMethod method : {EigenMethod::dense, EigenMethod::lanczos}) {
    const CraigBamptonDef def{.fixed_interface_modes = 10, .method = method};
    const CraigBampton first = craig_bampton(model, def);
    std::vector<std::vector<char>> between;
    for (std::size_t i = 1; i < 300; ++i) between.emplace_back(8 * i);
    const CraigBampton second = craig_bampton(model, def);
    EXPECT_EQ(first.omega, second.omega);
    EXPECT_TRUE(first.Phi == second.Phi);
  }
}

TEST(CraigBampton, OneElementWithoutAnInsideIsReducedToItself) {
  const FeModel model = at_nodes(build_beam(straight(square(0.1), steel(), {1, 0, 0}, 2)));
  const CraigBampton cb = craig_bampton(model, {.fixed_interface_modes = 0});
  EXPECT_EQ(cb.omega.size(), 6u);
  const std::vector<double> full = full_frequencies(model, cb.held, 6, 0);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(cb.omega[k] / full[k], 1, 1e-12);
}

TEST(CraigBampton, WrongDefinitionsAreNamed) {
  const FeModel model = build_beam(crooked());
  const auto text = [&](const CraigBamptonDef& def) { return error_of([&] { (void)craig_bampton(model, def); }); };
  EXPECT_EQ(text({.clamped_nodes = {12}}),
            "Beam.clamped_nodes: there is no node 12; expected one of its 7 nodes, 1 to 7");
  EXPECT_EQ(text({.interface_nodes = {4, 4}}), "Beam.interface_nodes: node 4 is named twice; expected it once");
  EXPECT_EQ(text({.interface_nodes = {1}}), "Beam.interface_nodes: node 1 is clamped; expected a node that moves");
  EXPECT_EQ(text({.fixed_interface_modes = 67}),
            "Beam.fixed_interface_modes: 67 is out of range; expected 0 to 66, the freedoms inside");
  EXPECT_EQ(text({.fixed_interface_modes = -1}),
            "Beam.fixed_interface_modes: -1 is out of range; expected 0 to 66, the freedoms inside");
  EXPECT_EQ(text({.attachment = Attachment::free, .clamped_nodes = {1}}),
            "Beam.clamped_nodes: a free body has none; expected no nodes; or clamp it");
  EXPECT_NE(text({.attachment = Attachment::free, .interface_nodes = {4}, .fixed_interface_modes = 0})
                .find("has rigid motions only"),
            std::string::npos);
}

}  // namespace craig_bampton_test
}  // namespace slew::flex
