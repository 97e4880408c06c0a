// SPDX-License-Identifier: Apache-2.0
// What small-deflection theory is worth for the jib boom: tip of the level boom under its load by linear beam theory,
// by large deflections (shear and stretch included), and by the floating frame. Card:
// docs/validation/jib_static_deflection.md.
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/linear_crane.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace large_deflection_test {

using namespace testing;
using slew::testing::BoxBeam;

constexpr double kGravity = 9.81;

struct Tip {
  double sag = 0, drawn_in = 0;  // m, down and towards the root
};

// Timoshenko cantilever under its own weight and a load
Tip linear_tip(const BoxBeam& beam, double load) {
  const double P = load * kGravity, w = beam.rho_A() * kGravity, L = beam.length;
  return {P * L * L * L / (3 * beam.EI()) + P * L / beam.kGA() + w * std::pow(L, 4) / (8 * beam.EI()) +
              w * L * L / (2 * beam.kGA()),
          0};
}

// (theta, M, x, y) along the plane beam of Reissner (1972), at s from the root: weights hang straight down, F(s) = P +
// w (L - s), so that with N = -F sin(theta) ... in the axes of the section
//   theta' = M/EI,  x' = (1 + e) cos + g sin,  y' = (1 + e) sin - g cos,  e = F sin/EA,  g = F cos/kGA,  M' = -F x'
// y and theta count downwards. What is left of the moment at the tip, for a moment at the root.
double integrate(const BoxBeam& beam, double load, double root_moment, Tip& tip) {
  constexpr int kSteps = 2000;
  const double h = beam.length / kSteps;
  std::array<double, 4> x = {0, root_moment, 0, 0};
  const auto rate = [&](double s, const std::array<double, 4>& z) {
    const double F = (load + beam.rho_A() * (beam.length - s)) * kGravity;
    const double sine = std::sin(z[0]), cosine = std::cos(z[0]);
    const double stretch = 1 + F * sine / beam.EA(), shear = F * cosine / beam.kGA();
    const double along = stretch * cosine - shear * sine;
    return std::array<double, 4>{z[1] / beam.EI(), -F * along, along, stretch * sine + shear * cosine};
  };
  const auto moved = [](const std::array<double, 4>& z, double t, const std::array<double, 4>& r) {
    std::array<double, 4> y{};
    for (std::size_t k = 0; k < 4; ++k) y[k] = z[k] + t * r[k];
    return y;
  };
  for (int i = 0; i < kSteps; ++i) {
    const double s = i * h;
    const auto a = rate(s, x), b = rate(s + h / 2, moved(x, h / 2, a)), c = rate(s + h / 2, moved(x, h / 2, b)),
               d = rate(s + h, moved(x, h, c));
    for (std::size_t k = 0; k < 4; ++k) x[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  tip = {x[3], beam.length - x[2]};
  return x[1];
}

Tip large_tip(const BoxBeam& beam, double load) {
  Tip tip;
  double low = 0, high = 2 * (load + beam.rho_A() * beam.length) * kGravity * beam.length;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (integrate(beam, load, middle, tip) > 0 ? high : low) = middle;
  }
  return tip;
}

// the boom held level at its root with a body at its tip, as it rests in the floating frame
Tip floating_tip(double load, double youngs_modulus, int modes, flex::GeometricStiffening stiffening) {
  const Triple end = {-6.5, 0.02904, 0.1507};
  MechanicsDef def;
  def.bodies = {{.name = "Boom", .type = BodyType::flexible},
                {.name = "Load", .relative_to = "Boom", .position = end, .mass = load, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Boom"},
                {.name = "Hook", .type = JointType::fixed, .body1 = "Boom", .point1 = end, .body2 = "Load"}};
  flex::ReductionDef reduction = flex::testing::with_modes(10);
  reduction.stiffening = stiffening;
  flex::BeamDef beam = flex::testing::jib_boom(20, youngs_modulus);
  std::vector<int> kept;
  for (int k = 1; k <= modes; ++k) kept.push_back(k);
  def.flexible_bodies = {{.body = "Boom", .modes = slew::testing::modes_of(beam, reduction, kept)}};
  Mechanism boom(def);
  const Triple tip = boom.pose("Load").position;
  return {end[1] - tip[1], tip[0] - end[0]};
}

TEST(JibDeflection, LinearTheoryIsRightWhileItIsSmall) {
  struct Case {
    double load, modulus, linear_error;  // relative, beyond large deflections: bound
  };
  for (const Case c : {Case{500, 2e11, 1e-3}, {1500, 2e11, 2e-3}, {500, 2e10, 0.02}, {1500, 2e10, 0.15}}) {
    const BoxBeam beam{.youngs_modulus = c.modulus};
    const Tip linear = linear_tip(beam, c.load), large = large_tip(beam, c.load);
    const double over = linear.sag / large.sag - 1;
    EXPECT_GT(over, 0);
    EXPECT_LT(over, c.linear_error) << c.load << " kg, " << c.modulus;
    for (const int modes : {2, 4}) {
      const double share = modes == 2 ? 0.04 : 0.01;
      const Tip plain = floating_tip(c.load, c.modulus, modes, flex::GeometricStiffening::none);
      EXPECT_NEAR(plain.sag, linear.sag, share * linear.sag);
      EXPECT_NEAR(plain.drawn_in, 0, 1e-9);
      // the way that the tip is drawn in is of second order, and there with stiffening alone
      const Tip curved = floating_tip(c.load, c.modulus, modes, flex::GeometricStiffening::straight_beam);
      EXPECT_NEAR(curved.sag, linear.sag, share * linear.sag);
      EXPECT_NEAR(curved.drawn_in, large.drawn_in, (0.1 + 3 * over) * large.drawn_in);
      if (std::getenv("SLEWRING_FIGURES") == nullptr) continue;
      std::printf("| %g | %.0e | %d | %.5f | %.5f | %.4f | %.5f | %.5f | %.5f | %.5f |\n", c.load, c.modulus, modes,
                  linear.sag, large.sag, over, plain.sag, curved.sag, large.drawn_in, curved.drawn_in);
    }
  }
}

// Euler's elastica under a load alone: P L^2/(E I) = 1 gives 0.3017 L down and 0.0564 L in (Bisshopp and Drucker 1945)
TEST(JibDeflection, TheLargeDeflectionSolverGivesTheElastica) {
  // long and thin enough for shear, stretch and weight to vanish beside bending
  BoxBeam beam{.youngs_modulus = 1e25, .length = 6500};
  const double load = beam.EI() / (beam.length * beam.length * kGravity);
  const Tip tip = large_tip(beam, load);
  EXPECT_NEAR(tip.sag / beam.length, 0.30172, 2e-5);
  EXPECT_NEAR(tip.drawn_in / beam.length, 0.05643, 2e-5);
}

}  // namespace large_deflection_test
}  // namespace slew::multibody
