// SPDX-License-Identifier: Apache-2.0
// Coupling errors of all levels against the monolith, over the communication step, on the boom with one cylinder and on
// the truck crane, rigid and with a jib boom that bends, with and without friction; and their relation to eta.
//
//   coupling_error RESULTS.md FIGURES_FOLDER
//
// replaces the part of RESULTS.md between "<!-- measured: begin -->" and "<!-- measured: end -->" and writes
// coupling_*.svg. All runs get the same controls: the script sampled every 20 ms and held. Takes some minutes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/coupling_figures.h"
#include "benchmarks/measured_page.h"
#include "build_paths.h"
#include "plotting/svg_plot.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::benchmarks {
namespace {

using coupling::Level;
using coupling::test::Comparison;
using coupling::test::PortError;
using coupling::test::Traces;

constexpr double kSteps[] = {0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3};  // s

struct Case {
  std::string name, short_name, file;
  scene::Overrides overrides;
  double duration;  // s
};

scene::Overrides joined(scene::Overrides a, const scene::Overrides& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const scene::Overrides kBoomFriction = {"Cyl_Lift.friction_curve=Spline_CylinderFriction",
                                        "Cyl_Lift.cylinder_coefficient=0.9", "Cyl_Lift.seal_friction=1 kN"};
const scene::Overrides kCraneFrictionless = {
    "Cyl_Lift.cylinder_coefficient=1",          "Cyl_Lift.seal_friction=0 N",
    "Cyl_Jib.cylinder_coefficient=1",           "Cyl_Jib.seal_friction=0 N",
    "SlewCyl_CraneSlew.cylinder_coefficient=1", "SlewCyl_CraneSlew.seal_friction=0 N",
    "Body_Pillar.coulomb_friction=0 Nm",        "Body_Pillar.viscous_friction=0 Nms/rad"};

std::vector<Case> sweep_cases() {
  return {
      {"Boom on one cylinder, without friction", "boom, no friction", "single_cylinder.yaml", {}, 3},
      {"Boom on one cylinder, with friction", "boom, friction", "single_cylinder.yaml", kBoomFriction, 3},
      {"Truck crane, without friction", "crane, no friction", "truck_crane.yaml", kCraneFrictionless, 14},
      {"Truck crane, with friction", "crane, friction", "truck_crane.yaml", {}, 14},
      {"Crane with a jib boom that bends, without friction", "flexible, no friction", "truck_crane_flexible.yaml",
       kCraneFrictionless, 8},
      {"Crane with a jib boom that bends, with friction", "flexible, friction", "truck_crane_flexible.yaml", {}, 8}};
}

scene::Scene load(const Case& c, const scene::Overrides& more = {}) {
  // the error of a level beyond its limit is to be measured
  const scene::Overrides to_the_end = {"session.coupling_alarm=warn"};
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + c.file,
                          joined(joined(c.overrides, to_the_end), more));
}

// the port with the largest share of its range
const PortError& worst_port(const Comparison& run) {
  return *std::max_element(run.ports.begin(), run.ports.end(),
                           [](const PortError& a, const PortError& b) { return a.F / a.F_range < b.F / b.F_range; });
}

double share(const Comparison& run) {
  return worst_port(run).F / worst_port(run).F_range;
}

bool is_flagged(const Comparison& run) {
  return run.has_failed || (run.flags & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy)) != 0;
}

// ---- levels over the step ------------------------------------------------------------------------------------

constexpr Level kLevels[] = {Level::two, Level::linear, Level::tlm, Level::hold};
constexpr std::string_view kLevelNames[] = {"two", "linear", "tlm", "hold"};

// A run as a point: relative force error over eta.
struct EtaPoint {
  std::size_t level;  // in kLevels
  double eta, error;
};

bool is_usable(const Comparison& run) {
  return !run.has_failed && worst_port(run).F < worst_port(run).F_range;
}

std::string error_cell(const Comparison& run) {
  const std::string flag = is_flagged(run) ? " flagged" : "";
  if (run.has_failed) return "diverged" + flag;
  const PortError& port = worst_port(run);
  if (port.F > 10 * port.F_range) return "unstable" + flag;
  return fmt::format("{:.1e}{}", port.F / port.F_range, flag);
}

std::string header() {
  std::string text = "| H [ms] | omega_H ";
  for (const std::string_view name : kLevelNames) text += fmt::format("| {} ", name);
  return text + "|\n|---|---|---|---|---|---|\n";
}

struct Sweep {
  std::string text;
  std::vector<ErrorCurve> curves;  // by level
  std::vector<EtaPoint> points;
};

Sweep sweep(const Case& c, bool is_dashed) {
  scene::Scene scene = load(c);
  const Traces reference = coupling::test::reference_traces(scene, c.duration);
  Sweep result;
  for (std::size_t level = 0; level < std::size(kLevels); ++level) {
    result.curves.push_back(
        {fmt::format("{}: {}", kLevelNames[level], c.short_name), static_cast<int>(level), is_dashed, {}, {}});
  }
  result.text = fmt::format("### {}\n\n", c.name);
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const auto [low, high] = std::minmax_element(reference[i].F.begin(), reference[i].F.end());
    result.text += fmt::format("{}{} {:.0f} .. {:.0f} kN", i == 0 ? "Pressure forces of the reference: " : ", ",
                               scene.ports[i].name, *low / 1e3, *high / 1e3);
  }
  result.text += ".\n\n" + header();
  for (const double H : kSteps) {
    std::string errors;
    double omega_H = 0;
    for (std::size_t level = 0; level < std::size(kLevels); ++level) {
      const Comparison run = compare(scene, H, kLevels[level], reference, c.duration);
      if (kLevels[level] == Level::two) omega_H = run.omega_H;
      errors += fmt::format("| {} ", error_cell(run));
      result.curves[level].points.emplace_back(1e3 * H, run.has_failed ? 1e9 : share(run));
      result.curves[level].is_flagged.push_back(is_flagged(run));
      const PortError& port = worst_port(run);
      if (is_usable(run)) result.points.push_back({level, port.eta(), port.F / port.F_largest});
      std::cerr << "." << std::flush;
    }
    result.text += fmt::format("| {:g} | {:.2f} {}|\n", 1e3 * H, omega_H, errors);
  }
  result.text += "\n";
  return result;
}

// ---- force error over eta -------------------------------------------------------------------------------------------

std::string factors(const std::vector<EtaPoint>& points) {
  std::string text =
      "### Force error over eta\n\nRelative force error (largest error / largest force) over eta, of all runs above "
      "whose "
      "error "
      "is less than the range.\n\n| level | runs | least | a quarter below | median | three quarters below | most |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t level = 0; level < std::size(kLevels); ++level) {
    std::vector<double> factor;
    for (const EtaPoint& point : points) {
      if (point.level == level && point.eta > 0) factor.push_back(point.error / point.eta);
    }
    if (factor.empty()) continue;
    std::sort(factor.begin(), factor.end());
    const auto at = [&](double part) {
      return factor[static_cast<std::size_t>(part * static_cast<double>(factor.size() - 1))];
    };
    text += fmt::format("| {} | {} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.2g} |\n", kLevelNames[level], factor.size(),
                        at(0), at(0.25), at(0.5), at(0.75), at(1));
  }
  return text + "\n";
}

std::string eta_figure(const std::vector<EtaPoint>& points) {
  std::vector<ErrorCurve> curves;
  for (std::size_t level = 0; level < std::size(kLevels); ++level) {
    ErrorCurve curve{.name = std::string(kLevelNames[level]), .colour = static_cast<int>(level), .has_line = false};
    for (const EtaPoint& point : points) {
      if (point.level != level || !(point.eta > 0)) continue;
      curve.points.emplace_back(point.eta, point.error);
      curve.is_flagged.push_back(false);
    }
    curves.push_back(std::move(curve));
  }
  for (const double factor : {10.0, 100.0}) {
    curves.push_back({.name = fmt::format("error = {:g} eta", factor),
                      .colour = 4,
                      .is_dashed = factor > 10,
                      .has_marks = false,
                      .points = {{1e-8, 1e-8 * factor}, {1 / factor, 1}},
                      .is_flagged = {false, false}});
  }
  return log_log_svg(curves,
                     {.title = "Force error over eta",
                      .subtitle = "every run of the tables: largest force error over the indicator of the same run",
                      .x_label = "eta, over the whole run",
                      .y_label = "largest force error / largest force",
                      .x_low = 1e-8,
                      .x_high = 1,
                      .y_low = 1e-7,
                      .y_high = 1,
                      .x_ticks = {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1},
                      .has_flags = false});
}

// ---- limits of level two ------------------------------------------------------------------------------------

std::string limits_table(const Case& c) {
  const scene::Overrides oil = {"hydraulics.relative_tolerance=1e-6"};
  const scene::Overrides mechanics = {"mechanics.max_substep=0.1 ms"};
  const std::pair<std::string, scene::Overrides> variants[] = {{"as shipped", {}},
                                                               {"oil at rtol 1e-6", oil},
                                                               {"mechanics at 0.1 ms", mechanics},
                                                               {"both", joined(oil, mechanics)}};
  std::string text;
  for (const auto& [name, overrides] : variants) {
    scene::Scene scene = load(c, overrides);
    const Traces reference = coupling::test::reference_traces(scene, c.duration);
    text += fmt::format("| {} | {} ", c.name, name);
    for (const double H : {1e-3, 5e-3}) {
      const Comparison run = compare(scene, H, Level::two, reference, c.duration);
      for (const PortError& port : run.ports)
        text += fmt::format("{}{:.2g}", &port == &run.ports[0] ? "| " : " / ", port.F);
      text += " ";
    }
    text += "|\n";
    std::cerr << "." << std::flush;
  }
  return text;
}

std::string limits(const std::vector<Case>& cases) {
  std::string text =
      "### What limits level two\n\nLargest force error [N] by port.\n\n"
      "| machine | integrators | H = 1 ms | H = 5 ms |\n|---|---|---|---|\n";
  for (const std::size_t i : {std::size_t{0}, std::size_t{3}, std::size_t{5}}) text += limits_table(cases[i]);
  return text + "\n";
}

// ---- error of the reference itself -----------------------------------------------------------------------

// Largest difference of two references over the force range of the first, of the port with the largest share.
double spread(const Traces& a, const Traces& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto [low, high] = std::minmax_element(a[i].F.begin(), a[i].F.end());
    double difference = 0;
    for (std::size_t k = 0; k < a[i].F.size(); ++k) difference = std::max(difference, std::fabs(a[i].F[k] - b[i].F[k]));
    worst = std::max(worst, difference / (*high - *low));
  }
  return worst;
}

std::string spreads(const std::vector<Case>& cases) {
  std::string text =
      "### What the reference is worth\n\nLargest force difference from the reference (rtol 1e-9) as a share of the "
      "force range.\n\n| machine | rtol 1e-10 | rtol 1e-8 | rtol 1e-7 | load heavier by 1e-6 "
      "|\n|---|---|---|---|---|\n";
  for (const Case& c : cases) {
    const scene::Scene scene = load(c);
    const Traces reference = coupling::test::reference_traces(scene, c.duration);
    text += "| " + c.name + " ";
    for (const double rtol : {1e-10, 1e-8, 1e-7}) {
      text += fmt::format(
          "| {:.1e} ",
          spread(reference, coupling::test::reference_traces(
                                scene, c.duration, {.relative_tolerance = rtol, .absolute_tolerance = rtol})));
    }
    const scene::Scene heavier =
        load(c, {c.file == "single_cylinder.yaml" ? "Load.mass=1500.0015 kg" : "Bag.mass=500.0005 kg"});
    text += fmt::format("| {:.1e} |\n", spread(reference, coupling::test::reference_traces(heavier, c.duration)));
    std::cerr << "." << std::flush;
  }
  return text + "\n";
}

// ---- rough events ---------------------------------------------------------------------------------------------

std::string events() {
  const Case cases[] = {
      {"boom into its end stop (5e7 N/m) at full speed",
       "",
       "single_cylinder.yaml",
       {"Cyl_Lift.maximum_stroke=875 mm"},
       3},
      {"crane from 1 bar (table13): the boom drops onto its oil",
       "",
       "truck_crane.yaml",
       {"hydraulics.start=table13"},
       2},
      {"crane with 1500 kg, command beyond the valve's limit", "", "truck_crane.yaml", {"Bag.mass=1500 kg"}, 8}};
  std::string text =
      "### Rough events, level two\n\nLargest force error [N] of the worst port, and its share of the range.\n\n"
      "| event | 1 ms | 5 ms | 10 ms |\n|---|---|---|---|\n";
  for (const Case& c : cases) {
    scene::Scene scene = load(c);
    const Traces reference = coupling::test::reference_traces(scene, c.duration);
    text += "| " + c.name + " ";
    for (const double H : {1e-3, 5e-3, 10e-3}) {
      const Comparison run = compare(scene, H, Level::two, reference, c.duration);
      text += fmt::format("| {:.2g} ({:.1e}){} ", worst_port(run).F, share(run), is_flagged(run) ? " flagged" : "");
    }
    text += "|\n";
  }
  return text + "\n";
}

// ---- curves over time -----------------------------------------------------------------------------------------

struct Recorded {
  std::vector<double> time, force, error;  // s, kN, N
};

Recorded record(scene::Scene& scene, double H, Level level, const Traces& reference, double duration) {
  scene.session.step = H;
  scene.session.coupling = level;
  coupling::test::CoupledRun run(scene);
  if (!run.start().is_ok()) return {};
  coupling::test::Operator op(scene, coupling::test::kControlGrid);
  Recorded recorded;
  while (run.time().seconds() < duration - 1e-9) {
    run.step(op.controls(run.time()));
    const auto k = static_cast<std::size_t>(run.time().ns / coupling::test::kTraceGrid.ns);
    recorded.time.push_back(run.time().seconds());
    recorded.force.push_back(run.actuators().F[0] * 1e-3);
    recorded.error.push_back(run.actuators().F[0] - reference[0].F[k]);
  }
  return recorded;
}

std::string force_over_time(const Case& c) {
  scene::Scene scene = load(c);
  const Traces reference = coupling::test::reference_traces(scene, c.duration);
  plotting::Series exact{"reference", "kN", {}, {}};
  for (std::size_t k = 0; k < reference[0].F.size(); ++k) {
    exact.time.push_back(static_cast<double>(k) * coupling::test::kTraceGrid.seconds());
    exact.values.push_back(reference[0].F[k] * 1e-3);
  }
  const Recorded hold = record(scene, 1e-3, Level::hold, reference, c.duration);
  const Recorded two = record(scene, 10e-3, Level::two, reference, c.duration);
  const Recorded fine = record(scene, 1e-3, Level::two, reference, c.duration);
  const plotting::Series series[] = {{"hold, 1 ms", "kN", hold.time, hold.force},
                                     exact,
                                     {"two, 10 ms", "kN", two.time, two.force},
                                     {"error of two, 1 ms", "N", fine.time, fine.error}};
  return plotting::plot_svg(series,
                            {.title = "Cylinder force of the frictionless boom",
                             .subtitle = "full command from 0.2 s to 1.2 s; level two at 10 ms lies on the reference"});
}

// ---- output ---------------------------------------------------------------------------------------------------

bool write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  return out.good();
}

int run(const std::filesystem::path& results, const std::filesystem::path& figures) {
  const std::vector<Case> cases = sweep_cases();
  std::string text = "\n";
  std::vector<ErrorCurve> curves;
  std::vector<EtaPoint> points;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const bool is_hardest = i == 0;
    Sweep one = sweep(cases[i], is_hardest);
    text += one.text;
    points.insert(points.end(), one.points.begin(), one.points.end());
    // the figure: the hardest case and the machine
    if (!is_hardest && cases[i].short_name != "crane, friction") continue;
    for (ErrorCurve& curve : one.curves) curves.push_back(std::move(curve));
  }
  text += factors(points) + limits(cases) + spreads(cases) + events();
  std::filesystem::create_directories(figures);
  const LogLogPlot plot{.title = "Force error over the communication step",
                        .subtitle = "largest difference from the monolith, share of the worst port's force range",
                        .x_label = "communication step H [ms]",
                        .y_label = "largest force error / force range"};
  const bool is_written = write(figures / "coupling_error.svg", log_log_svg(curves, plot)) &&
                          write(figures / "coupling_eta.svg", eta_figure(points)) &&
                          write(figures / "coupling_force.svg", force_over_time(cases[0])) &&
                          replace_measured(results, text);
  std::cerr << "\n";
  if (is_written) return 0;
  std::cerr << "could not write " << figures << " or find the marks in " << results << "\n";
  return 6;
}

}  // namespace
}  // namespace slew::benchmarks

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: coupling_error RESULTS.md FIGURES_FOLDER\n";
    return 2;
  }
  try {
    return slew::benchmarks::run(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
