// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of the whole flexible crane, valves and oil included, against the linear model that shares no code with
// it (linear_crane.h). Card: docs/validation/crane_frequencies.md.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "monolith/linearisation.h"
#include "tests/validation/flexible/linear_crane.h"

namespace slew::monolith {
namespace crane_eigenvalues_test {

// Without the dampers at the bag's hook, which leave it no swing. In the plane of lifting, where the slewing that the
// linear model locks takes no part: the bag fore and aft, the load on oil and boom, the booms on the oil. Two modes of
// the boom leave out 3 % of its compliance: tolerances are those of the card.
TEST(CraneEigenvalues, AreThoseOfTheLinearModelInThePlaneOfLifting) {
  const scene::Scene scene =
      scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane_flexible.yaml",
                       {"ForceR_FrictionX.damping_constant=0", "ForceR_FrictionY.damping_constant=0",
                        "ForceR_FrictionZ.damping_constant=0"});
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample m, h;
  ASSERT_TRUE(mechanics.first_sample(m));
  ASSERT_TRUE(hydraulics.start({&m.mechanism, nullptr}, h).is_ok());
  double K_lift = 0, K_jib = 0;
  for (std::size_t i = 0; i < scene.ports.size(); ++i) {
    if (scene.ports[i].force == "ForceT_Lift") K_lift = h.actuators.K[i];
    if (scene.ports[i].force == "ForceT_Jib") K_jib = h.actuators.K[i];
  }
  const std::vector<double> exact =
      testing::linear_crane_frequencies({.lift_stiffness = K_lift, .jib_stiffness = K_jib, .payload = 500});
  SceneEquations equations(scene);
  std::vector<double> y(equations.size());
  equations.take(mechanics.model(), mechanics.state(), &hydraulics.circuit(), hydraulics.integrator().state(), y);
  equations.neglect_dry_friction();
  SceneModes modes;
  ASSERT_TRUE(find_modes(equations, 0, y, Part::all, modes).is_ok());
  for (const auto& [k, tolerance] : {std::pair<std::size_t, double>{1, 2e-3}, {2, 6e-3}, {4, 0.06}}) {
    double nearest = 0;
    for (const SceneMode& mode : modes.modes) {
      const double f = std::abs(mode.value) / (2 * std::numbers::pi);
      if (mode.value.imag() > 0 && std::fabs(f - exact[k]) < std::fabs(nearest - exact[k])) nearest = f;
    }
    EXPECT_NEAR(nearest / exact[k], 1, tolerance) << nearest << " Hz, exact " << exact[k];
  }
}

}  // namespace crane_eigenvalues_test
}  // namespace slew::monolith
