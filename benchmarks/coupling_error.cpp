// Coupling errors of the levels hold and two against the monolith, over the communication step, on the boom with one
// cylinder and on the truck crane, with and without friction.
//
//   coupling_error RESULTS.md FIGURES_FOLDER
//
// replaces what stands in RESULTS.md between "<!-- measured: begin -->" and "<!-- measured: end -->" and writes
// coupling_*.svg. All runs get the same controls: the script sampled every 20 ms and held. Takes about a minute.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/coupling_figures.h"
#include "build_paths.h"
#include "cli/plotting/svg_plot.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::benchmarks {
namespace {

using coupling::Level;
using coupling::test::Comparison;
using coupling::test::PortError;
using coupling::test::Traces;

constexpr double kSteps[] = {0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3};  // s

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
  return {{"Boom on one cylinder, without friction", "boom, no friction", "single_cylinder.yaml", {}, 3},
          {"Boom on one cylinder, with friction", "boom, friction", "single_cylinder.yaml", kBoomFriction, 3},
          {"Truck crane, without friction", "crane, no friction", "truck_crane.yaml", kCraneFrictionless, 14},
          {"Truck crane, with friction", "crane, friction", "truck_crane.yaml", {}, 14}};
}

scene::Scene load(const Case& c, const scene::Overrides& more = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + c.file, joined(c.overrides, more));
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

// "x F share eta net" cells of one level
std::string cells(const Comparison& run) {
  if (run.has_failed) return "diverged | | | flagged";
  const PortError& port = worst_port(run);
  if (port.F > 10 * port.F_range) return fmt::format("unstable | | | {}", is_flagged(run) ? "flagged" : "**no flag**");
  return fmt::format("{:.3g} | {:.2g} | {:.1e} | {:.1e}{}", 1e6 * port.x, port.F, port.F / port.F_range, port.eta(),
                     is_flagged(run) ? " flagged" : "");
}

struct Sweep {
  std::string text;
  std::vector<ErrorCurve> curves;
};

Sweep sweep(const Case& c, int colour) {
  scene::Scene scene = load(c);
  const Traces reference = coupling::test::reference_traces(scene, c.duration);
  Sweep result;
  result.curves = {{"two: " + c.short_name, colour, false, {}, {}}, {"hold: " + c.short_name, colour, true, {}, {}}};
  result.text = fmt::format("### {}\n\n", c.name);
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const auto [low, high] = std::minmax_element(reference[i].F.begin(), reference[i].F.end());
    result.text += fmt::format("{}{} {:.0f} .. {:.0f} kN", i == 0 ? "Pressure forces of the reference: " : ", ",
                               scene.ports[i].name, *low / 1e3, *high / 1e3);
  }
  result.text +=
      ".\n\n| H [ms] | omega_H | two: x [um] | F [N] | of range | eta | hold: x [um] | F [N] | of range | eta |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const double H : kSteps) {
    const Comparison two = compare(scene, H, Level::two, reference, c.duration);
    const Comparison hold = compare(scene, H, Level::hold, reference, c.duration);
    result.text += fmt::format("| {:g} | {:.2f} | {} | {} |\n", 1e3 * H, two.omega_H, cells(two), cells(hold));
    const Comparison* runs[] = {&two, &hold};
    for (std::size_t level = 0; level < 2; ++level) {
      const double error = runs[level]->has_failed ? 1e9 : share(*runs[level]);
      result.curves[level].points.emplace_back(1e3 * H, error);
      result.curves[level].is_flagged.push_back(is_flagged(*runs[level]));
    }
    std::cerr << "." << std::flush;
  }
  result.text += "\n";
  return result;
}

// ---- what limits level two ------------------------------------------------------------------------------------

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
  for (const std::size_t i : {std::size_t{0}, std::size_t{3}}) text += limits_table(cases[i]);
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

bool replace_measured(const std::filesystem::path& path, const std::string& text) {
  const std::string begin = "<!-- measured: begin -->\n", end = "<!-- measured: end -->";
  std::stringstream old;
  old << std::ifstream(path, std::ios::binary).rdbuf();
  const std::string page = old.str();
  const std::size_t from = page.find(begin), to = page.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) return false;
  return write(path, page.substr(0, from + begin.size()) + text + page.substr(to));
}

int run(const std::filesystem::path& results, const std::filesystem::path& figures) {
  const std::vector<Case> cases = sweep_cases();
  std::string text = "\n";
  std::vector<ErrorCurve> curves;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Sweep one = sweep(cases[i], static_cast<int>(i));
    text += one.text;
    for (ErrorCurve& curve : one.curves) curves.push_back(std::move(curve));
  }
  text += limits(cases) + events();
  std::filesystem::create_directories(figures);
  const LogLogPlot plot{.title = "Force error over the communication step",
                        .subtitle = "largest difference from the monolith, share of the worst port's force range",
                        .x_label = "communication step H [ms]",
                        .y_label = "largest force error / force range"};
  const bool is_written = write(figures / "coupling_error.svg", log_log_svg(curves, plot)) &&
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
