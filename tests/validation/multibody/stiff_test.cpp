// SPDX-License-Identifier: Apache-2.0
// Springs and stops far stiffer than the sub-step resolves, against their closed forms.
#include "tests/validation/multibody/choices.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace stiff_test {

using testing::Choice;
using testing::Formulated;

// 1 kg on a slide along x, `offset` from where its spring is at rest
MechanicsDef slide(double offset) {
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies.push_back({.name = "Cube", .position = {offset, 0, 0}, .mass = 1, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "Slide",
                        .type = JointType::prismatic,
                        .orientation1 = {0, M_PI / 2, 0},
                        .body2 = "Cube",
                        .orientation2 = {0, M_PI / 2, 0}});
  def.translational_forces.push_back(
      {.name = "Spring", .body1 = "Cube", .body2 = "Ground", .point2 = {-1, 0, 0}, .free_length = 1});
  return def;
}

class Stiff : public ::testing::TestWithParam<Choice> {
 protected:
  [[nodiscard]] static Formulated start(MechanicsDef def) {
    std::tie(def.formulation, def.integrator) = GetParam();
    return Formulated(def);
  }
  [[nodiscard]] static Integrator integrator() { return std::get<1>(GetParam()); }
};

// growth of one step on x'' = -w^2 x, w h = 31.6: |R| of the method's stability function at i w h
TEST_P(Stiff, SpringOf1e9IsStableInStepsOf1msAndDampedAsInTheRule) {
  MechanicsDef def = slide(1e-3);
  def.translational_forces[0].spring_constant = 1e9;
  Formulated cube = start(def);
  const double begin = cube.total_energy();
  cube.run(0.02, 1e-3);
  const double left = cube.total_energy() / begin;
  if (integrator() == Integrator::trapezoidal) {
    EXPECT_NEAR(left, 1, 1e-6);
  } else {
    EXPECT_LT(left, 5e-2);
  }
  if (integrator() == Integrator::sdirk2) {
    // |R(iy)|^2 = (1 + (2 gamma - 1)^2 y^2) / (1 + gamma^2 y^2)^2
    const double gamma = 1 - std::sqrt(0.5), y = std::sqrt(1e9) * 1e-3;
    const double shrink = (1 + std::pow((1 - 2 * gamma) * y, 2)) / std::pow(1 + std::pow(gamma * y, 2), 2);
    Formulated once = start(def);
    once.run(1e-3, 1e-3);
    EXPECT_NEAR(once.total_energy() / begin, shrink, 1e-6 * shrink);
    // no ringing: gone, not only bounded
    EXPECT_LT(left, 1e-20);
  }
}

MechanicsDef stop(double damping) {
  MechanicsDef def = slide(0);
  def.joints[0].initial_velocity = 1;
  def.translational_forces[0].max_length = 1.01;
  def.translational_forces[0].end_spring_constant = 1e9;
  def.translational_forces[0].end_damping_constant = damping;
  return def;
}

// a touch of 0.1 ms, less than a sub-step: no speed comes out of it that did not go in
TEST_P(Stiff, StopThatIsShorterThanAStepGivesNoEnergy) {
  for (const double damping : {0.0, 1e3, 1e5}) {
    Formulated cube = start(stop(damping));
    double energy = cube.total_energy();
    for (int i = 0; i < 50; ++i) {
      cube.run(1e-3, 1e-3);
      EXPECT_LE(cube.total_energy(), energy * (1 + 1e-12));
      energy = cube.total_energy();
    }
    EXPECT_LT(cube.pose("Cube").position[0], 0.01);
    EXPECT_GT(cube.pose("Cube").position[0], 0.009);
  }
}

// steps that resolve the touch: rebound of an undamped stop, and of one with the damping ratio zeta, whose push ends
// when its damper would pull: e = exp(-zeta/s (pi - 2 asin(... ))) in closed form, s = sqrt(1 - zeta^2)
TEST_P(Stiff, StopReboundsAsItsClosedFormWhenStepsResolveIt) {
  const double w = std::sqrt(1e9), zeta = 0.2, s = std::sqrt(1 - zeta * zeta);
  for (const double damping : {0.0, 2 * zeta * w}) {
    Formulated cube = start(stop(damping));
    cube.run(0.0101, 1e-6);
    cube.run(0.001, 1e-4);
    // push zero: x' = -w/(2 zeta) x after the phase pi - acos(...): tan(s w t) = 2 zeta s / (2 zeta^2 - 1)
    const double phase = std::atan2(2 * zeta * s, 2 * zeta * zeta - 1);
    const double rebound = damping > 0 ? std::exp(-zeta / s * phase) : 1;
    EXPECT_NEAR(cube.pose("Cube").velocity[0], -rebound, 0.02);
  }
}

// ten links on hinges with springs of 1e7 N m/rad: a rod, nearly; its tip sags by the statics of the springs
TEST_P(Stiff, ChainOfStiffHingesStaysARod) {
  constexpr int kLinks = 10;
  constexpr double kStiffness = 1e7;
  MechanicsDef def;
  for (int i = 0; i < kLinks; ++i) {
    const std::string name = "L" + std::to_string(i), inner = i > 0 ? "L" + std::to_string(i - 1) : "Ground";
    def.bodies.push_back({.name = name,
                          .position = {static_cast<double>(i), 0, 0},
                          .mass = 1,
                          .center_of_mass = {0.5, 0, 0},
                          .inertia = {0.01, 1.0 / 12, 1.0 / 12}});
    def.joints.push_back(
        {.name = "J" + std::to_string(i), .body1 = inner, .point1 = {i > 0 ? 1.0 : 0.0, 0, 0}, .body2 = name});
    def.rotational_forces.push_back({.name = "R" + std::to_string(i),
                                     .body1 = inner,
                                     .f1 = {1, 0, 0},
                                     .g1 = {0, 1, 0},
                                     .body2 = name,
                                     .f2 = {1, 0, 0},
                                     .spring_constant = kStiffness,
                                     .damping_constant = 1e6});
  }
  Formulated chain = start(def);
  chain.run(20, 5e-3);
  // moment at hinge i: the weight of what hangs on it
  for (int i = 0; i < kLinks; ++i) {
    const double hanging = kLinks - i, moment = 9.81 * hanging * hanging / 2;
    EXPECT_NEAR(chain.value("J" + std::to_string(i) + ".position"), -moment / kStiffness, 1e-2 * moment / kStiffness);
  }
}

const testing::Rules kRules = {Integrator::trapezoidal, Integrator::generalised_alpha, Integrator::sdirk2};
const testing::Rules kInBodyCoordinates = {Integrator::sdirk2};
INSTANTIATE_TEST_SUITE_P(In, Stiff, ::testing::ValuesIn(testing::gate_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);
INSTANTIATE_TEST_SUITE_P(Nightly, Stiff, ::testing::ValuesIn(testing::nightly_choices(kRules, kInBodyCoordinates)),
                         testing::kChoiceName);

}  // namespace stiff_test
}  // namespace slew::multibody
