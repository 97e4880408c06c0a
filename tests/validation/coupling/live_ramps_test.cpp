// SPDX-License-Identifier: Apache-2.0
// Ramps of live parameters against closed forms: their error is of second order in the step, divided and undivided.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace live_ramps_test {

constexpr double kRamp = 0.1;  // s

constexpr const char* kScene = R"(
mechanics: {gravity: [0, 0, 0]}
hydraulics: {entrained_air: 0, oil_bulk_modulus: 1.5 GPa, start: table13}
bodies:
  Load: {mass: 1 kg, inertia: [1, 1, 1]}
joints:
  Rail: {type: prismatic, body2: Load}
forces:
  Push: {type: point_force, body: Load, direction: [0, 0, 1], force: 0}
volumes:
  T: {initial_pressure: 2 bar, fixed: true}
  V: {initial_pressure: 2 bar, rigid_volume: 1 l}
components:
  Source: {type: flow_source, port_1: T, port_2: V, flow: 0}
session: {duration: 1 s, pace: free}
)";

struct End {
  double way, speed, pressure;  // m, m/s, Pa
};

End play(const char* solution, double H) {
  const scene::Scene scene = scene::load_text(
      kScene, "live_ramps",
      {std::string("session.solution=") + solution, "session.step=" + std::to_string(1e3 * H) + " ms"});
  CoupledRun run(scene);
  EXPECT_TRUE(run.start().is_ok());
  run.change("Push.force", 10, duration_of_seconds(kRamp));
  run.change("Source.flow", 1e-4, duration_of_seconds(kRamp));
  for (long n = 0; n < std::lround(kRamp / H); ++n) run.step({});
  EXPECT_FALSE(run.has_failed());
  return {run.variable("Rail.position"), run.variable("Rail.velocity"), run.variable("V.pressure")};
}

TEST(LiveRamps, AreOfSecondOrderInTheStep) {
  // F = 100 t: s = 100 t^3/6; V p' = B 1e-3 t
  const double way = 100 * kRamp * kRamp * kRamp / 6, speed = 50 * kRamp * kRamp;
  const double pressure = 2e5 + 1.5e9 / 1e-3 * 0.5 * 1e-4 * kRamp;
  for (const char* solution : {"split", "monolithic"}) {
    SCOPED_TRACE(solution);
    const End coarse = play(solution, 10e-3), fine = play(solution, 5e-3);
    EXPECT_NEAR(coarse.way, way, 0.01 * way);
    EXPECT_NEAR((coarse.way - way) / (fine.way - way), 4, 0.1);
    // integrals of the ramp itself
    EXPECT_NEAR(coarse.speed, speed, 1e-6 * speed);
    EXPECT_NEAR(coarse.pressure, pressure, 1e-4 * pressure);
  }
}

}  // namespace live_ramps_test
}  // namespace slew::coupling::test
