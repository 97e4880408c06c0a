// SPDX-License-Identifier: Apache-2.0
// Case D02, a spring and a damper side by side (Kelvin and Voigt): a mass of 1 kg runs into them and comes back with
// the share e of its speed, counted where the spring is as long as before or where it would begin to pull. The force
// elements' law: the spring-damper itself pulls on, its end damper lets go. Closed form, six digits; 1e-3.
// Figures: docs/validation/D02_bouncing_ball.md.
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace kelvin_voigt_test {

using testing::expect_figure;
using testing::Formulated;

constexpr double kStiffness = 1e4, kStep = 1e-5;  // N/m and 1 kg: 100 rad/s

struct Rebound {
  double ratio, until_length, until_force;  // damping ratio; e
};
constexpr Rebound kRebounds[] = {
    {.05, .854468, .858758}, {.1, .729248, .744079}, {.2, .526621, .571740}, {.4, .253827, .363527}};

MechanicsDef buffer(double ratio, bool is_end_damper) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Car", .mass = 1, .inertia = {0.1, 0.1, 0.1}}};
  def.joints = {{.name = "Rail",
                 .orientation1 = {0, M_PI / 2, 0},
                 .body2 = "Car",
                 .orientation2 = {0, M_PI / 2, 0},
                 .initial_velocity = -1}};
  def.joints[0].type = JointType::prismatic;
  TranslationalForceDef force{.name = "Buffer", .body1 = "Ground", .point1 = {-1, 0, 0}, .body2 = "Car"};
  const double damping = 2 * ratio * std::sqrt(kStiffness);
  if (is_end_damper) {
    force.min_length = 1;
    force.end_spring_constant = kStiffness;
    force.end_damping_constant = damping;
  } else {
    force.free_length = 1;
    force.spring_constant = kStiffness;
    force.damping_constant = damping;
  }
  def.translational_forces = {force};
  return def;
}

class KelvinVoigt : public testing::EveryFormulation {};

TEST_P(KelvinVoigt, ReboundsWithTheShareOfTheClosedForm) {
  double until_length = 0, until_force = 0;
  for (const Rebound& rebound : kRebounds) {
    Formulated bouncing = start(buffer(rebound.ratio, false));
    double x = 0, v = -1, before = 0, v_before = -1;
    for (int i = 0; i < 10000 && !(x > 0); ++i) {
      before = x;
      v_before = v;
      bouncing.run(kStep, kStep);
      x = bouncing.pose("Car").position[0];
      v = bouncing.pose("Car").velocity[0];
    }
    ASSERT_GT(x, 0);
    const double at_length = v_before + (v - v_before) * (0 - before) / (x - before);
    until_length = std::max(until_length, std::fabs(at_length - rebound.until_length));

    Formulated pushed = start(buffer(rebound.ratio, true));
    pushed.run(0.1, kStep);
    EXPECT_GT(pushed.pose("Car").position[0], 0);
    until_force = std::max(until_force, std::fabs(pushed.pose("Car").velocity[0] - rebound.until_force));
  }
  expect_figure("D02", setting(kStep), {"spring-damper: e where the length is back", until_length, 1e-3});
  expect_figure("D02", setting(kStep), {"end damper: e where it lets go", until_force, 1e-3});
}

INSTANTIATE_TEST_SUITE_P(In, KelvinVoigt, testing::kEveryFormulation, testing::kFormulationName);

}  // namespace kelvin_voigt_test
}  // namespace slew::multibody
