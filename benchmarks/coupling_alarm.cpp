// SPDX-License-Identifier: Apache-2.0
// The alarm of the coupling and its lamps, beside the errors against the monolith: machines, kinds of control, levels,
// steps and late samples, each run to its end.
//
//   coupling_alarm RESULTS.md RUNS.md
//
// replaces the parts of both pages between "<!-- measured: begin -->" and "<!-- measured: end -->": the summary, and
// the tables of every run. Controls are held over 20 ms, so that all steps receive the same. Takes some minutes. The
// same figures on every run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "benchmarks/measured_page.h"
#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::benchmarks {
namespace {

using coupling::Level;
using coupling::test::CoupledRun;
using coupling::test::kControlGrid;
using coupling::test::kTraceGrid;
using coupling::test::Trace;
using coupling::test::Traces;

using Signals = std::vector<std::vector<double>>;  // by control period, by channel

struct Machine {
  std::string name, file;
  scene::Overrides overrides;
  double duration;   // s
  double amplitude;  // raw signal of the moving valves
};

struct Variant {
  Level level;
  std::string_view name;
  double H;            // s
  StepIndex late = 0;  // steps
};

// Results of one port.
struct PortOutcome {
  Level level;
  double rms = 0;  // force error over any second, share of the force range
  double x = 0;    // largest stroke error, share of the stroke range
  double eta = 0;  // largest
};

struct Outcome {
  std::vector<PortOutcome> ports;
  double rms = 0;           // force error over any second, share of the port's force range, worst port
  double x = 0;             // largest stroke error, share of the port's stroke range, worst port
  double eta = 0, net = 0;  // largest, lowest
  bool old_alarm = false;   // net below -3e-3 for 0.2 s
  double ends_at = -1;      // s; < 0: no alarm
  bool has_failed = false;  // not finite
};

enum Class : std::size_t { sound, poor, diverged };
constexpr std::string_view kClassNames[] = {"sound", "poor", "diverged"};
constexpr std::string_view kKinds[] = {"script", "sine", "fast", "jumps", "chatter"};

constexpr double kDiverged = 0.5;  // force error, share of its range

// sound: within 3 % of the force range over any second and 1 % of the stroke's; diverged: beyond half of the force
// range
Class class_of(const Outcome& outcome) {
  if (outcome.has_failed || !(outcome.rms < kDiverged)) return diverged;
  return outcome.rms < 0.03 && outcome.x < 0.01 ? sound : poor;
}

std::vector<Machine> machines() {
  const std::string scenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";
  const std::string excavator = std::string(SLEWRING_SOURCE_DIR) + "/tests/validation/coupling/mini_excavator.yaml";
  const scene::Overrides boom_friction = {"Cyl_Lift.friction_curve=Spline_CylinderFriction",
                                          "Cyl_Lift.cylinder_coefficient=0.9", "Cyl_Lift.seal_friction=1 kN"};
  const scene::Overrides crane_smooth = {
      "Cyl_Lift.cylinder_coefficient=1",          "Cyl_Lift.seal_friction=0 N",
      "Cyl_Jib.cylinder_coefficient=1",           "Cyl_Jib.seal_friction=0 N",
      "SlewCyl_CraneSlew.cylinder_coefficient=1", "SlewCyl_CraneSlew.seal_friction=0 N",
      "Body_Pillar.coulomb_friction=0 Nm",        "Body_Pillar.viscous_friction=0 Nms/rad"};
  const scene::Overrides excavator_smooth = {"Cyl_Boom.cylinder_coefficient=1",   "Cyl_Boom.seal_friction=0 N",
                                             "Cyl_Stick.cylinder_coefficient=1",  "Cyl_Stick.seal_friction=0 N",
                                             "Cyl_Bucket.cylinder_coefficient=1", "Cyl_Bucket.seal_friction=0 N"};
  return {{"two-dof crane", scenes + "two_dof_crane.yaml", {}, 10, 0.1},
          {"boom, no friction", scenes + "single_cylinder.yaml", {}, 6, 0.8},
          {"boom, friction", scenes + "single_cylinder.yaml", boom_friction, 6, 0.8},
          {"tipper", scenes + "tipper.yaml", {}, 8, 0.8},
          {"excavator, friction", excavator, {}, 8, 0.8},
          {"excavator, no friction", excavator, excavator_smooth, 8, 0.8},
          {"crane, friction", scenes + "truck_crane.yaml", {}, 10, 0.8},
          {"crane, no friction", scenes + "truck_crane.yaml", crane_smooth, 10, 0.8},
          {"flexible, friction", scenes + "truck_crane_flexible.yaml", {}, 6, 0.8},
          {"flexible, no friction", scenes + "truck_crane_flexible.yaml", crane_smooth, 6, 0.8}};
}

std::vector<Variant> variants() {
  std::vector<Variant> list;
  for (const double H : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    list.push_back({Level::two, "two", H});
    list.push_back({Level::linear, "linear", H});
  }
  for (const double H : {1e-3, 2e-3, 5e-3, 10e-3, 20e-3}) {
    list.push_back({Level::hold, "hold", H});
    list.push_back({Level::tlm, "tlm", H});
  }
  for (const double H : {1e-3, 5e-3}) {
    for (const StepIndex late : {1, 3, 6}) list.push_back({Level::two, "two", H, late});
  }
  return list;
}

// Uniform in -1..1, the same on every machine.
double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-52 - 1;
}

double raw_signal(std::string_view kind, double t, std::size_t tick, std::size_t channel, double& held,
                  std::mt19937_64& random) {
  const double since = std::max(0.0, t - 0.2), i = static_cast<double>(channel);
  if (kind == "sine") return std::sin(2 * std::numbers::pi * (0.7 + 0.23 * i) * since);
  if (kind == "fast") return std::sin(2 * std::numbers::pi * (3 + 0.7 * i) * since);
  if (kind == "jumps" && tick % 25 == 10 + channel) held = uniform(random);
  if (kind == "chatter" && tick >= 10) held = uniform(random) > 0 ? 1 : -1;
  return held;
}

Signals signals_of(const scene::Scene& scene, const Machine& machine, std::string_view kind) {
  const auto ticks = static_cast<std::size_t>(std::llround(machine.duration / kControlGrid.seconds())) + 1;
  Signals signals(ticks, std::vector<double>(scene.inputs.size()));
  coupling::test::Operator op(scene, kControlGrid);
  std::mt19937_64 random(7);
  std::vector<double> held(scene.inputs.size(), 0.0);
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const SimTime t{static_cast<std::int64_t>(tick) * kControlGrid.ns};
    const std::span<const double> script = op.controls(t);
    for (std::size_t i = 0; i < held.size(); ++i) {
      signals[tick][i] = kind == "script" ? script[i]
                                          : scene.inputs[i].scale * machine.amplitude *
                                                raw_signal(kind, t.seconds(), tick, i, held[i], random);
    }
  }
  return signals;
}

std::span<const double> at(const Signals& signals, SimTime t) {
  return signals[static_cast<std::size_t>(t.ns / kControlGrid.ns)];
}

// By port; empty when the monolith gave up.
Traces reference(const scene::Scene& scene, const Signals& signals, double duration) {
  monolith::Monolith monolith(scene, {1e-8, 1e-8});
  if (!monolith.start().is_ok()) return {};
  Traces traces(scene.ports.size());
  const auto samples = static_cast<std::int64_t>(std::llround(duration / kTraceGrid.seconds()));
  for (std::int64_t k = 0; k <= samples; ++k) {
    for (std::size_t i = 0; i < traces.size(); ++i) {
      traces[i].x.push_back(monolith.ports()[i].x);
      traces[i].F.push_back(monolith.ports()[i].F);
    }
    const SimTime now{k * kTraceGrid.ns}, next{(k + 1) * kTraceGrid.ns};
    if (k < samples && !monolith.advance_to(next, at(signals, now)).is_ok()) return {};
  }
  return traces;
}

double range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

// Root mean square of the newest second.
class SecondOf {
 public:
  explicit SecondOf(double H) : squares_(static_cast<std::size_t>(std::llround(1 / H)), 0.0) {}
  double add(double value) {
    double& oldest = squares_[next_++ % squares_.size()];
    sum_ += value * value - oldest;
    oldest = value * value;
    return std::sqrt(std::max(0.0, sum_) / static_cast<double>(squares_.size()));
  }

 private:
  std::vector<double> squares_;
  std::size_t next_ = 0;
  double sum_ = 0;
};

Outcome outcome_of(scene::Scene& scene, const Variant& variant, const Signals& signals, const Traces& traces,
                   double duration) {
  scene.session.step = variant.H;
  scene.session.coupling = variant.level;
  scene.session.mode = variant.late > 0 ? scene::ExchangeMode::free_running : scene::ExchangeMode::lockstep;
  CoupledRun run(scene, variant.late > 0 ? coupling::test::delayed(variant.late) : coupling::test::Ages{});
  Outcome outcome;
  if (!run.start().is_ok()) return outcome;
  std::vector<SecondOf> errors(traces.size(), SecondOf(variant.H));
  outcome.ports.assign(traces.size(), {variant.level});
  const auto steps = static_cast<StepIndex>(std::llround(duration / variant.H));
  for (StepIndex n = 0; n < steps && !run.has_failed(); ++n) {
    run.step(at(signals, run.time()));
    const auto k = static_cast<std::size_t>(run.time().ns / kTraceGrid.ns);
    for (std::size_t i = 0; i < traces.size(); ++i) {
      const coupling::PortDefects& defects = run.indicator().port(i);
      PortOutcome& port = outcome.ports[i];
      port.eta = std::max(port.eta, defects.eta);
      port.x = std::max(port.x, std::fabs(run.mechanism().x[i] - traces[i].x[k]) / range_of(traces[i].x));
      port.rms = std::max(port.rms, errors[i].add((run.actuators().F[i] - traces[i].F[k]) / range_of(traces[i].F)));
      outcome.net = std::min(outcome.net, defects.net);
      outcome.old_alarm = outcome.old_alarm || defects.creates_energy;
      if (outcome.ends_at < 0 && run.indicator().diverges(i)) outcome.ends_at = run.time().seconds();
    }
  }
  for (const PortOutcome& port : outcome.ports) {
    outcome.eta = std::max(outcome.eta, port.eta);
    outcome.x = std::max(outcome.x, port.x);
    outcome.rms = std::max(outcome.rms, port.rms);
  }
  outcome.has_failed = run.has_failed();
  return outcome;
}

struct Counts {
  std::array<int, 3> runs{}, ended{}, old_ended{};
  void add(const Outcome& outcome) {
    const Class c = class_of(outcome);
    ++runs[c];
    if (outcome.ends_at >= 0 || outcome.has_failed) ++ended[c];
    if (outcome.old_alarm || outcome.has_failed) ++old_ended[c];
  }
};

std::string row_of(const Counts& counts) {
  std::string row;
  for (const std::array<int, 3>* ended : {&counts.ended, &counts.old_ended}) {
    for (std::size_t c = 0; c < 3; ++c) row += fmt::format("| {} of {} ", (*ended)[c], counts.runs[c]);
  }
  return row + "|\n";
}

std::string cell_of(const Outcome& outcome) {
  const std::string end = outcome.has_failed     ? " not finite"
                          : outcome.ends_at >= 0 ? fmt::format(" ends {:.1f} s", outcome.ends_at)
                                                 : "";
  if (outcome.has_failed) return end;
  return fmt::format("{:.1e} / {:.1e}; {:.0e}, {:.0e}{}{}", outcome.rms, outcome.x, outcome.eta, outcome.net,
                     outcome.old_alarm ? " (old)" : "", end);
}

struct Study {
  std::string tables;
  std::array<Counts, std::size(kKinds)> by_kind{};
  Counts all;
  std::vector<std::string> wrong;  // false alarms and missed divergences
  std::vector<PortOutcome> lamps;  // ports of runs in lockstep
};

// hold and tlm have no alarm that ends a session
bool is_tabled(const Variant& variant) {
  return coupling::is_balanced(variant.level);
}

void study(const Machine& machine, const std::vector<Variant>& list, Study& result) {
  scene::Overrides overrides = machine.overrides;
  overrides.insert(overrides.end(), {"session.coupling_alarm=warn", "session.contact=off"});
  scene::Scene scene = scene::load_file(machine.file, overrides);
  std::vector<std::string> rows;
  for (const Variant& v : list) {
    rows.push_back(
        fmt::format("| {} {:g} ms{} ", v.name, 1e3 * v.H, v.late > 0 ? fmt::format(", {} late", v.late) : ""));
  }
  for (std::size_t kind = 0; kind < std::size(kKinds); ++kind) {
    const Signals signals = signals_of(scene, machine, kKinds[kind]);
    const Traces traces = reference(scene, signals, machine.duration);
    for (std::size_t v = 0; v < list.size(); ++v) {
      if (traces.empty()) {
        rows[v] += "| no reference ";
        continue;
      }
      const Outcome outcome = outcome_of(scene, list[v], signals, traces, machine.duration);
      if (list[v].late == 0 && !outcome.has_failed) {
        result.lamps.insert(result.lamps.end(), outcome.ports.begin(), outcome.ports.end());
      }
      if (!is_tabled(list[v])) continue;
      rows[v] += "| " + cell_of(outcome) + " ";
      result.by_kind[kind].add(outcome);
      result.all.add(outcome);
      const Class c = class_of(outcome);
      const bool ends = outcome.ends_at >= 0 || outcome.has_failed;
      if (c == poor || ends == (c == diverged)) continue;
      result.wrong.push_back(fmt::format("| {}, {} {}| {} | {} |\n", machine.name, kKinds[kind],
                                         rows[v].substr(1, rows[v].find('|', 1) - 1), kClassNames[c],
                                         cell_of(outcome)));
    }
    std::cerr << "." << std::flush;
  }
  result.tables += fmt::format("### {}\n\n| run ", machine.name);
  for (const std::string_view kind : kKinds) result.tables += fmt::format("| {} ", kind);
  result.tables += "|\n|---|---|---|---|---|---|\n";
  for (std::size_t v = 0; v < list.size(); ++v) {
    if (is_tabled(list[v])) result.tables += rows[v] + "|\n";
  }
  result.tables += "\n";
}

// share: of the values that lie below; "-" of few values
std::string quantile(std::vector<double> values, double share) {
  if (values.size() < 5) return "-";
  std::sort(values.begin(), values.end());
  return fmt::format("{:.1e}", values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]);
}

struct LampRow {
  std::string_view name;
  double least, most;  // bounds of eta
};
constexpr LampRow kLampRows[] = {{"green", -1, coupling::kGreenBelow},
                                 {"amber", coupling::kGreenBelow, coupling::kAmberBelow},
                                 {"red", coupling::kAmberBelow, std::numeric_limits<double>::infinity()}};

// Errors of the ports behind each lamp, and over eta of those that are neither green nor diverged.
std::string lamps_of(const std::vector<PortOutcome>& ports) {
  std::string text =
      "\n### What the lamps stand for\n\n| level | lamp | ports | force: half below | 95 of 100 below | stroke: half "
      "below "
      "| 95 of 100 below |\n|---|---|---|---|---|---|---|\n";
  std::string factors =
      "\n| level | force / eta: half below | 95 of 100 below | stroke / eta: half below | 95 of 100 below |"
      "\n|---|---|---|---|---|\n";
  for (const auto& [name, levels] :
       {std::pair{"two, linear", std::pair{Level::linear, Level::two}},
        std::pair{"hold", std::pair{Level::hold, Level::hold}}, std::pair{"tlm", std::pair{Level::tlm, Level::tlm}}}) {
    std::vector<double> force_over_eta, stroke_over_eta;
    for (const LampRow& lamp : kLampRows) {
      std::vector<double> force, stroke;
      for (const PortOutcome& port : ports) {
        const bool is_meant = port.level == levels.first || port.level == levels.second;
        if (!is_meant || !(port.eta >= lamp.least) || !(port.eta < lamp.most)) continue;
        force.push_back(port.rms);
        stroke.push_back(port.x);
        // a diverged run has no error to relate
        if (port.eta < coupling::kGreenBelow || !(port.rms < kDiverged)) continue;
        force_over_eta.push_back(port.rms / port.eta);
        stroke_over_eta.push_back(port.x / port.eta);
      }
      text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", name, lamp.name, force.size(), quantile(force, 0.5),
                          quantile(force, 0.95), quantile(stroke, 0.5), quantile(stroke, 0.95));
    }
    factors +=
        fmt::format("| {} | {} | {} | {} | {} |\n", name, quantile(force_over_eta, 0.5), quantile(force_over_eta, 0.95),
                    quantile(stroke_over_eta, 0.5), quantile(stroke_over_eta, 0.95));
  }
  return text + factors;
}

std::string text_of(const Study& result) {
  std::string text =
      "\n### Runs that end\n\n| control | sound | poor | diverged | net energy: sound | poor | diverged |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t kind = 0; kind < std::size(kKinds); ++kind) {
    text += fmt::format("| {} {}", kKinds[kind], row_of(result.by_kind[kind]));
  }
  text += "| all " + row_of(result.all) + "\n### False alarms and missed divergences\n\n";
  if (result.wrong.empty()) {
    text += "None.\n\n";
  } else {
    text += "| run | is | errors; eta, net |\n|---|---|---|\n";
    for (const std::string& row : result.wrong) text += row;
    text += "\n";
  }
  return lamps_of(result.lamps) + text;
}

int run(const std::string& results, const std::string& runs) {
  Study result;
  const std::vector<Variant> list = variants();
  for (const Machine& machine : machines()) study(machine, list, result);
  if (!replace_measured(results, text_of(result))) {
    std::cerr << "could not find the marks in " << results << "\n";
    return 6;
  }
  if (!replace_measured(runs, "\n" + result.tables)) {
    std::cerr << "could not find the marks in " << runs << "\n";
    return 6;
  }
  return 0;
}

}  // namespace
}  // namespace slew::benchmarks

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: coupling_alarm RESULTS.md RUNS.md\n";
    return 2;
  }
  try {
    return slew::benchmarks::run(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
