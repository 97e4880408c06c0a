// SPDX-License-Identifier: Apache-2.0
// The truck crane's hydraulic circuit as a Def, for tests: every number of its tables.
#pragma once

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/hose.h"
#include "hydraulics/components/l90ls_valve.h"
#include "hydraulics/components/ls_pump.h"
#include "hydraulics/components/ls_shuttle.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/slew_cylinder.h"
#include "hydraulics/hydraulics_def.h"
#include "hydraulics/piston_motion.h"

namespace slew::hydraulics::test {

inline constexpr double kBar = 1e5;
inline constexpr double kLitrePerMinute = 1e-3 / 60;
inline constexpr double kInch = 0.0254;
inline constexpr double kLeak = 0.1 * kLitrePerMinute;  // at 100 bar

template <typename Def>
Def& add(HydraulicsDef& circuit, const std::string& name) {
  auto def = std::make_unique<Def>();
  def->name = name;
  Def& result = *def;
  circuit.components.push_back(std::move(def));
  return result;
}

inline VolumeDef& add_volume(HydraulicsDef& circuit, const std::string& name, double pressure = 1e5) {
  circuit.volumes.push_back({.name = name, .initial_pressure = pressure});
  return circuit.volumes.back();
}

inline VolumeDef& add_tank(HydraulicsDef& circuit, const std::string& name, double pressure = 1e5) {
  circuit.volumes.push_back({.name = name, .initial_pressure = pressure, .fixed = true});
  return circuit.volumes.back();
}

inline void add_hose(HydraulicsDef& circuit, const std::string& name, const std::string& volume, double length,
                     double diameter) {
  HoseDef& hose = add<HoseDef>(circuit, name);
  hose.volume = volume;
  hose.length = length;
  hose.diameter = diameter;
}

inline L90lsValveDef& add_valve(HydraulicsDef& circuit, const std::string& axis) {
  L90lsValveDef& valve = add<L90lsValveDef>(circuit, "L90" + axis);
  const std::string cylinder = "Vol_" + axis + "Cyl_";
  valve.port_p = "Vol_MainPump", valve.port_t = "Vol_Tank";
  valve.port_a = cylinder + "A", valve.port_b = cylinder + "B";
  valve.leak_flow = kLeak;
  return valve;
}

// What all cylinders of the crane have alike, and the lengths of piston and chamber, the stroke limits [m].
inline void set_cylinder(CylinderParameters& common, const std::string& axis, double diameter, double piston,
                         double chamber, double lowest, double highest) {
  common.friction_curve = "Spline_CylinderFriction";
  common.port_a = "Vol_" + axis + "Cyl_A", common.port_b = "Vol_" + axis + "Cyl_B";
  common.seal_friction = 1e3;
  common.leak_flow = 0.1 * kLeak;
  common.piston_diameter = diameter, common.piston_length = piston, common.chamber_length = chamber;
  common.minimum_stroke = lowest, common.maximum_stroke = highest;
}

// Cylinders in the order lift, jib, slew.
inline HydraulicsDef crane_circuit() {
  HydraulicsDef circuit;
  add_volume(circuit, "Vol_MainPump");
  add_tank(circuit, "Vol_Tank");
  for (const char* axis : {"Slew", "Lift", "Jib"}) {
    for (const char* port : {"A", "B"}) {
      const std::string volume = std::string("Vol_") + axis + "Cyl_" + port;
      add_volume(circuit, volume);
      add_hose(circuit, std::string("Hose_") + axis + "_" + port, volume, 1.5, 0.75 * kInch);
    }
  }
  add_hose(circuit, "Hose_MainPump", "Vol_MainPump", 2, kInch);

  L90lsValveDef& slew = add_valve(circuit, "Slew");
  slew.nominal_flow_pa = slew.nominal_flow_at = slew.nominal_flow_pb = slew.nominal_flow_bt = 20 * kLitrePerMinute;
  add_valve(circuit, "Lift").nominal_flow_at = 30 * kLitrePerMinute;
  add_valve(circuit, "Jib").nominal_flow_at = 30 * kLitrePerMinute;

  DoubleActingCylinderDef& lift = add<DoubleActingCylinderDef>(circuit, "Cyl_Lift");
  set_cylinder(lift.common, "Lift", 0.2, 0.05, 1.12, 0.7, 1.05);
  lift.common.force = "ForceT_Lift", lift.common.dead_volume = 1e-4;
  lift.rod_diameter = 0.105, lift.rod_length = 1.137, lift.attachment_length = 0.1;
  DoubleActingCylinderDef& jib = add<DoubleActingCylinderDef>(circuit, "Cyl_Jib");
  set_cylinder(jib.common, "Jib", 0.16, 0.05, 1.02, 0.55, 0.95);
  jib.common.force = "ForceT_Jib", jib.common.dead_volume = 1e-4;
  jib.rod_diameter = 0.09, jib.rod_length = 0.9, jib.attachment_length = 0.1;
  SlewCylinderDef& rack = add<SlewCylinderDef>(circuit, "SlewCyl_CraneSlew");
  set_cylinder(rack.common, "Slew", 0.1, 0.3, 1.3, 0.02, 0.98);
  rack.common.force = "ForceR_Pillar", rack.pinion_radius = 0.144, rack.stroke_offset = 0.5;

  LsShuttleDef& inner = add<LsShuttleDef>(circuit, "LSPressure_Lift_Jib");
  inner.port_1 = "L90Lift", inner.port_2 = "L90Jib";
  LsShuttleDef& outer = add<LsShuttleDef>(circuit, "LSPressure_MainPump");
  outer.port_1 = "L90Slew", outer.port_2 = "LSPressure_Lift_Jib", outer.line_time_constant = 0.01;

  ReliefValveDef& relief = add<ReliefValveDef>(circuit, "PRV_MainPump");
  relief.port_1 = relief.port_3 = "Vol_MainPump", relief.port_2 = "Vol_Tank";
  relief.nominal_flow = 180 * kLitrePerMinute, relief.setting_pressure = 270 * kBar;

  LsPumpDef& pump = add<LsPumpDef>(circuit, "MainPump");
  pump.port_a = "Vol_MainPump", pump.port_b = "Vol_Tank", pump.ls_port = "LSPressure_MainPump";
  pump.speed = 1500 * 2 * std::numbers::pi / 60, pump.displacement = 140e-6 / (2 * std::numbers::pi);
  pump.mechanical_coefficient = 0.94, pump.volumetric_coefficient = 0.93, pump.leak_flow = kLeak;

  BleedDef& bleed = add<BleedDef>(circuit, "Bleed_MainPump");
  bleed.port_1 = "Vol_MainPump", bleed.port_2 = "Vol_Tank";
  bleed.nominal_flow = 2 * kLitrePerMinute, bleed.nominal_pressure_drop = 25 * kBar;

  circuit.curves.push_back({.name = "Spline_CylinderFriction",
                            .points = {{0, 0},
                                       {0.0001, 1},
                                       {0.025, 0.9},
                                       {0.05, 0.4},
                                       {0.075, 0.225},
                                       {0.1, 0.2},
                                       {0.125, 0.225},
                                       {0.2, 0.275},
                                       {0.3, 0.35},
                                       {0.4, 0.415},
                                       {1, 0.8},
                                       {3, 0.85}},
                            .odd = true});
  return circuit;
}

// Pistons that carry a mass each: a = (F - load - damping v) / mass.
class MassLoad final : public PistonMotion {
 public:
  struct Load {
    double mass, force, damping = 0;
  };
  explicit MassLoad(std::vector<Load> loads) : loads_(std::move(loads)) {}
  void accelerations(const double* F, const double*, const double* v, double* a) const noexcept override {
    for (std::size_t i = 0; i < loads_.size(); ++i) {
      a[i] = (F[i] - loads_[i].force - loads_[i].damping * v[i]) / loads_[i].mass;
    }
  }
  void slopes(const double*, const double*, const double*, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override {
    const std::size_t m = loads_.size();
    for (std::size_t i = 0; i < m * m; ++i) da_dF[i] = da_dx[i] = da_dv[i] = 0;
    for (std::size_t i = 0; i < m; ++i) {
      da_dF[i * m + i] = 1 / loads_[i].mass;
      da_dv[i * m + i] = -loads_[i].damping / loads_[i].mass;
    }
  }
  std::vector<Load>& loads() { return loads_; }

 private:
  std::vector<Load> loads_;
};

// About the crane at its start: lift 42 t at 251 kN, jib 12 t at 107 kN, rack with the slewing inertia.
inline MassLoad crane_load() {
  return MassLoad({{42e3, 251e3, 1e4}, {12e3, 107e3, 1e4}, {1.8e6, 0, 2e5}});
}
inline constexpr double kCraneStrokes[] = {0.832, 0.753, 0.594};
inline constexpr double kCraneForces[] = {251e3, 107e3, 0};
inline constexpr double kAtRest[] = {0, 0, 0};

}  // namespace slew::hydraulics::test
