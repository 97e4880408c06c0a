// SPDX-License-Identifier: Apache-2.0
// Cost and error of the hydraulics' solvers over the extremes of the coupling study's section 7: the truck crane's
// circuit with a mass and end stops on each piston, the lift at full command from 0.2 to 1.2 s of 2 s.
//
//   hydraulics_alone              Markdown tables: error, microseconds per simulated millisecond, worst millisecond
//   hydraulics_alone --steps N    N runs of the nominal circuit under RODAS3 and nothing else, for a profiler
//
// Error: largest over the run, sampled every millisecond, against CVODE at rtol 1e-10. Cost: thread time of whole runs,
// the least of all rounds; worst step: wall time of each step of 1 ms, for each step the least of all rounds, so that
// the machine's other work does not count.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "coupling/line_force.h"
#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace {

using namespace slew;
using namespace slew::hydraulics;

constexpr double kH = 1e-3;  // s
constexpr int kSteps = 2000;
constexpr int kRounds = 5;

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A mass on each piston, with the cylinder's end stops and a damper, no friction.
class Masses final : public PistonMotion {
 public:
  explicit Masses(const Circuit& circuit) {
    for (const Actuator& actuator : circuit.actuators()) {
      const LineForceParameters& line = actuator.line_force;
      laws_.emplace_back(coupling::LineForceDef{.friction_curve = {},
                                                .stroke_min = line.minimum_stroke,
                                                .stroke_max = line.maximum_stroke,
                                                .stop_stiffness = line.end_stiffness,
                                                .stop_damping = line.end_damping});
    }
  }
  void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept override {
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = (laws_[i].evaluate(F[i], x[i], v[i]).force - test::kCraneForces[i] - kDamping[i] * v[i]) / kMass[i];
    }
  }
  void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override {
    std::fill(da_dF, da_dF + 9, 0.0), std::fill(da_dx, da_dx + 9, 0.0), std::fill(da_dv, da_dv + 9, 0.0);
    for (std::size_t i = 0; i < 3; ++i) {
      const coupling::LineForce line = laws_[i].evaluate(F[i], x[i], v[i]);
      da_dF[4 * i] = line.d_pressure / kMass[i];
      da_dx[4 * i] = line.d_position / kMass[i];
      da_dv[4 * i] = (line.d_speed - kDamping[i]) / kMass[i];
    }
  }

 private:
  static constexpr double kMass[] = {42e3, 12e3, 1.8e6};  // kg
  static constexpr double kDamping[] = {1e4, 1e4, 2e5};   // N s/m
  std::vector<coupling::LineForceLaw> laws_;
};

struct Extreme {
  std::string name;
  void (*change)(HydraulicsDef&);
  double lift_stroke = test::kCraneStrokes[0];  // m, at the start
};

template <typename Def>
void for_each(HydraulicsDef& def, std::string_view type, void (*change)(Def&)) {
  for (auto& c : def.components) {
    if (c->type_name() == type) change(static_cast<Def&>(*c));
  }
}

void small_pump_line(HydraulicsDef& def) {
  std::erase_if(def.components, [](const auto& c) { return c->name == "Hose_MainPump"; });
  def.volumes[0].rigid_volume = 1e-6;
}

void fast_valves(HydraulicsDef& def) {
  for_each<L90lsValveDef>(def, "l90ls_valve", [](L90lsValveDef& valve) { valve.step_response = 1e-3; });
}

DoubleActingCylinderDef& lift(HydraulicsDef& def) {
  for (auto& c : def.components) {
    if (c->name == "Cyl_Lift") return static_cast<DoubleActingCylinderDef&>(*c);
  }
  std::abort();
}

constexpr double kBottom = 0.8e-3;  // m, of the lift's stroke: 25 ml under the piston instead of 26 l

const std::vector<Extreme>& extremes() {
  static const std::vector<Extreme> list = {
      {"nominal", [](HydraulicsDef&) {}},
      {"pump pipe 1e-6 m3", small_pump_line},
      {"chamber A of the lift x 1e-3",
       [](HydraulicsDef& def) {
         lift(def).common.minimum_stroke = 0.5 * kBottom;
         lift(def).common.dead_volume = 0;
         for_each<HoseDef>(def, "hose", [](HoseDef& hose) {
           if (hose.volume == "Vol_LiftCyl_A") hose.length *= 1e-3;
         });
       },
       kBottom},
      {"orifice transition 1 Pa", [](HydraulicsDef& def) { def.orifice_transition = 1; }},
      {"valves of 1 ms", fast_valves},
      {"bulk modulus 70e6 Pa", [](HydraulicsDef& def) { def.oil_bulk_modulus = 70e6; }},
      {"hoses of 1.6e9 Pa",
       [](HydraulicsDef& def) {
         for_each<HoseDef>(def, "hose", [](HoseDef& hose) { hose.maximum_bulk_modulus = 1.6e9; });
       }},
      {"end stop at full speed",
       [](HydraulicsDef& def) { lift(def).common.maximum_stroke = test::kCraneStrokes[0] + 8e-3; }},
      {"pipe, 1 kPa, 1 ms and end stop",
       [](HydraulicsDef& def) {
         small_pump_line(def);
         fast_valves(def);
         def.orifice_transition = 1e3;
         lift(def).common.maximum_stroke = test::kCraneStrokes[0] + 8e-3;
       }},
  };
  return list;
}

struct Setting {
  std::string name;
  Solver solver;
  double tolerance;
  double max_substep = 1e-4;  // s
};

const std::vector<Setting>& settings() {
  static const std::vector<Setting> list = {
      {"RODAS3 1e-3", Solver::rodas3, 1e-3},
      {"RODAS3 1e-4", Solver::rodas3, 1e-4},
      {"RODAS3 1e-6", Solver::rodas3, 1e-6},
      {"RK4 0.5 ms", Solver::rk4, 1e-4, 5e-4},
      {"RK4 0.1 ms", Solver::rk4, 1e-4, 1e-4},
      {"RK4 0.02 ms", Solver::rk4, 1e-4, 2e-5},
      {"impl. Euler 1 ms", Solver::implicit_euler, 1e-4, 1e-3},
      {"impl. Euler 0.1 ms", Solver::implicit_euler, 1e-4, 1e-4},
      {"CVODE 1e-2", Solver::cvode, 1e-2},
      {"CVODE 1e-4", Solver::cvode, 1e-4},
  };
  return list;
}

struct Run {
  std::vector<double> p_A, p_pump, microseconds;  // by step
  bool is_good = true;                            // finite to the end
  bool is_flagged = false;
  double substeps = 0;  // per ms
  double mean = 0;      // us per ms
  std::size_t components = 0;
};

Run run(const Extreme& extreme, const Setting& setting, bool is_quasi_static = false) {
  HydraulicsDef def = test::crane_circuit();
  extreme.change(def);
  def.solver = setting.solver;
  def.relative_tolerance = setting.tolerance;
  def.max_substep = setting.max_substep;
  def.volumes[0].quasi_static = is_quasi_static;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const Masses masses(circuit);
  const double x[] = {extreme.lift_stroke, test::kCraneStrokes[1], test::kCraneStrokes[2]};
  integrator.start(x, test::kAtRest, test::kCraneForces);
  const int valve = circuit.find_control("L90Lift");
  const auto A = static_cast<std::size_t>(circuit.find_volume("Vol_LiftCyl_A"));
  const auto pump = static_cast<std::size_t>(circuit.find_volume("Vol_MainPump"));
  Run result;
  for (std::vector<double>* values : {&result.p_A, &result.p_pump, &result.microseconds}) values->reserve(kSteps);
  result.components = def.components.size();
  const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  for (int k = 0; k < kSteps; ++k) {
    circuit.set_control(valve, k >= 200 && k < 1200 ? 500 : 0);
    const double before = seconds_of(CLOCK_MONOTONIC);
    const StepReport report = integrator.step(kH, masses);
    result.microseconds.push_back(1e6 * (seconds_of(CLOCK_MONOTONIC) - before));
    result.is_good = result.is_good && !report.has_failed();
    result.is_flagged = result.is_flagged || report.has(StepFlag::not_converged) || report.has(StepFlag::step_budget);
    result.substeps += report.substeps / static_cast<double>(kSteps);
    result.p_A.push_back(integrator.state()[A]);
    result.p_pump.push_back(integrator.state()[pump]);
  }
  result.mean = 1e6 * (seconds_of(CLOCK_THREAD_CPUTIME_ID) - start) / kSteps;
  return result;
}

double largest_bar(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::fabs(a[k] - b[k]) / test::kBar);
  return worst;
}

struct Figures {
  double p_A = 0, p_pump = 0;  // bar
  double mean = 0, worst = 0;  // us
  Run last;
};

Figures measure(const Extreme& extreme, const Setting& setting, const Run& reference, bool is_quasi_static = false) {
  Figures figures{.mean = std::numeric_limits<double>::infinity(), .last = {}};
  std::vector<double> least(kSteps, std::numeric_limits<double>::infinity());
  for (int round = 0; round < kRounds; ++round) {
    figures.last = run(extreme, setting, is_quasi_static);
    figures.mean = std::min(figures.mean, figures.last.mean);
    for (std::size_t k = 0; k < least.size(); ++k) least[k] = std::min(least[k], figures.last.microseconds[k]);
  }
  figures.worst = *std::max_element(least.begin(), least.end());
  figures.p_A = largest_bar(figures.last.p_A, reference.p_A);
  figures.p_pump = largest_bar(figures.last.p_pump, reference.p_pump);
  return figures;
}

// A failed run shows no error; an asterisk stands where a step was flagged.
std::string errors_of(const Figures& f) {
  if (!f.last.is_good) return "failed";
  return fmt::format("{:.1g} / {:.1g}{}", f.p_A, f.p_pump, f.last.is_flagged ? " *" : "");
}
std::string cost_of(const Figures& f) {
  if (!f.last.is_good) return "-";
  return fmt::format("{:.1f} / {:.0f}", f.mean, f.worst);
}

void print_tables() {
  std::vector<Run> references;
  for (const Extreme& extreme : extremes()) references.push_back(run(extreme, {"", Solver::cvode, 1e-10}));
  std::string head = "| |", rule = "|---|", errors, costs;
  for (const Setting& setting : settings()) head += " " + setting.name + " |", rule += "---|";
  double cheapest = 0;
  for (std::size_t e = 0; e < extremes().size(); ++e) {
    errors += "| " + extremes()[e].name + " |", costs += "| " + extremes()[e].name + " |";
    for (const Setting& setting : settings()) {
      const Figures figures = measure(extremes()[e], setting, references[e]);
      errors += " " + errors_of(figures) + " |", costs += " " + cost_of(figures) + " |";
      if (e == 0 && setting.name == "RODAS3 1e-4") {
        cheapest = 1e3 * figures.mean / figures.last.substeps / static_cast<double>(figures.last.components);
      }
    }
    errors += "\n", costs += "\n";
  }
  fmt::print("Largest error, lift chamber A / pump line [bar]:\n\n{}\n{}\n{}\n", head, rule, errors);
  fmt::print("Cost, mean / worst step of 1 ms [us]:\n\n{}\n{}\n{}\n", head, rule, costs);
  fmt::print("RODAS3 1e-4, nominal: {:.1f} ns per component and sub-step\n\n", cheapest);
  fmt::print("Pump pipe 1e-6 m3 as a quasi-static volume, against the same circuit with its storage:\n\n");
  fmt::print("| | error [bar] | cost [us] |\n|---|---|---|\n");
  for (const Setting& setting : settings()) {
    if (setting.solver == Solver::rk4 || setting.solver == Solver::cvode) continue;
    for (const bool is_quasi_static : {false, true}) {
      const Figures figures = measure(extremes()[1], setting, references[1], is_quasi_static);
      fmt::print("| {}{} | {} | {} |\n", setting.name, is_quasi_static ? ", quasi-static" : "", errors_of(figures),
                 cost_of(figures));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "--steps") == 0) {
    for (int k = 0; k < std::atoi(argv[2]); ++k) {
      static_cast<void>(run(extremes()[0], {"", Solver::rodas3, 1e-4}));
    }
    return 0;
  }
  print_tables();
  return 0;
}
