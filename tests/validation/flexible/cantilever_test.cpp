// SPDX-License-Identifier: Apache-2.0
// Case B01 in the floating frame: tip deflection under 1 kN and bending frequencies of the steel cantilever of 2 m,
// over the modes that the body takes. Closed forms of Timoshenko's beam, frequencies from an exact transfer matrix
// (validation/flex/cantilever_test.cpp has the model itself, segments_test.cpp the segments).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/linearised.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace cantilever_test {

using namespace testing;

constexpr double kTip = 1.5267809524e-3;  // m, under 1 kN
constexpr double kFrequencies[] = {20.8463981, 129.12061735, 355.02322634, 678.40561128, 1087.82486431};  // Hz
constexpr double kGravity = 9.81;

// a mass at its tip; kept: modes, empty: all
MechanicsDef cantilever(int elements, int fixed_interface_modes, double mass, const std::vector<int>& kept) {
  MechanicsDef def;
  def.integrator = Integrator::trapezoidal;
  def.bodies = {{.name = "Beam", .type = BodyType::flexible},
                {.name = "Load",
                 .relative_to = "Beam",
                 .position = {2, 0, 0},
                 .mass = mass,
                 .inertia = {1e-9 * mass, 1e-9 * mass, 1e-9 * mass}}};
  def.joints = {{.name = "Root", .type = JointType::fixed, .body2 = "Beam"},
                {.name = "Tip", .type = JointType::fixed, .body1 = "Beam", .point1 = {2, 0, 0}, .body2 = "Load"}};
  const flex::BeamDef beam = flex::testing::cantilever_b01(elements);
  def.flexible_bodies = {
      {.body = "Beam", .modes = slew::testing::modes_of(beam, flex::testing::with_modes(fixed_interface_modes), kept)}};
  return def;
}

double deflection(int elements, int modes, double mass, const std::vector<int>& kept) {
  Mechanism beam(cantilever(elements, modes, mass, kept));
  return beam.value("Beam.deflection.y");
}

// by the load alone: its own weight bends the beam besides
double by_load(int elements, int modes, const std::vector<int>& kept) {
  constexpr double kSmall = 1e-3;  // kg
  return kSmall * kGravity / 1000 * kTip + deflection(elements, modes, kSmall, kept) -
         deflection(elements, modes, 1000 / kGravity, kept);
}

TEST(CantileverOfModes, DeflectsAsInTheClosedForm) {
  for (const int elements : {5, 19}) {
    EXPECT_NEAR(by_load(elements, 4, {}) / kTip, 1, 1e-8) << elements << " elements, all modes";
  }
  // one bending mode a plane, two, three: the error falls
  double before = 1;
  for (const std::vector<int>& kept : {std::vector<int>{1, 2}, {1, 2, 3, 4}, {1, 2, 3, 4, 5, 6}}) {
    const double missing = 1 - by_load(19, 8, kept) / kTip;
    if (std::getenv("SLEWRING_FIGURES") != nullptr) std::printf("| tip | %zu modes | %.2e |\n", kept.size(), missing);
    EXPECT_GT(missing, 0);
    EXPECT_LT(missing, 0.35 * before);
    before = missing;
  }
  EXPECT_LT(before, 4e-3);
}

TEST(CantileverOfModes, HasTheFrequenciesOfTimoshenkosBeam) {
  MechanicsDef def = cantilever(60, 40, 1e-9, {});
  def.gravity = {};
  Mechanism beam(def);
  Linearised linear(beam, {});
  const std::vector<double> f = linear.frequencies();
  for (const double exact : kFrequencies) {
    double best = 0;
    for (const double found : f) best = std::fabs(found - exact) < std::fabs(best - exact) ? found : best;
    if (std::getenv("SLEWRING_FIGURES") != nullptr) std::printf("| %.3f Hz | %.2e |\n", exact, best / exact - 1);
    EXPECT_NEAR(best / exact, 1, 5e-4) << exact << " Hz";
  }
}

}  // namespace cantilever_test
}  // namespace slew::multibody
