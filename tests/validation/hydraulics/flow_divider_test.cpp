// SPDX-License-Identifier: Apache-2.0
// Flow dividers and combiners against their static balance, solved by bisection, and the balance of power.
#include "hydraulics/components/flow_divider.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace flow_divider_test {

constexpr double kFlow = 40 * kLitrePerMinute;

// A source into the common port, branches at fixed pressures above 1 bar.
template <typename Divider>
class Rig : public CircuitRig {
 public:
  Rig(double flow, double load_2, double load_3) {
    def.orifice_transition = 10, def.start = StartState::table13, def.relative_tolerance = 1e-6;
    add_tank(def, "Tank"), add_tank(def, "Load_2", 1 * kBar + load_2), add_tank(def, "Load_3", 1 * kBar + load_3);
    add_volume(def, "Common", 1 * kBar + std::fmax(load_2, load_3)).rigid_volume = 1e-3;
    FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
    source.port_1 = "Tank", source.port_2 = "Common", source.flow = flow;
    Divider& own = add<Divider>(def, "Divider");
    own.port_1 = "Common", own.port_2 = "Load_2", own.port_3 = "Load_3";
  }
  Divider& divider() { return dynamic_cast<Divider&>(*def.components.back()); }
  double flow(int branch) { return variable("Divider.flow_" + std::to_string(branch)); }
};

using SpoolRig = Rig<FlowDividerDef>;
using GearRig = Rig<GearFlowDividerDef>;

// Flows at the spool's rest: Q_2 + Q_3 = Q with d_2 - d_3 = regulation y, where K_i and w_i are those of the header.
std::pair<double, double> resting_flows(const FlowDividerDef& def, double Q, double load_2, double load_3) {
  const double K = def.nominal_flow / std::sqrt(def.metering_pressure_drop);
  const double K_2 = def.share * K, K_3 = (1 - def.share) * K;
  const double k_2 = def.spool_pressure_drop / def.metering_pressure_drop;
  const auto open = [&](double shut) {
    const double w = 1 - (1 - def.least_opening) * std::fmax(shut, 0);
    return w / std::sqrt(w * w + k_2);
  };
  const auto through = [](double K_i, double drop) { return std::copysign(K_i * std::sqrt(std::fabs(drop)), drop); };
  const auto flows_at = [&](double y) {
    double low = std::fmin(load_2, load_3) - 500 * kBar, high = std::fmax(load_2, load_3) + 500 * kBar;
    for (int k = 0; k < 100; ++k) {
      const double p = 0.5 * (low + high);
      const double sum = through(K_2 * open(y), p - load_2) + through(K_3 * open(-y), p - load_3);
      (sum < Q ? low : high) = p;
    }
    return std::pair{through(K_2 * open(y), low - load_2), through(K_3 * open(-y), low - load_3)};
  };
  double low = -1, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double y = 0.5 * (low + high);
    const auto [Q_2, Q_3] = flows_at(y);
    const double d = std::fabs(Q_2) * Q_2 / (K_2 * K_2) - std::fabs(Q_3) * Q_3 / (K_3 * K_3);
    (std::copysign(d, Q * d) > def.regulation_pressure * y ? low : high) = y;
  }
  return flows_at(low);
}

TEST(ValidationFlowDivider, divides_and_combines_by_its_share_whatever_the_loads) {
  for (const double share : {0.5, 0.3}) {
    for (const double flow : {kFlow, 0.5 * kFlow, -kFlow}) {
      for (const auto& [load_2, load_3] : {std::pair{200.0, 150.0}, {150.0, 200.0}, {180.0, 180.0}}) {
        SpoolRig rig(flow, load_2 * kBar, load_3 * kBar);
        FlowDividerDef& def = rig.divider();
        def.nominal_flow = kFlow, def.share = share;
        rig.run(3);
        const auto [Q_2, Q_3] = resting_flows(def, flow, load_2 * kBar, load_3 * kBar);
        EXPECT_NEAR(rig.flow(2), Q_2, 2e-3 * kFlow) << share << " " << flow << " " << load_2;
        EXPECT_NEAR(rig.flow(3), Q_3, 2e-3 * kFlow) << share << " " << flow << " " << load_2;
        // d_2 - d_3 = 2 d e/(share (1 - share)) of an error e, at most regulation_pressure; d the metering drop
        const double accuracy = 1.1 * 0.5 * share * (1 - share) * 0.5 / 5 * std::pow(kFlow / flow, 2);
        EXPECT_NEAR(rig.flow(2), share * flow, accuracy * std::fabs(flow)) << share << " " << flow << " " << load_2;
      }
    }
  }
}

TEST(ValidationFlowDivider, of_a_blocked_branch_gives_no_more_than_the_least_opening_to_the_other_one) {
  SpoolRig rig(0, 0, 0);
  rig.divider().nominal_flow = kFlow;
  rig.def.volumes[2].fixed = false, rig.def.volumes[2].rigid_volume = 1e-5;  // Load_3, closed
  rig.def.volumes[0].initial_pressure = 1 * kBar;
  FlowSourceDef& source = dynamic_cast<FlowSourceDef&>(*rig.def.components.front());
  source.flow = 0.1 * kFlow;
  rig.run(3);
  EXPECT_NEAR(rig.flow(2), 0.1 * kFlow, 1e-3 * kFlow);
  EXPECT_NEAR(rig.flow(3), 0, 1e-4 * kFlow);
  EXPECT_NEAR(rig.variable("Load_3.pressure"), rig.variable("Common.pressure"), 100);
}

TEST(ValidationGearFlowDivider, divides_by_its_displacements_and_makes_pressure_of_the_branch_without_load) {
  for (const auto& [load_2, load_3] : {std::pair{100.0, 100.0}, {200.0, 0.0}, {0.0, 120.0}}) {
    GearRig rig(kFlow, load_2 * kBar, load_3 * kBar);
    GearFlowDividerDef& def = rig.divider();
    def.displacement_2 = 2e-6, def.displacement_3 = 1e-6, def.friction_pressure = 0;
    def.leak_flow = 1 * kLitrePerMinute, def.leak_pressure = 100 * kBar;  // damps it
    rig.run(10);
    // sum of D_i (p_1 - p_i) = 0: the common pressure is the mean of the loads by displacement
    const double common = (2 * load_2 + load_3) / 3 * kBar, G = 0.01 * kLitrePerMinute / kBar;
    EXPECT_NEAR(rig.variable("Common.pressure") - 1 * kBar, common, 1e-4 * 200 * kBar) << load_2;
    const double leak_2 = G * (common - load_2 * kBar), leak_3 = G * (common - load_3 * kBar);
    const double w = (kFlow - leak_2 - leak_3) / 3e-6;
    EXPECT_NEAR(rig.variable("Divider.speed"), w, 1e-4 * w);
    EXPECT_NEAR(rig.flow(2), 2e-6 * w + leak_2, 1e-4 * kFlow);
    EXPECT_NEAR(rig.flow(3), 1e-6 * w + leak_3, 1e-4 * kFlow);
  }
}

TEST(ValidationGearFlowDivider, with_friction_and_leak_keeps_the_balance_of_both) {
  GearRig rig(kFlow, 150 * kBar, 50 * kBar);
  GearFlowDividerDef& def = rig.divider();
  def.displacement_2 = def.displacement_3 = 1.5e-6, def.friction_pressure = 4 * kBar, def.friction_speed = 1e-3;
  def.leak_flow = 1 * kLitrePerMinute, def.leak_pressure = 100 * kBar;
  rig.run(10);
  // (p_1 - p_2) + (p_1 - p_3) = 2 x 4 bar; the leaks go with their drops
  EXPECT_NEAR(rig.variable("Common.pressure") - 1 * kBar, 104 * kBar, 0.01 * kBar);
  const double G = 0.01 * kLitrePerMinute / kBar, drop_2 = -46 * kBar, drop_3 = 54 * kBar;
  const double turned = 0.5 * (kFlow - G * (drop_2 + drop_3));
  EXPECT_NEAR(rig.flow(2), turned + G * drop_2, 1e-4 * kFlow);
  EXPECT_NEAR(rig.flow(3), turned + G * drop_3, 1e-4 * kFlow);
}

TEST(ValidationFlowDivider, of_one_volume_at_two_ports_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A"), add_tank(def, "B");
  FlowDividerDef& spool = add<FlowDividerDef>(def, "Spool");
  spool.port_1 = "A", spool.port_2 = "B", spool.port_3 = "B", spool.nominal_flow = 1e-3;
  GearFlowDividerDef& gears = add<GearFlowDividerDef>(def, "Gears");
  gears.port_1 = "A", gears.port_2 = "A", gears.port_3 = "B", gears.displacement_2 = gears.displacement_3 = 1e-6;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].path, "Spool.port_3");
  EXPECT_EQ(errors[1].path, "Gears.port_2");
}

}  // namespace flow_divider_test
}  // namespace slew::hydraulics::test
