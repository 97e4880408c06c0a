// SPDX-License-Identifier: Apache-2.0
// Oil temperatures against closed forms, against a balance of energy, and against an independent model that SUNDIALS
// integrates with the temperatures as states.
#include <cvode/cvode.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/cooler.h"
#include "hydraulics/components/heat_loss.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/components/spool_valve.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace oil_temperature_validation {

constexpr double kRho = 870, kC = 1900, kStart = 313.15;  // kg/m3, J/(kg K), K

HydraulicsDef warm_circuit() {
  HydraulicsDef def;
  def.oil_temperature = OilTemperature::by_volume;
  def.hot_viscosity = 6.8e-6;
  return def;
}

class Rig {
 public:
  explicit Rig(const HydraulicsDef& def) : circuit_(def), integrator_(circuit_, def) {
    integrator_.start(std::vector<double>(ports(), 0.0), std::vector<double>(ports(), 0.0),
                      std::vector<double>(ports(), 0.0));
  }
  [[nodiscard]] std::size_t ports() const { return static_cast<std::size_t>(circuit_.actuator_count()); }
  [[nodiscard]] Circuit& circuit() { return circuit_; }
  [[nodiscard]] CircuitIntegrator& integrator() { return integrator_; }
  void step(double H) { ASSERT_FALSE(integrator_.step(H, HeldSpeed(ports())).has_failed()); }
  [[nodiscard]] double operator[](const std::string& name) {
    std::vector<double> values(circuit_.variables().size());
    circuit_.read_variables(integrator_.state().data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit_.variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }

 private:
  Circuit circuit_;
  CircuitIntegrator integrator_;
};

PumpDef& add_pump(HydraulicsDef& def, const std::string& outlet, const std::string& inlet, double Q) {
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = outlet, pump.port_b = inlet, pump.displacement = 10e-6, pump.speed = Q / 10e-6;
  pump.mechanical_coefficient = pump.volumetric_coefficient = 1;
  return pump;
}

// One pass over an orifice: the oil behind it is warmer by dp/(rho c), 6 K per 100 bar. With a pump of the
// efficiencies eta, its oil is warmer by dp (1/eta - 1)/(rho c). Tolerance 1e-6: the flow is steady.
TEST(ValidationOilTemperature, a_pass_over_an_orifice_heats_the_oil_by_the_drop) {
  for (const double efficiency : {1.0, 0.9}) {
    HydraulicsDef def = warm_circuit();
    add_volume(def, "P", 150e5).rigid_volume = 1e-4;
    add_volume(def, "R", 1e5).rigid_volume = 1e-4;
    add_tank(def, "T", 1e5);
    PumpDef& pump = add_pump(def, "P", "T", 5e-4);
    pump.mechanical_coefficient = 0.95, pump.volumetric_coefficient = efficiency / 0.95;
    if (efficiency == 1) pump.mechanical_coefficient = pump.volumetric_coefficient = 1;
    OrificeDef& orifice = add<OrificeDef>(def, "Orifice");
    orifice.port_1 = "P", orifice.port_2 = "R", orifice.diameter = 2e-3;
    BleedDef& back = add<BleedDef>(def, "Return");
    back.port_1 = "R", back.port_2 = "T", back.nominal_flow = 1e-3, back.nominal_pressure_drop = 1e5;
    Rig run(def);
    for (int k = 0; k < 4000; ++k) run.step(1e-3);
    const double p_P = run["P.pressure"], p_R = run["R.pressure"], p_T = 1e5;
    ASSERT_GT(p_P, 100e5);
    const double T_P = kStart + (p_P - p_T) * (1 / efficiency - 1) / (kRho * kC);
    EXPECT_NEAR(run["P.temperature"], T_P, 1e-6 * kStart) << efficiency;
    EXPECT_NEAR(run["R.temperature"], T_P + (p_P - p_R) / (kRho * kC), 1e-6 * kStart) << efficiency;
    EXPECT_EQ(run["T.temperature"], kStart);
    EXPECT_NEAR(run["R.heat"], (p_P - p_R) * run["Orifice.flow"], 1e-6 * run["R.heat"]);
  }
}

// Oil that leaks from a pump's outlet to its case is warmer there by the drop between them; that of the outlet is not.
TEST(ValidationOilTemperature, the_oil_of_a_case_drain_has_the_heat_of_the_leak) {
  HydraulicsDef def = warm_circuit();
  add_volume(def, "P", 150e5).rigid_volume = 1e-4;
  add_volume(def, "C", 1e5).rigid_volume = 1e-5;
  add_tank(def, "T", 1e5);
  PumpDef& pump = add_pump(def, "P", "T", 5e-4);
  pump.port_c = "C", pump.case_leak_flow = 2e-5;
  OrificeDef& orifice = add<OrificeDef>(def, "Orifice");
  orifice.port_1 = "P", orifice.port_2 = "T", orifice.diameter = 2e-3;
  BleedDef& drain = add<BleedDef>(def, "Drain");
  drain.port_1 = "C", drain.port_2 = "T", drain.nominal_flow = 1e-3, drain.nominal_pressure_drop = 1e5;
  Rig run(def);
  for (int k = 0; k < 6000; ++k) run.step(1e-3);
  const double p_P = run["P.pressure"], p_C = run["C.pressure"];
  EXPECT_NEAR(run["P.temperature"], kStart, 1e-6 * kStart);
  EXPECT_GT(p_P - p_C, 50e5);
  EXPECT_NEAR(run["C.temperature"], kStart + (p_P - p_C) / (kRho * kC), 1e-5 * kStart);
}

// A closed loop of a pump, a relief that keeps the power, and a tank of 10 l with heat loss: T goes to T_s + P/G with
// tau = rho c V/G. Tolerance 0.2 % of the rise: the oil outside of the tank follows it, and H/tau.
TEST(ValidationOilTemperature, a_closed_loop_heats_up_exponentially) {
  constexpr double V = 10e-3, V_P = 1e-4, G = 100, T_s = 293.15, Q = 5e-4, dp = 100e5;
  HydraulicsDef def = warm_circuit();
  add_volume(def, "P", 101e5).rigid_volume = V_P;
  add_tank(def, "T", 1e5).rigid_volume = V;
  add_pump(def, "P", "T", Q);
  ReliefValveDef& relief = add<ReliefValveDef>(def, "Relief");
  relief.port_1 = "P", relief.port_2 = "T", relief.nominal_flow = 1, relief.setting_pressure = dp;
  HeatLossDef& wall = add<HeatLossDef>(def, "Wall");
  wall.port_1 = "T", wall.conductance = G, wall.surroundings_temperature = T_s;
  Rig run(def);
  const double tau = kRho * kC * (V + V_P) / G;
  double T = kStart, longest = 0;
  for (int k = 1; k <= 60; ++k) {
    for (int i = 0; i < 100; ++i) run.step(20e-3);
    const double P = (run["P.pressure"] - 1e5) * Q, end = T_s + P / G;
    T = end + (kStart - end) * std::exp(-k * 2.0 / tau);
    longest = std::max(longest, std::fabs(run["T.temperature"] - T));
  }
  EXPECT_GT(T - kStart, 10);
  EXPECT_LT(longest, 2e-3 * (T - kStart));
  EXPECT_NEAR(run["Wall.heat"], G * (run["T.temperature"] - T_s), 1e-9);
}

// A cooler with NTU = G/(rho c Q): outlet temperature in closed form, also with the flow turned round.
TEST(ValidationOilTemperature, a_cooler_takes_the_heat_of_its_effectiveness) {
  for (const double Q : {5e-4, -5e-4, 2e-5}) {
    HydraulicsDef def = warm_circuit();
    def.start_temperature = 343.15;
    add_tank(def, "A", 1e5), add_tank(def, "B", 1e5);
    add_volume(def, "In", 1e5).rigid_volume = 2e-5, add_volume(def, "Out", 1e5).rigid_volume = 2e-5;
    FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
    source.port_1 = "A", source.port_2 = "In", source.flow = Q;
    CoolerDef& cooler = add<CoolerDef>(def, "Cooler");
    cooler.port_1 = "In", cooler.port_2 = "Out", cooler.nominal_flow = 1e-2, cooler.conductance = 400;
    cooler.coolant_temperature = 298.15;
    LaminarRestrictionDef& back = add<LaminarRestrictionDef>(def, "Back");
    back.port_1 = "Out", back.port_2 = "B", back.diameter = 0.02, back.length = 0.01;
    Rig run(def);
    for (int k = 0; k < 40000; ++k) run.step(1e-3);
    const double flow = std::fabs(run["Cooler.flow"]);
    EXPECT_NEAR(flow, std::fabs(Q), 1e-9);
    const double expected = 298.15 + (343.15 - 298.15) * std::exp(-400 / (kRho * kC * flow));
    EXPECT_NEAR(run[Q > 0 ? "Out.temperature" : "In.temperature"], expected, 1e-3) << Q;
    EXPECT_NEAR(run["Cooler.outlet_temperature"], expected, 1e-3) << Q;
    EXPECT_NEAR(run["Cooler.heat"], kRho * kC * flow * (343.15 - expected), 1) << Q;
  }
}

// A pump drives a motor through a spool valve that opens and closes; tank, heat loss. Over the run
//   work of the pump's shaft = work of the motor's shaft + heat lost + rho c sum V_i dT_i + energy of compression,
// the sums by the trapezoidal rule over the communication steps. The content of every volume is constant. Tolerance
// 0.2 % of the work: H dT/dt of the oil between two volumes, and the compressed oil that arrives and leaves with
// different temperatures.
TEST(ValidationOilTemperature, energy_is_balanced_over_a_run) {
  HydraulicsDef def = warm_circuit();
  add_volume(def, "P", 20e5).rigid_volume = 1e-3;
  add_volume(def, "A", 10e5).rigid_volume = 5e-4;
  add_volume(def, "B", 10e5).rigid_volume = 5e-4;
  add_volume(def, "R", 1e5).rigid_volume = 1e-3;
  add_tank(def, "T", 1e5).rigid_volume = 10e-3;
  PumpDef& pump = add_pump(def, "P", "T", 5e-4);
  pump.mechanical_coefficient = 0.9, pump.volumetric_coefficient = 0.95, pump.leak_flow = 1e-5;
  ReliefValveDef& relief = add<ReliefValveDef>(def, "Relief");
  relief.port_1 = "P", relief.port_2 = "R", relief.nominal_flow = 1e-3, relief.setting_pressure = 150e5;
  SpoolValveDef& valve = add<SpoolValveDef>(def, "Valve");
  valve.port_p = "P", valve.port_a = "A", valve.port_b = "B", valve.port_t = "R", valve.leak_flow = 1e-6;
  valve.pa.area = valve.pb.area = valve.at.area = valve.bt.area = 1e-5, valve.maximum_control_signal = 1;
  HydraulicMotorDef& motor = add<HydraulicMotorDef>(def, "Motor");
  motor.force = "Axle", motor.port_a = "A", motor.port_b = "B", motor.port_c = "T", motor.displacement = 5e-6;
  motor.leak_flow = motor.case_leak_flow = 1e-5, motor.dead_volume = 1e-5;
  BleedDef& back = add<BleedDef>(def, "Return");
  back.port_1 = "R", back.port_2 = "T", back.nominal_flow = 1e-3, back.nominal_pressure_drop = 2e5;
  HeatLossDef& wall = add<HeatLossDef>(def, "Wall");
  wall.port_1 = "T", wall.conductance = 50;
  Rig run(def);
  // turned by the outside at 60 rad/s
  run.integrator().mutable_state()[static_cast<std::size_t>(run.circuit().speed(0))] = 60;
  run.integrator().refresh();
  const std::array<const char*, 5> volumes{"P", "A", "B", "R", "T"};
  const auto stored = [&] {
    double E = 0;
    for (const char* name : volumes) {
      const std::string volume(name);
      E += kRho * kC * run[volume + ".content"] * run[volume + ".temperature"];
    }
    return E;
  };
  const auto power = [&] { return run["Pump.power"] - run["Motor.pressure_torque"] * run["Motor.speed"]; };
  constexpr double H = 1e-3;
  const double E_0 = stored();
  const int valve_control = run.circuit().find_control("Valve");
  double work = 0, size = 0, lost = 0, before = power();
  for (int k = 0; k < 20000; ++k) {
    run.circuit().set_control(valve_control, k % 4000 < 2000 ? 0.8 : 0.4);
    run.step(H);
    const double now = power();
    work += 0.5 * H * (before + now), size += H * run["Pump.power"], lost += H * run["Wall.heat"];
    before = now;
  }
  const double warmed = stored() - E_0;
  EXPECT_GT(warmed, 0.2 * size);
  EXPECT_GT(run["T.temperature"], kStart + 1);
  EXPECT_NEAR(work, warmed + lost, 2e-3 * size);
}

// ---- an independent model -------------------------------------------------------------------------------------

// A pump of constant flow into a volume P with a capillary and an orifice to a tank with heat loss, written down from
// the textbook: states p, T_P, T_T.
struct Textbook {
  double Q = 3e-4, V_P = 5e-4, V_T = 5e-3, G = 100, T_s = 283.15;
  double d_o = 1.2e-3, C_d = 0.67, d_c = 2e-3, L_c = 2;
  double eta = 0.85;  // of the pump, mechanical

  static double viscosity(double T) {
    const auto W = [](double nu) { return std::log(std::log10(nu * 1e6 + 0.7)); };
    const double t = std::log(T / 313.15) / std::log(373.15 / 313.15);
    return (std::pow(10, std::exp(W(46e-6) + t * (W(6.8e-6) - W(46e-6)))) - 0.7) * 1e-6;
  }
  static double density(double T) { return 870 * (1 - 7e-4 * (T - 313.15)); }
  static double modulus(double T) { return 1.5e9 * (1 - 4e-3 * (T - 313.15)); }

  void rates(const double* y, double* f) const {
    const double p = y[0], T_P = y[1], T_T = y[2], dp = p - 1e5;
    const double area = std::numbers::pi / 4 * d_o * d_o;
    const double Q_o = C_d * area * std::sqrt(2 * dp / density(T_P));
    const double Q_c = std::numbers::pi * std::pow(d_c, 4) * dp / (128 * density(T_P) * viscosity(T_P) * L_c);
    const double rc = kRho * kC;
    f[0] = modulus(T_P) / V_P * (Q - Q_o - Q_c);
    f[1] = (Q * (T_T - T_P) + Q * dp * (1 / eta - 1) / rc) / V_P;
    f[2] = ((Q_o + Q_c) * (T_P - T_T) + (Q_o + Q_c) * dp / rc - G / rc * (T_T - T_s)) / V_T;
  }
};

int textbook_rates(realtype, N_Vector y, N_Vector f, void* user) {
  static_cast<const Textbook*>(user)->rates(N_VGetArrayPointer(y), N_VGetArrayPointer(f));
  return 0;
}

// y at the times k dt, k = 1..n.
std::vector<std::array<double, 3>> by_cvode(Textbook& model, std::array<double, 3> y_0, double dt, int n) {
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector y = N_VNew_Serial(3, context), tolerance = N_VNew_Serial(3, context);
  std::copy(y_0.begin(), y_0.end(), N_VGetArrayPointer(y));
  const double scales[] = {1e-3, 1e-8, 1e-8};
  std::copy(std::begin(scales), std::end(scales), N_VGetArrayPointer(tolerance));
  SUNMatrix matrix = SUNDenseMatrix(3, 3, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
  void* cvode = CVodeCreate(CV_BDF, context);
  CVodeInit(cvode, textbook_rates, 0, y);
  CVodeSVtolerances(cvode, 1e-9, tolerance);
  CVodeSetUserData(cvode, &model);
  CVodeSetLinearSolver(cvode, solver, matrix);
  CVodeSetMaxNumSteps(cvode, 1000000);
  std::vector<std::array<double, 3>> found;
  for (int k = 1; k <= n; ++k) {
    realtype t = 0;
    EXPECT_GE(CVode(cvode, k * dt, y, &t, CV_NORMAL), 0);
    const double* at = N_VGetArrayPointer(y);
    found.push_back({at[0], at[1], at[2]});
  }
  CVodeFree(&cvode);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(tolerance);
  N_VDestroy(y);
  SUNContext_Free(&context);
  return found;
}

HydraulicsDef textbook_circuit(const Textbook& model) {
  HydraulicsDef def = warm_circuit();
  def.entrained_air = 0, def.start_temperature = 283.15, def.orifice_transition = 1;
  add_volume(def, "P", 100e5).rigid_volume = model.V_P;
  add_tank(def, "T", 1e5).rigid_volume = model.V_T;
  add_pump(def, "P", "T", model.Q).mechanical_coefficient = model.eta;
  def.start = StartState::table13;
  OrificeDef& orifice = add<OrificeDef>(def, "Orifice");
  orifice.port_1 = "P", orifice.port_2 = "T", orifice.diameter = model.d_o;
  LaminarRestrictionDef& capillary = add<LaminarRestrictionDef>(def, "Capillary");
  capillary.port_1 = "P", capillary.port_2 = "T", capillary.diameter = model.d_c, capillary.length = model.L_c;
  HeatLossDef& wall = add<HeatLossDef>(def, "Wall");
  wall.port_1 = "T", wall.conductance = model.G, wall.surroundings_temperature = model.T_s;
  return def;
}

// From 10 degC cold: the oil warms by 20 K and more, the capillary's share of the flow grows. Both programs agree
// within 1e-3 of the rise of the temperatures and 1e-4 of the pressure at 1 ms, with every solver.
TEST(ValidationOilTemperature, warming_up_agrees_with_an_independent_model) {
  Textbook model;
  const std::vector<std::array<double, 3>> expected = by_cvode(model, {100e5, 283.15, 283.15}, 1, 60);
  for (const Solver solver : {Solver::rodas3, Solver::implicit_euler, Solver::rk4, Solver::cvode}) {
    HydraulicsDef def = textbook_circuit(model);
    def.solver = solver, def.relative_tolerance = 1e-6, def.max_substep = 5e-5;
    // the costly solvers for a part of the time
    const std::size_t seconds = solver == Solver::rodas3 ? 60 : 5;
    Rig run(def);
    double T_off = 0, p_off = 0;
    for (std::size_t k = 0; k < seconds; ++k) {
      for (int i = 0; i < 1000; ++i) run.step(1e-3);
      T_off = std::max(
          {T_off, std::fabs(run["P.temperature"] - expected[k][1]), std::fabs(run["T.temperature"] - expected[k][2])});
      p_off = std::max(p_off, std::fabs(run["P.pressure"] - expected[k][0]) / expected[k][0]);
    }
    const double rise = expected[seconds - 1][2] - 283.15;
    EXPECT_GT(rise, solver == Solver::rodas3 ? 20 : 1);
    EXPECT_LT(T_off, 1e-3 * std::max(rise, 5.0)) << static_cast<int>(solver);
    EXPECT_LT(p_off, 1e-4) << static_cast<int>(solver);
  }
}

// (8) of the card is of first order in H: the error at 40 ms is twice that at 20 ms.
TEST(ValidationOilTemperature, the_error_halves_with_the_step) {
  Textbook model;
  const std::vector<std::array<double, 3>> expected = by_cvode(model, {100e5, 283.15, 283.15}, 4, 1);
  const auto error = [&](double H) {
    HydraulicsDef def = textbook_circuit(model);
    def.relative_tolerance = 1e-6;
    Rig run(def);
    for (int i = 0; i < static_cast<int>(std::lround(4 / H)); ++i) run.step(H);
    return run["T.temperature"] - expected[0][2];
  };
  const double coarse = error(0.04), fine = error(0.02);
  EXPECT_NEAR(coarse / fine, 2, 0.2);
}

}  // namespace oil_temperature_validation
}  // namespace slew::hydraulics::test
