// SPDX-License-Identifier: Apache-2.0
// The accuracy reference: all physics of a scene as one ODE (scene_equations.h) in CVODE.
//
// A co-simulation is judged against it: same laws, same start, same controls, no coupling. BDF at rtol 1e-9 with
// absolute tolerances of 1e-9 of each state's scale (0.01 rad, m, rad/s, m/s; pressure scale of the scene; 1 kJ); the
// integration restarts at every change of a control, of its slope, or of a parameter, and quaternions are normalised
// there; with joints that are cut also every 50 ms, where these are closed. Controls are the values that the components
// receive (after dead zone, ramp and scale), by channel index; they are held over a call of advance_to, as a tick holds
// them over a communication step, or go linearly over it.
//
// Card: docs/models/coupling_reference_monolith.md. Not for real time: it allocates and its cost is not bounded.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/status.h"
#include "core/time.h"
#include "monolith/scene_equations.h"
#include "monolith/stiff_solver.h"
#include "scene/scene.h"

namespace slew::monolith {

struct MonolithOptions {
  double relative_tolerance = 1e-9;
  double absolute_tolerance = 1e-9;  // tolerance in units of each state's scale
};

class Monolith final : private DifferentialEquation {
 public:
  // Pre-condition: a validated scene. Only read during construction.
  explicit Monolith(const scene::Scene& scene, MonolithOptions options = {});

  // State at time 0. Error: no static force holds the actuators.
  Status start();

  // Continues to t > time(). controls: held; controls_begin, controls_end: linear in between. One value per channel.
  // Error (diverged): CVODE gave up, with the time and the failing state; the state stays at that time.
  Status advance_to(SimTime t, std::span<const double> controls);
  Status advance_to(SimTime t, std::span<const double> controls_begin, std::span<const double> controls_end);

  // Sets a live parameter to its new SI value at once.
  Status set_parameter(std::string_view path, double value);
  [[nodiscard]] std::optional<double> parameter(std::string_view path) const { return equations_.parameter(path); }

  // Values at time(), after start() or advance_to()
  [[nodiscard]] SimTime time() const noexcept { return time_; }
  [[nodiscard]] std::span<const PortState> ports() const noexcept { return equations_.ports(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept { return equations_.variables(); }
  void read_variables(std::span<double> values) { equations_.read_variables(values); }
  [[nodiscard]] double variable(std::string_view name);  // NaN: no such variable
  [[nodiscard]] const SceneEquations& equations() const noexcept { return equations_; }
  [[nodiscard]] SolverStatistics statistics() const { return solver_.statistics(); }

 private:
  void rates(double t, const double* y, double* f) noexcept override { equations_.rates(t, y, f); }
  [[nodiscard]] std::string advance_closed(SimTime t);
  [[nodiscard]] std::string advance_solver(double t_end);
  [[nodiscard]] std::string advance_piece(double t_end);
  void restart_with(std::span<const double> controls, std::span<const double> slopes);

  SceneEquations equations_;
  StiffSolver solver_;
  SimTime time_, closed_at_;
  bool must_restart_ = true;
  std::vector<double> slope_, control_end_, slope_now_, y_, values_;
};

}  // namespace slew::monolith
