// SPDX-License-Identifier: Apache-2.0
// A circuit that holds one of every component type that the truck crane does not use, for tests.
#pragma once

#include "hydraulics/components/accumulator.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/compensated_orifice.h"
#include "hydraulics/components/cooler.h"
#include "hydraulics/components/counterbalance_valve.h"
#include "hydraulics/components/direct_relief_valve.h"
#include "hydraulics/components/double_rod_cylinder.h"
#include "hydraulics/components/engine.h"
#include "hydraulics/components/filter.h"
#include "hydraulics/components/flow_divider.h"
#include "hydraulics/components/flushing_valve.h"
#include "hydraulics/components/four_way_valve.h"
#include "hydraulics/components/heat_loss.h"
#include "hydraulics/components/hose_burst_valve.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "hydraulics/components/line.h"
#include "hydraulics/components/post_compensator.h"
#include "hydraulics/components/priority_valve.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/reducing_valve.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/shuttle_valve.h"
#include "hydraulics/components/single_acting_cylinder.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/components/spool_valve.h"
#include "hydraulics/components/telescopic_cylinder.h"
#include "hydraulics/components/unloading_valve.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {

// Check valves of every type between the bench's volumes.
inline void add_check_valves(HydraulicsDef& circuit) {
  CheckValveDef& check = add<CheckValveDef>(circuit, "Check");
  check.port_1 = "Vol_T", check.port_2 = "Vol_A", check.common.nominal_flow = 1e-3;
  ThrottleCheckValveDef& throttle = add<ThrottleCheckValveDef>(circuit, "Throttle_Check");
  throttle.port_1 = "Vol_P", throttle.port_2 = "Vol_B", throttle.common.nominal_flow = 1e-3;
  throttle.throttle_flow = 2e-4, throttle.throttle_opening = 0.7;
  PilotCheckValveDef& piloted = add<PilotCheckValveDef>(circuit, "Pilot_Check");
  piloted.port_1 = "Vol_A", piloted.port_2 = "Vol_C", piloted.port_3 = "Vol_P", piloted.port_4 = "Vol_T";
  piloted.pilot_ratio = 3, piloted.common.nominal_flow = 5e-4;
  DoublePilotCheckValveDef& lock = add<DoublePilotCheckValveDef>(circuit, "Lock");
  lock.port_a1 = "Vol_A", lock.port_a2 = "Vol_C", lock.port_b1 = "Vol_B", lock.port_b2 = "Vol_D";
  lock.common.nominal_flow = 5e-4;
}

// Counterbalance valves with the spring's chamber at port 1 and vented, and a hose-burst valve.
inline void add_counterbalance_valves(HydraulicsDef& circuit) {
  CounterbalanceValveDef& valve = add<CounterbalanceValveDef>(circuit, "Counterbalance");
  valve.port_1 = "Vol_A", valve.port_2 = "Vol_C", valve.port_3 = "Vol_B";
  valve.setting_pressure = 180 * kBar, valve.nominal_flow = 1e-3, valve.check.nominal_flow = 1e-3;
  CounterbalanceValveDef& vented = add<CounterbalanceValveDef>(circuit, "Counterbalance_Vented");
  vented.port_1 = "Vol_B", vented.port_2 = "Vol_D", vented.port_3 = "Vol_A", vented.port_4 = "Vol_T";
  vented.setting_pressure = 250 * kBar, vented.nominal_flow = 5e-4, vented.check.nominal_flow = 5e-4;
  HoseBurstValveDef& fuse = add<HoseBurstValveDef>(circuit, "Fuse");
  fuse.port_1 = "Vol_B", fuse.port_2 = "Vol_C", fuse.nominal_flow = 1e-3, fuse.closing_flow = 8e-4;
  fuse.leak_flow = kLeak;
}

// A bladder with polytropic gas, a piston with friction and heat exchange.
inline void add_accumulators(HydraulicsDef& circuit) {
  AccumulatorDef& bladder = add<AccumulatorDef>(circuit, "Bladder");
  bladder.port_1 = "Vol_P", bladder.gas_volume = 1e-3, bladder.precharge_pressure = 100 * kBar;
  bladder.nominal_flow = 2e-3;
  AccumulatorDef& piston = add<AccumulatorDef>(circuit, "Piston");
  piston.port_1 = "Vol_C", piston.gas_volume = 4e-3, piston.precharge_pressure = 60 * kBar;
  piston.nominal_flow = 1e-3, piston.friction_pressure = 1 * kBar, piston.thermal_time_constant = 20;
}

// A closed-centre valve with four edges, one by a curve and one blocked; an open-centre one behind it in the bypass.
inline void add_spool_valves(HydraulicsDef& circuit) {
  SpoolValveDef& closed = add<SpoolValveDef>(circuit, "Closed_Centre");
  closed.port_p = "Vol_P", closed.port_a = "Vol_C", closed.port_b = "Vol_D", closed.port_t = "Vol_T";
  closed.maximum_control_signal = 1000, closed.leak_flow = kLeak;
  closed.pa.curve = "Edge", closed.pa.area = 4e-6, closed.bt.area = 8e-6, closed.bt.overlap = 0.05;
  closed.pb.area = 3e-6, closed.pb.overlap = 0.1;
  SpoolValveDef& open = add<SpoolValveDef>(circuit, "Open_Centre");
  open.port_p = "Vol_P", open.port_a = "Vol_A", open.port_b = "Vol_B", open.port_t = "Vol_T", open.port_d = "Vol_C";
  open.pa.area = open.pb.area = 5e-6, open.pa.overlap = open.pb.overlap = 0.3;
  open.at.area = open.bt.area = 6e-6, open.at.overlap = open.bt.overlap = -0.2;
  open.bypass_area = 2e-5, open.bypass_closing = 0.2, open.bypass_closed = 0.6;
  circuit.curves.push_back({.name = "Edge", .points = {{-1, 0}, {0.1, 0}, {0.4, 0.2}, {1, 1.5}}});
}

// A motor with a case drain, one without, two of variable displacement with brakes, a single-acting and a telescopic
// cylinder.
inline void add_actuators(HydraulicsDef& circuit) {
  HydraulicMotorDef& motor = add<HydraulicMotorDef>(circuit, "Motor");
  motor.force = "Ring", motor.port_a = "Vol_C", motor.port_b = "Vol_D", motor.port_c = "Vol_T";
  motor.displacement = 10e-6, motor.gear_ratio = 50, motor.leak_flow = kLeak, motor.case_leak_flow = 2 * kLeak;
  HydraulicMotorDef& fan = add<HydraulicMotorDef>(circuit, "Fan");
  fan.force = "Fan_Axle", fan.port_a = "Vol_A", fan.port_b = "Vol_T", fan.displacement = 2e-6;
  for (const char* port_c : {"", "Vol_A"}) {
    HydraulicMotorDef& winch = add<HydraulicMotorDef>(circuit, *port_c == 0 ? "Winch" : "Drained_Winch");
    winch.force = winch.name + "_Axle", winch.port_a = "Vol_C", winch.port_b = "Vol_D", winch.port_c = port_c;
    winch.displacement = 8e-6, winch.is_variable = true, winch.setting = 0.7, winch.setting_rate_limit = 2;
    winch.brake_port = "Vol_B", winch.brake.torque = 300, winch.brake.release_pressure = 400 * kBar;
  }
  SingleActingCylinderDef& plunger = add<SingleActingCylinderDef>(circuit, "Plunger");
  plunger.common.force = "Plunger_Force", plunger.common.port_a = "Vol_D", plunger.common.port_b = "Vol_T";
  plunger.common.piston_diameter = 0.06, plunger.common.chamber_length = 0.6, plunger.common.leak_flow = kLeak;
  plunger.common.minimum_stroke = 0.05, plunger.common.maximum_stroke = 0.5;
  TelescopicCylinderDef& jack = add<TelescopicCylinderDef>(circuit, "Jack");
  jack.common.force = "Jack_Force", jack.common.port_a = "Vol_C", jack.common.port_b = "Vol_T";
  jack.stages = {{0.3, 0.08}, {0.6, 0.06}}, jack.stage_transition = 0.1, jack.common.leak_flow = kLeak;
  jack.common.minimum_stroke = 0.05, jack.common.maximum_stroke = 0.6;
}

// A flow and a pressure source, pumps with both limits, one of them under a control pressure.
inline void add_sources(HydraulicsDef& circuit) {
  PumpDef& pump = add<PumpDef>(circuit, "Limited_Pump");
  pump.port_a = "Vol_C", pump.port_b = "Vol_T", pump.speed = 157, pump.displacement = 8e-6, pump.leak_flow = kLeak;
  pump.swash = 0.8, pump.swash_rate_limit = 3, pump.maximum_pressure = 190 * kBar, pump.maximum_power = 10e3;
  PumpDef& over_centre = add<PumpDef>(circuit, "Over_Centre");
  over_centre.port_a = "Vol_C", over_centre.port_b = "Vol_D", over_centre.port_c = "Vol_T", over_centre.speed = 157;
  over_centre.displacement = 8e-6, over_centre.case_leak_flow = kLeak, over_centre.mechanical_coefficient = 0.9;
  over_centre.volumetric_coefficient = 0.9;
  over_centre.minimum_swash = -1, over_centre.swash = -0.7, over_centre.swash_per_signal = 1e-3;
  over_centre.maximum_pressure = 190 * kBar, over_centre.maximum_power = 10e3;
  PumpDef& controlled = add<PumpDef>(circuit, "Controlled_Pump");
  controlled.port_a = "Vol_C", controlled.port_b = "Vol_T", controlled.speed = 157, controlled.displacement = 8e-6;
  controlled.control_port = "Vol_A", controlled.full_swash_pressure = 10 * kBar, controlled.maximum_power = 10e3;
  controlled.zero_swash_pressure = 250 * kBar, controlled.maximum_pressure = 190 * kBar;
  FlowSourceDef& flow = add<FlowSourceDef>(circuit, "Flow_Source");
  flow.port_1 = "Vol_T", flow.port_2 = "Vol_P", flow.flow = 1e-4, flow.flow_per_signal = 1e-7;
  PressureSourceDef& pressure = add<PressureSourceDef>(circuit, "Pressure_Source");
  pressure.port_1 = "Vol_D", pressure.set_pressure = 50 * kBar, pressure.pressure_per_signal = 1e3;
  pressure.nominal_flow = 1e-4;
}

// An engine with a pump of either kind, filters with and without a bypass, a cooler and a wall.
inline void add_engine_and_filters(HydraulicsDef& circuit) {
  circuit.curves.push_back({.name = "Full_Load", .points = {{80, 200}, {150, 400}, {220, 300}}});
  PumpDef& pump = add<PumpDef>(circuit, "Engine_Pump");
  pump.port_a = "Vol_D", pump.port_b = "Vol_T", pump.displacement = 8e-6, pump.mechanical_coefficient = 0.9;
  pump.drive = {"Engine", 1.5}, pump.maximum_power = 10e3, pump.leak_flow = kLeak;
  EngineDef& engine = add<EngineDef>(circuit, "Engine");
  engine.torque_curve = "Full_Load", engine.inertia = 1.2, engine.speed = 200, engine.stall_speed = 60;
  engine.friction_torque = 20, engine.viscous_friction = 0.05;
  LsPumpDef& ls_pump = add<LsPumpDef>(circuit, "Engine_Ls_Pump");
  ls_pump.port_a = "Vol_C", ls_pump.port_b = "Vol_T", ls_pump.displacement = 5e-6, ls_pump.drive = {"Engine", 0.8};
  ls_pump.standby_pressure = 150 * kBar, ls_pump.mechanical_coefficient = 0.9, ls_pump.maximum_torque = 50;
  ls_pump.volumetric_coefficient = 0.8, pump.volumetric_coefficient = 0.7;
  FilterDef& filter = add<FilterDef>(circuit, "Filter");
  filter.port_1 = "Vol_A", filter.port_2 = "Vol_C", filter.nominal_flow = 1e-4, filter.clogging = 0.5;
  filter.nominal_pressure_drop = 5 * kBar, filter.bypass.nominal_flow = 5e-4;
  FilterDef& plain = add<FilterDef>(circuit, "Plain_Filter");
  plain.port_1 = "Vol_C", plain.port_2 = "Vol_T", plain.nominal_flow = 1e-5;
  CoolerDef& cooler = add<CoolerDef>(circuit, "Cooler");
  cooler.port_1 = "Vol_D", cooler.port_2 = "Vol_T", cooler.nominal_flow = 2e-5, cooler.conductance = 50;
  HeatLossDef& wall = add<HeatLossDef>(circuit, "Wall");
  wall.port_1 = "Vol_B", wall.conductance = 5;
}

// A section with flow sharing, priority valves with and without load sensing, a reducing valve with a signal.
inline void add_flow_sharing(HydraulicsDef& circuit) {
  PostCompensatorDef& compensator = add<PostCompensatorDef>(circuit, "Compensator");
  compensator.port_1 = "Vol_C", compensator.port_2 = "Vol_B", compensator.port_t = "Vol_T";
  compensator.shared_ls = "Shuttle_3", compensator.nominal_flow = 1e-3, compensator.regulation_pressure = 50 * kBar;
  LsShuttleDef& shuttle = add<LsShuttleDef>(circuit, "Shuttle_3");
  shuttle.port_1 = "Compensator", shuttle.port_2 = "Metering_B";
  PriorityValveDef& priority = add<PriorityValveDef>(circuit, "Priority");
  priority.port_1 = "Vol_P", priority.port_2 = "Vol_A", priority.port_3 = "Vol_C", priority.port_t = "Vol_T";
  priority.ls_port = "Metering_A", priority.nominal_flow = 5e-4, priority.regulation_pressure = 20 * kBar;
  PriorityValveDef& fixed = add<PriorityValveDef>(circuit, "Fixed_Priority");
  fixed.port_1 = "Vol_D", fixed.port_2 = "Vol_B", fixed.port_3 = "Vol_T", fixed.port_t = "Vol_T";
  fixed.nominal_flow = 5e-4, fixed.spring_pressure = 50 * kBar, fixed.regulation_pressure = 60 * kBar;
  ReducingValveDef& reducing = add<ReducingValveDef>(circuit, "Reducing");
  reducing.port_1 = "Vol_P", reducing.port_2 = "Vol_D", reducing.port_3 = "Vol_C", reducing.nominal_flow = 5e-4;
  reducing.setting_pressure = 20 * kBar, reducing.pressure_per_signal = 5e3, reducing.regulation_pressure = 40 * kBar;
}

inline HydraulicsDef bench_circuit() {
  HydraulicsDef circuit;
  circuit.oil_density = 850;
  add_volume(circuit, "Vol_P").rigid_volume = 1e-3;
  add_volume(circuit, "Vol_A").rigid_volume = 2e-3;
  add_volume(circuit, "Vol_B");
  add_tank(circuit, "Vol_T");
  add_volume(circuit, "Vol_C").rigid_volume = 1e-3;
  add_volume(circuit, "Vol_D").rigid_volume = 1e-3;

  // a soft hose, whose wall law moves between its bounds
  add_hose(circuit, "Hose_B", "Vol_B", 3, 0.02);
  static_cast<HoseDef&>(*circuit.components.back()).bulk_modulus = 6e4;

  CompensatedOrificeDef& metering = add<CompensatedOrificeDef>(circuit, "Metering_A");
  metering.port_p = "Vol_P", metering.port_a = "Vol_A", metering.port_t = "Vol_T", metering.area = 5e-6;
  CompensatedOrificeDef& second = add<CompensatedOrificeDef>(circuit, "Metering_B");
  second.port_p = "Vol_P", second.port_a = "Vol_B", second.port_t = "Vol_T", second.area = 3e-6;
  L90lsValveDef& valve = add<L90lsValveDef>(circuit, "Valve");
  valve.port_p = "Vol_P", valve.port_a = "Vol_A", valve.port_b = "Vol_B", valve.port_t = "Vol_T";

  // shuttles with and without a line behind them
  LsShuttleDef& first = add<LsShuttleDef>(circuit, "Shuttle_1");
  first.port_1 = "Metering_A", first.port_2 = "Metering_B", first.line_time_constant = 0.005;
  LsShuttleDef& last = add<LsShuttleDef>(circuit, "Shuttle_2");
  last.port_1 = "Shuttle_1", last.port_2 = "Valve";
  LsPumpDef& pump = add<LsPumpDef>(circuit, "Pump");
  pump.port_a = "Vol_P", pump.port_b = "Vol_T", pump.ls_port = "Shuttle_2";
  pump.speed = 157, pump.displacement = 10e-6, pump.leak_flow = kLeak;

  DirectReliefValveDef& relief = add<DirectReliefValveDef>(circuit, "Relief_A");
  relief.port_1 = "Vol_A", relief.port_2 = "Vol_T", relief.seat_diameter = 0.01, relief.crack_pressure = 200 * kBar;
  relief.spring_constant = 4e4, relief.flow_force = FlowForce::included;
  DirectReliefValveDef& plain = add<DirectReliefValveDef>(circuit, "Relief_B");
  plain.port_1 = "Vol_B", plain.port_2 = "Vol_T", plain.seat_diameter = 0.01, plain.crack_pressure = 100 * kBar;
  plain.spring_constant = 4e4, plain.maximum_lift = 2e-4;

  ReliefValveDef& proportional = add<ReliefValveDef>(circuit, "Relief_C");
  proportional.port_1 = "Vol_A", proportional.port_2 = "Vol_T", proportional.nominal_flow = 1e-3;
  proportional.setting_pressure = 260 * kBar, proportional.is_proportional = true;
  proportional.solenoid.minimum_pressure = 20 * kBar;
  DirectReliefValveDef& solenoid = add<DirectReliefValveDef>(circuit, "Relief_D");
  solenoid.port_1 = "Vol_B", solenoid.port_2 = "Vol_T", solenoid.seat_diameter = 0.01;
  solenoid.crack_pressure = 300 * kBar, solenoid.spring_constant = 4e4, solenoid.is_proportional = true;

  OrificeDef& orifice = add<OrificeDef>(circuit, "Orifice");
  orifice.port_1 = "Vol_A", orifice.port_2 = "Vol_B", orifice.diameter = 1e-3;
  LaminarRestrictionDef& capillary = add<LaminarRestrictionDef>(circuit, "Capillary");
  capillary.port_1 = "Vol_B", capillary.port_2 = "Vol_T", capillary.diameter = 1e-3, capillary.length = 0.5;

  DoubleRodCylinderDef& cylinder = add<DoubleRodCylinderDef>(circuit, "Cylinder");
  cylinder.common.force = "Force", cylinder.common.port_a = "Vol_A", cylinder.common.port_b = "Vol_B";
  cylinder.common.piston_diameter = 0.1, cylinder.rod_diameter = 0.05, cylinder.common.chamber_length = 1;
  cylinder.common.minimum_stroke = 0.1, cylinder.common.maximum_stroke = 0.9, cylinder.common.leak_flow = kLeak;
  FourWayValveDef& bridge = add<FourWayValveDef>(circuit, "Bridge");
  bridge.port_p = "Vol_P", bridge.port_a = "Vol_A", bridge.port_b = "Vol_B", bridge.port_t = "Vol_T";
  bridge.edge_area = 1e-5, bridge.neutral_opening = 0.4, bridge.opening_gain = 1e-3;
  add_check_valves(circuit);
  add_counterbalance_valves(circuit);
  add_accumulators(circuit);
  add_spool_valves(circuit);
  add_actuators(circuit);
  add_sources(circuit);
  add_engine_and_filters(circuit);
  add_flow_sharing(circuit);
  return circuit;
}

// Dividers of both types, a shuttle, an unloading valve, lines of laminar and of turbulent flow: a circuit of its own,
// since a line has many states. Its oil is warm.
inline HydraulicsDef divider_circuit() {
  HydraulicsDef circuit;
  circuit.oil_temperature = OilTemperature::by_volume, circuit.hot_viscosity = 6.8e-6;
  circuit.start_temperature = 350;
  for (const char* name : {"Vol_P", "Vol_A", "Vol_B", "Vol_C"}) add_volume(circuit, name).rigid_volume = 1e-3;
  add_tank(circuit, "Vol_T");
  FlowDividerDef& spool = add<FlowDividerDef>(circuit, "Divider");
  spool.port_1 = "Vol_P", spool.port_2 = "Vol_A", spool.port_3 = "Vol_C", spool.nominal_flow = 5e-4;
  spool.share = 0.4, spool.regulation_pressure = 50 * kBar, spool.metering_pressure_drop = 100 * kBar;
  GearFlowDividerDef& gears = add<GearFlowDividerDef>(circuit, "Gear_Divider");
  gears.port_1 = "Vol_P", gears.port_2 = "Vol_B", gears.port_3 = "Vol_T";
  gears.displacement_2 = 1e-6, gears.displacement_3 = 2e-6, gears.leak_flow = kLeak;
  FlushingValveDef& flushing = add<FlushingValveDef>(circuit, "Flushing_Valve");
  flushing.port_1 = "Vol_A", flushing.port_2 = "Vol_C", flushing.port_3 = "Vol_T", flushing.nominal_flow = 2e-4;
  flushing.switching_pressure = 50 * kBar, flushing.opening_pressure_rise = 200 * kBar;
  ShuttleValveDef& shuttle = add<ShuttleValveDef>(circuit, "Shuttle_Valve");
  shuttle.port_1 = "Vol_A", shuttle.port_2 = "Vol_B", shuttle.port_3 = "Vol_C", shuttle.nominal_flow = 5e-4;
  shuttle.switching_pressure = 5 * kBar;
  UnloadingValveDef& unloading = add<UnloadingValveDef>(circuit, "Unloading");
  unloading.port_1 = "Vol_P", unloading.port_2 = "Vol_T", unloading.port_3 = "Vol_C", unloading.nominal_flow = 1e-3;
  unloading.cut_out_pressure = 180 * kBar, unloading.cut_in_pressure = 150 * kBar;
  unloading.opening_pressure_rise = 50 * kBar;
  LineDef& line = add<LineDef>(circuit, "Line");
  line.port_1 = "Vol_A", line.port_2 = "Vol_C", line.length = 4, line.diameter = 0.008, line.modes = 2;
  line.loss_1 = 0.5, line.loss_2 = 1, line.bulk_modulus = 8e8;
  LineDef& wide = add<LineDef>(circuit, "Wide_Line");
  wide.port_1 = "Vol_B", wide.port_2 = "Vol_T", wide.length = 2, wide.diameter = 0.2, wide.modes = 1;
  return circuit;
}

}  // namespace slew::hydraulics::test
