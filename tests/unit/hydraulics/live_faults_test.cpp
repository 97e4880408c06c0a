// SPDX-License-Identifier: Apache-2.0
// Faults of a machine as live parameters (docs/howto/machine-faults.md): nothing before, by hand afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/spool_valve.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace live_faults_test {

// sqrt(p - p_t) falls by K t B/(2 V): 100 bar in 1 l of oil through half of a hole of 1 mm.
TEST(LiveFaults, a_leak_that_opens_empties_its_volume_as_the_closed_form) {
  CircuitRig rig;
  rig.def.oil_bulk_modulus = 1.5e9, rig.def.entrained_air = 0, rig.def.orifice_transition = 10;
  rig.def.start = StartState::table13, rig.def.relative_tolerance = 1e-6;
  add_volume(rig.def, "Line", 101 * kBar).rigid_volume = 1e-3;
  add_tank(rig.def, "Outside", 1 * kBar);
  OrificeDef& leak = add<OrificeDef>(rig.def, "Leak");
  leak.port_1 = "Line", leak.port_2 = "Outside", leak.diameter = 1e-3, leak.opening = 0;
  rig.run(1);
  EXPECT_EQ(rig.variable("Line.pressure"), 101 * kBar);
  rig.set("Leak.opening", 0.5);
  const double K = 0.5 * 0.67 * std::numbers::pi / 4 * 1e-6 * std::sqrt(2 / rig.def.oil_density);
  rig.run(0.1);
  const double root = std::sqrt(100 * kBar) - 0.1 * K * 1.5e9 / (2 * 1e-3);
  EXPECT_NEAR(rig.variable("Line.pressure") - 1 * kBar, root * root, 1e-4 * 100 * kBar);
}

// tau = step_response/3: 0.1 s before, 0.6 s while slow; a stuck spool stays, and moves when it is free again.
TEST(LiveFaults, a_spool_becomes_slow_and_sticks) {
  CircuitRig rig;
  add_tank(rig.def, "P", 100 * kBar), add_tank(rig.def, "A"), add_tank(rig.def, "B"), add_tank(rig.def, "T");
  SpoolValveDef& valve = add<SpoolValveDef>(rig.def, "Valve");
  valve.port_p = "P", valve.port_a = "A", valve.port_b = "B", valve.port_t = "T", valve.step_response = 0.3;
  rig.run(0);
  rig.set_signal("Valve", 1);
  rig.run(0.1);
  const double before = 1 - std::exp(-1);
  EXPECT_NEAR(rig.variable("Valve.spool_position"), before, 1e-4);
  rig.set("Valve.step_response", 1.8);
  rig.run(0.3);
  const double slow = 1 - (1 - before) * std::exp(-0.5);
  EXPECT_NEAR(rig.variable("Valve.spool_position"), slow, 1e-4);
  rig.set("Valve.step_response", 1e6);
  rig.set_signal("Valve", -1);
  rig.run(10);
  EXPECT_NEAR(rig.variable("Valve.spool_position"), slow, 1e-4);
  rig.set("Valve.step_response", 0.3);
  rig.run(1);
  EXPECT_NEAR(rig.variable("Valve.spool_position"), -1, 1e-3);
}

}  // namespace live_faults_test
}  // namespace slew::hydraulics::test
