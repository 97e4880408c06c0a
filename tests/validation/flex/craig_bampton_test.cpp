// SPDX-License-Identifier: Apache-2.0
// Case B06: accuracy of Craig and Bampton's reduction of a beam of 19 elements, 20 nodes, both ends interfaces.
//
// Reference: an independent computation of one bending plane of Euler's beam with consistent mass
// (craig_bampton_19el_freefree_cantilever.csv: relative errors against the full model). Tolerance: each error to 1 % of
// itself, which is three units of its last digit for the smallest. The plane is made to come first here by a section
// that is 100 times stiffer in the other one. Figures: docs/validation/B06_craig_bampton.md.
#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "build_paths.h"
#include "tests/support/flex_beams.h"
#include "tests/validation/flex/figure.h"

namespace slew::flex {
namespace craig_bampton_test {

using namespace testing;

constexpr int kElements = 19;

// 1 m, bending stiffness and mass per length 1: frequencies are (b L)^2
BeamDef unit_beam() {
  BeamDef def = straight(
      {.area = 1, .second_moment_y = 1e-4, .second_moment_z = 1e-8, .torsion_constant = 1e-4, .shear = Shear::none},
      {.youngs_modulus = 1e8, .poisson_ratio = 0, .shear_modulus = 0, .density = 1}, {1, 0, 0}, kElements + 1);
  def.rotary_inertia = RotaryInertia::none;
  return def;
}

struct Row {
  int attachment, modes;
  std::vector<double> errors;
};

std::vector<Row> reference() {
  std::ifstream file(std::string(SLEWRING_SOURCE_DIR) +
                     "/tests/validation/data/craig_bampton_19el_freefree_cantilever.csv");
  EXPECT_TRUE(file.is_open());
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::vector<double> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
    rows.push_back({static_cast<int>(values[0]), static_cast<int>(values[1]), {values.begin() + 2, values.end()}});
  }
  return rows;
}

// modes that bend in the x-y plane
std::vector<double> bending(const FeModel& model, const CraigBamptonDef& def) {
  const CraigBampton cb = craig_bampton(model, def);
  std::vector<double> omega;
  for (std::size_t k = 0; k < cb.omega.size(); ++k) {
    double along = 0, all = 0;
    for (const FeNode& node : model.nodes) {
      for (int a = 0; a < 3; ++a) {
        const double u = cb.Phi(node.first + a, static_cast<Eigen::Index>(k));
        all += u * u;
        if (a == 1) along += u * u;
      }
    }
    if (along > 0.5 * all && all > 1e-12) omega.push_back(cb.omega[k]);
  }
  return omega;
}

TEST(CraigBamptonCase, FullModelHasTheErrorsOfItsElements) {
  constexpr std::array kRoots = {1.8751040687119611, 4.694091132974175, 7.854757438237613,
                                 10.99554073487547,  14.13716839104647, 17.27875953208824};
  constexpr std::array kErrors = {6.6e-8, 2.57e-6, 2.01e-5, 7.66e-5, 2.07e-4, 4.58e-4};
  const std::vector<double> omega = full_frequencies(build_beam(unit_beam()), {0, 1, 2, 3, 4, 5}, 6, 0);
  for (std::size_t k = 0; k < 6; ++k) {
    const double error = omega[k] / (kRoots[k] * kRoots[k]) - 1;
    expect_figure("B06", "full model, mode " + std::to_string(k + 1) + ", error less tabulated, of itself",
                  std::abs(error / kErrors[k] - 1), 0.01);
  }
}

TEST(CraigBamptonCase, InsideHasTheTabulatedFrequencies) {
  CraigBamptonDef def{.interface_nodes = {20}, .fixed_interface_modes = 4};
  const CraigBampton cb = craig_bampton(build_beam(unit_beam()), def);
  constexpr std::array kTabulated = {22.373345, 61.674068, 120.912736, 199.901419};
  for (std::size_t k = 0; k < 4; ++k)
    expect_figure("B06", "held inside, mode " + std::to_string(k + 1) + " [relative]",
                  std::abs(cb.fixed_interface[k] / kTabulated[k] - 1), 5e-8);
}

TEST(CraigBamptonCase, EveryTabulatedErrorIsMet) {
  const FeModel model = build_beam(unit_beam());
  double worst = 0;
  int count = 0;
  for (const Row& row : reference()) {
    if (row.attachment > 1) continue;
    const bool is_free = row.attachment == 0;
    const CraigBamptonDef def{.attachment = is_free ? Attachment::free : Attachment::clamped,
                              .fixed_interface_modes = row.modes};
    const std::vector<double> reduced = bending(model, def);
    const std::vector<double> full =
        full_frequencies(model, is_free ? std::vector<int>{} : std::vector<int>{0, 1, 2, 3, 4, 5}, 6, 500);
    for (std::size_t k = 0; k < row.errors.size(); ++k) {
      if (std::isnan(row.errors[k])) continue;
      ASSERT_LT(k, reduced.size());
      const double error = reduced[k] / full[k] - 1;
      EXPECT_NEAR(error, row.errors[k], 0.01 * row.errors[k])
          << (is_free ? "free" : "clamped") << ", " << row.modes << " modes, mode " << k + 1;
      worst = std::max(worst, std::abs(error / row.errors[k] - 1));
      ++count;
    }
  }
  EXPECT_GT(count, 60);
  expect_figure("B06", "worst of " + std::to_string(count) + " tabulated errors, of itself", worst, 0.01);
}

// L = 4 m, hollow rectangle 0.12 x 0.18 x 0.008 m; the tall side bends
BeamDef example(double youngs_modulus) {
  SectionDef section{.shape = SectionShape::hollow_rectangle, .width = 0.18, .height = 0.12, .wall = 0.008};
  section.shear = Shear::none;
  BeamDef def = straight(section, steel(youngs_modulus, 7850), {4, 0, 0}, kElements + 1);
  def.rotary_inertia = RotaryInertia::none;
  return def;
}

TEST(CraigBamptonCase, ExamplesHaveTheirFrequenciesAndDeflection) {
  // the tabulated frequencies are exact; what 19 elements are above them is tabulated too
  constexpr std::array kStiff = {11.738741, 73.565436, 205.985352}, kSoft = {3.712116, 23.263434, 65.138288};
  constexpr std::array kElementErrors = {6.6e-8, 2.57e-6, 2.01e-5};
  for (const bool is_stiff : {true, false}) {
    const FeModel model = build_beam(example(is_stiff ? 2e11 : 2e10));
    const std::vector<double> omega = bending(model, {.fixed_interface_modes = 128});
    for (std::size_t k = 0; k < 3; ++k)
      expect_figure("B06",
                    std::string(is_stiff ? "E 2e11" : "E 2e10") + ", mode " + std::to_string(k + 1) + " [relative]",
                    std::abs(hertz(omega[k]) / (is_stiff ? kStiff[k] : kSoft[k]) - 1 - kElementErrors[k]), 2e-7);
    const int tip = model.nodes.back().first;
    const double moved = 1000 * static_answer(model, {0, 1, 2, 3, 4, 5}, {tip + 1})(tip + 1, 0);
    expect_figure("B06", std::string("tip under 1 kN, ") + (is_stiff ? "E 2e11" : "E 2e10") + " [relative]",
                  std::abs(moved / (is_stiff ? 5.30896e-3 : 5.30896e-2) - 1), 1e-6);
  }
}

TEST(CraigBamptonCase, TenthOfTheStiffnessDividesEveryFrequencyByRootTen) {
  const FeModel stiff = build_beam(example(2e11)), soft = build_beam(example(2e10));
  const CraigBamptonDef def{.fixed_interface_modes = 8};
  const std::vector<double> a = craig_bampton(stiff, def).omega, b = craig_bampton(soft, def).omega;
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] / b[k] / std::sqrt(10.0) - 1));
  expect_figure("B06", "E 2e11 over 2e10 against sqrt(10), worst mode", worst, 1e-9);
}

TEST(CraigBamptonCase, InterfacesAreStaticallyExactWithAnyNumberOfModes) {
  const FeModel model = build_beam(example(2e11));
  const double I = (0.12 * std::pow(0.18, 3) - 0.104 * std::pow(0.164, 3)) / 12, exact = 64 / (3 * 2e11 * I);
  for (const int modes : {0, 3, 10}) {
    const Reduction r = reduce(model, with_modes(modes));
    double compliance = 0;
    for (std::size_t k = 0; k < r.body.modes(); ++k) {
      const double phi = r.body.nodes.back().phi[k].y();
      compliance += phi * phi / (r.body.omega[k] * r.body.omega[k]);
    }
    expect_figure("B06", "tip compliance, " + std::to_string(modes) + " modes inside [relative]",
                  std::abs(compliance / exact - 1), 1e-9);
  }
}

TEST(CraigBamptonCase, AnotherModeNeverRaisesAFrequency) {
  const FeModel model = build_beam(unit_beam());
  for (const Attachment attachment : {Attachment::clamped, Attachment::free}) {
    std::vector<double> before;
    for (int modes = 2; modes <= 14; ++modes) {
      const std::vector<double> omega =
          craig_bampton(model, {.attachment = attachment, .fixed_interface_modes = modes}).omega;
      for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LE(omega[k], before[k] * (1 + 1e-9)) << modes << ' ' << k;
      before = omega;
    }
  }
}

}  // namespace craig_bampton_test
}  // namespace slew::flex
