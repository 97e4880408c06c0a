// SPDX-License-Identifier: Apache-2.0
// Case B01: statics and frequencies of a steel cantilever of 2 m and 0.1 m square.
//
// Closed forms of Euler's and Timoshenko's beam; frequencies by Timoshenko's from an exact transfer matrix. Statics
// 1e-9 (the shape functions are exact at the nodes); with consistent mass every frequency is (b L/n)^4/1440 too high.
// Figures: docs/validation/B01_cantilever.md.
#include <array>

#include "tests/support/flex_beams.h"
#include "tests/validation/flex/figure.h"

namespace slew::flex {
namespace cantilever_test {

using namespace testing;
using math::Vec3;

constexpr double kForce = 1000;
constexpr double kEuler = 1.5238095238095238e-3, kTimoshenko = 1.5267809523809524e-3;

struct Tip {
  double deflection, slope;
};

// under 1 kN along y at the tip
Tip static_tip(const BeamDef& def) {
  const FeModel model = build_beam(def);
  const int tip = model.nodes.back().first;
  const Eigen::MatrixXd u = static_answer(model, {0, 1, 2, 3, 4, 5}, {tip + 1});
  return {kForce * u(tip + 1, 0), kForce * u(tip + 5, 0)};
}

// lowest frequencies of the clamped beam [Hz]
std::vector<double> frequencies(const BeamDef& def, int count) {
  std::vector<double> f = full_frequencies(build_beam(def), {0, 1, 2, 3, 4, 5}, count, 0);
  for (double& x : f) x = hertz(x);
  return f;
}

double nearest(const std::vector<double>& f, double to) {
  double best = f.front();
  for (const double x : f) {
    if (std::abs(x - to) < std::abs(best - to)) best = x;
  }
  return best;
}

TEST(Cantilever, DeflectsAsInTheClosedForms) {
  for (const int n : {1, 19, 50, 200}) {
    const std::string with = ", " + std::to_string(n) + " elements";
    const Tip euler = static_tip(cantilever_b01(n, Shear::none)), timoshenko = static_tip(cantilever_b01(n));
    expect_figure("B01", "tip, Euler [relative]" + with, std::abs(euler.deflection / kEuler - 1), 1e-9);
    expect_figure("B01", "tip, Timoshenko [relative]" + with, std::abs(timoshenko.deflection / kTimoshenko - 1), 1e-9);
    expect_figure("B01", "slope, Timoshenko [relative]" + with, std::abs(timoshenko.slope / 1.142857142857143e-3 - 1),
                  1e-9);
  }
}

TEST(Cantilever, SagsUnderItsOwnWeight) {
  const FeModel model = build_beam(cantilever_b01(19, Shear::none));
  // the modes of the whole model carry the weight: f_k = C_k . g
  const Reduction all = reduce(model, with_modes(6 * 18));
  std::vector<double> q(all.body.modes());
  const Vec3 g(0, -9.81, 0);
  for (std::size_t k = 0; k < q.size(); ++k) q[k] = dot(all.body.C[k], g) / (all.body.omega[k] * all.body.omega[k]);
  const double sag = -deflection(all.body.nodes.back(), q).y();
  expect_figure("B01", "own weight, Euler [relative]", std::abs(sag / 8.8009714e-4 - 1), 1e-8);
}

// roots b L of cos cosh = -1
constexpr std::array kRoots = {1.8751040687119611, 4.6940911329741746, 7.8547574382376126, 10.995540734875467};

TEST(Cantilever, EulerFrequenciesAreTooHighByTheErrorOfConsistentMass) {
  constexpr std::array kEulerHertz = {20.88791486, 130.90232797, 366.53030872, 718.25311786};
  BeamDef def = cantilever_b01(10, Shear::none);
  def.rotary_inertia = RotaryInertia::none;
  const std::vector<double> f = frequencies(def, 20);
  for (std::size_t k = 0; k < 4; ++k) {
    const double error = nearest(f, kEulerHertz[k]) / kEulerHertz[k] - 1;
    const double expected = std::pow(kRoots[k] / 10, 4) / 1440;
    expect_figure("B01", "Euler mode " + std::to_string(k + 1) + ", error over (bL/n)^4/1440, less 1",
                  std::abs(error / expected - 1), 0.15);
  }
}

// the digits of the transfer matrix end at 1e-9
TEST(Cantilever, TimoshenkoFrequenciesConvergeToTheTransferMatrixWithFourthOrder) {
  constexpr std::array kHertz = {20.8463981, 129.12061735, 355.02322634, 678.40561128, 1087.82486431};
  for (const int n : {10, 20, 60}) {
    const std::vector<double> f = frequencies(cantilever_b01(n), 24);
    for (std::size_t k = 0; k < kHertz.size(); ++k) {
      const double bound = std::pow((k < kRoots.size() ? kRoots[k] : 4.5 * M_PI) / n, 4) / 1440;
      expect_figure("B01",
                    "Timoshenko mode " + std::to_string(k + 1) + ", " + std::to_string(n) + " elements [relative]",
                    std::abs(nearest(f, kHertz[k]) / kHertz[k] - 1), 1.1 * bound + 1e-9);
    }
  }
}

// elements of different lengths, as files have them
TEST(Cantilever, TimoshenkoFrequenciesConvergeOnUnequalElementsToo) {
  constexpr double kHertz = 1087.82486431;
  double before = 0;
  for (const int n : {40, 80}) {
    BeamDef def = cantilever_b01(n);
    // the same growth from end to end
    const double growth = std::pow(4.0, 1.0 / n), whole = (std::pow(growth, n) - 1) / (growth - 1);
    for (int i = 0; i <= n; ++i) {
      def.nodes[static_cast<std::size_t>(i)].position[0] = 2 * (std::pow(growth, i) - 1) / (growth - 1) / whole;
    }
    const double error = std::abs(nearest(frequencies(def, 24), kHertz) / kHertz - 1);
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 4, 0.1);
    }
    before = error;
  }
}

TEST(Cantilever, AxialAndTorsionFrequenciesConvergeWithFourthOrder) {
  for (const int n : {2, 5, 10}) {
    BeamDef def = cantilever_b01(n);
    SectionDef& section = def.sections[0];
    const double I = std::pow(0.1, 4) / 12;
    section = {.area = 0.01, .second_moment_y = I, .second_moment_z = I, .torsion_constant = 2 * I};
    section.shear_factor_y = section.shear_factor_z = 5.0 / 6;
    const std::vector<double> f = frequencies(def, 16);
    const double exact_axial = std::sqrt(2.1e11 / 7850) / 8, exact_torsion = std::sqrt(2.1e11 / 2.6 / 7850) / 8;
    const double axial = std::abs(nearest(f, exact_axial) / exact_axial - 1);
    const double torsion = std::abs(nearest(f, exact_torsion) / exact_torsion - 1);
    const std::string with = ", " + std::to_string(n) + " elements [relative]";
    // quadratic shape functions
    const double bound = std::pow(M_PI / 2 / n, 4) / 1440;
    expect_figure("B01", "axial" + with, axial, 1.1 * bound + 1e-9);
    expect_figure("B01", "torsion" + with, torsion, 1.1 * bound + 1e-9);
  }
}

}  // namespace cantilever_test
}  // namespace slew::flex
