// SPDX-License-Identifier: Apache-2.0
// A valve whose signal moves all the time, as a script of straight lines through the scene's input, against the
// monolith under the same lines (docs/models/coupling_levels.md, "An input that moves within a step"). Two machines:
// the boom on one cylinder with friction, whose valve has a spool with states, and the crane with two degrees of
// freedom, whose valve opens at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "build_paths.h"
#include "io_node/input_gate.h"
#include "io_node/scene_config.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace smooth_inputs_test {

constexpr SimDuration kDuration = milliseconds(992);
constexpr SimDuration kGrid = milliseconds(16);
constexpr std::int64_t kPieceNs = 250'000;  // length of a piece of the moving signal
constexpr double kOpening = 0.2;            // s, from neutral: no jump at the start

void require_ok(const Status& status) {
  if (!status.is_ok()) throw std::runtime_error(status.text);
}

struct Machine {
  scene::Scene scene;
  double mean, swing;  // mean and amplitude of the raw value

  [[nodiscard]] double raw(double frequency, double t) const {
    const double opened = t < kOpening ? 0.5 - 0.5 * std::cos(std::numbers::pi * t / kOpening) : 1.0;
    return opened * (mean + swing * std::sin(2 * std::numbers::pi * frequency * t));
  }
};

// with the integrators' own errors out of the way
const scene::Overrides kTight = {"hydraulics.relative_tolerance=1e-6", "mechanics.max_substep=0.25 ms"};

scene::Scene load(const std::string& name, scene::Overrides overrides) {
  overrides.insert(overrides.end(), kTight.begin(), kTight.end());
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + name, overrides);
}

Machine boom() {
  return {load("single_cylinder.yaml", {"Cyl_Lift.friction_curve=Spline_CylinderFriction",
                                        "Cyl_Lift.cylinder_coefficient=0.9", "Cyl_Lift.seal_friction=1 kN"}),
          0.5, 0.3};
}

Machine crane() {
  return {load("two_dof_crane.yaml", {}), 0.0, 0.2};
}

// Values compared on the grid.
enum class Compared { F, x };  // N, m

// On the grid, of a signal that is straight over each piece or held from its beginning
enum class Signal { moves, is_held };
std::vector<double> reference_values(const Machine& machine, double frequency, std::int64_t piece_ns, Signal kind,
                                     Compared compared) {
  monolith::Monolith reference(machine.scene, {});
  require_ok(reference.start());
  const double scale = machine.scene.inputs[0].scale;
  std::vector<double> values;
  for (std::int64_t t = 0; t < kDuration.ns; t += piece_ns) {
    const std::vector<double> begin{scale * machine.raw(frequency, SimTime{t}.seconds())};
    const std::vector<double> end{scale * machine.raw(frequency, SimTime{t + piece_ns}.seconds())};
    require_ok(reference.advance_to({t + piece_ns}, begin, kind == Signal::moves ? end : begin));
    const monolith::PortState& port = reference.ports()[0];
    if ((t + piece_ns) % kGrid.ns == 0) values.push_back(compared == Compared::F ? port.F : port.x);
  }
  return values;
}

// The same signal as the scene's script, in points that lines join or that hold until the next.
void set_script(Machine& machine, double frequency, std::int64_t piece_ns, scene::ScriptInterpolation interpolation) {
  scene::ScriptTrack track{.input = machine.scene.inputs[0].name, .points = {}};
  for (std::int64_t t = 0; t <= kDuration.ns; t += piece_ns) {
    track.points.push_back({SimTime{t}.seconds(), machine.raw(frequency, SimTime{t}.seconds())});
  }
  machine.scene.script = {};
  machine.scene.script.interpolation = interpolation;
  machine.scene.script.tracks = {track};
}

// Largest difference on the grid.
double error_of(Machine& machine, double H, Level level, const std::vector<double>& reference, Compared compared) {
  machine.scene.session.step = H;
  machine.scene.session.coupling = level;
  const SimDuration step = machine.scene.session.step_duration();
  io_node::IoConfig config = io_node::make_config(machine.scene, "s", io_node::Recording::none);
  io_node::InputGate gate(config.channels, config.gate(), step);
  io_node::InputSources sources(std::move(config.sources), config.channels, step);
  CoupledRun run(machine.scene);
  require_ok(run.start());
  double error = 0;
  StepIndex n = 0;
  for (std::size_t k = 0; k < reference.size(); ++n) {
    gate.advance(n, sources.read(run.time(), run.time() + step), 0);
    run.step(std::vector<double>{gate.control(0)});
    if (run.has_failed()) throw std::runtime_error("the coupled run failed");
    if (run.time().ns % kGrid.ns != 0) continue;
    const double value = compared == Compared::F ? run.actuators().F[0] : run.mechanism().x[0];
    error = std::max(error, std::fabs(value - reference[k++]));
  }
  return error;
}

// order of the error by step, from 4 to 2 and from 2 to 1 ms
std::vector<double> orders(const std::vector<double>& errors) {
  std::vector<double> result;
  for (std::size_t i = 1; i < errors.size(); ++i) result.push_back(std::log2(errors[i - 1] / errors[i]));
  return result;
}

constexpr double kSteps[] = {4e-3, 2e-3, 1e-3};  // s

std::vector<double> errors_to_moving(Machine& machine, Level level, double frequency,
                                     scene::ScriptInterpolation interpolation, Compared compared) {
  const std::vector<double> moving = reference_values(machine, frequency, kPieceNs, Signal::moves, compared);
  set_script(machine, frequency, kPieceNs, interpolation);
  std::vector<double> errors;
  for (const double H : kSteps) errors.push_back(error_of(machine, H, level, moving, compared));
  return errors;
}

// both sides of the comparison hold the same values over the same steps
std::vector<double> errors_to_held(Machine& machine, Level level, double frequency, Compared compared) {
  std::vector<double> errors;
  for (const double H : kSteps) {
    const std::int64_t step_ns = duration_of_seconds(H).ns;
    const std::vector<double> held = reference_values(machine, frequency, step_ns, Signal::is_held, compared);
    set_script(machine, frequency, step_ns, scene::ScriptInterpolation::step);
    errors.push_back(error_of(machine, H, level, held, compared));
  }
  return errors;
}

constexpr scene::ScriptInterpolation kLines = scene::ScriptInterpolation::linear;
constexpr scene::ScriptInterpolation kHeld = scene::ScriptInterpolation::step;

void expect_orders(const std::vector<double>& errors, double order, double within, double frequency) {
  for (const double found : orders(errors)) EXPECT_NEAR(found, order, within) << frequency << " Hz";
}

// ---- a valve with a spool -------------------------------------------------------------------------------------

TEST(SmoothInputs, exchange_of_level_two_is_of_second_order_while_the_valve_moves) {
  Machine machine = boom();
  for (const double f : {1.0, 5.0}) expect_orders(errors_to_held(machine, Level::two, f, Compared::F), 2, 0.3, f);
}

TEST(SmoothInputs, script_of_lines_is_followed_to_second_order_by_levels_linear_and_two) {
  Machine machine = boom();
  for (const double frequency : {1.0, 5.0}) {
    const std::vector<double> two = errors_to_moving(machine, Level::two, frequency, kLines, Compared::F);
    expect_orders(two, 2, 0.3, frequency);
    EXPECT_LT(two.back(), 30) << frequency;  // N of 36 and 62 kN
    expect_orders(errors_to_moving(machine, Level::linear, frequency, kLines, Compared::F), 2, 0.2, frequency);
    expect_orders(errors_to_moving(machine, Level::two, frequency, kLines, Compared::x), 2, 0.3, frequency);
  }
}

TEST(SmoothInputs, values_held_from_the_begin_of_a_step_are_late_and_make_level_two_first_order) {
  Machine machine = boom();
  for (const double frequency : {1.0, 5.0}) {
    expect_orders(errors_to_moving(machine, Level::two, frequency, kHeld, Compared::F), 1, 0.2, frequency);
  }
}

TEST(SmoothInputs, level_hold_is_of_first_order_all_the_same) {
  Machine machine = boom();
  for (const scene::ScriptInterpolation interpolation : {kLines, kHeld}) {
    expect_orders(errors_to_moving(machine, Level::hold, 5, interpolation, Compared::F), 1.1, 0.3, 5);
  }
}

// ---- a valve that opens at once -------------------------------------------------------------------------------

TEST(SmoothInputs, piston_behind_a_valve_without_spool_is_followed_to_second_order_by_level_two) {
  Machine machine = crane();
  for (const double frequency : {1.0, 5.0}) {
    const std::vector<double> errors = errors_to_moving(machine, Level::two, frequency, kLines, Compared::x);
    expect_orders(errors, 2, 0.3, frequency);
    EXPECT_LT(errors.back(), 1e-6) << frequency;  // m of 9.4 and 1.9 mm; F_dot under the signal that was: 2e-5
  }
}

TEST(SmoothInputs, exchange_of_level_two_is_of_second_order_without_a_spool_too) {
  Machine machine = crane();
  const std::vector<double> errors = errors_to_held(machine, Level::two, 5, Compared::F);
  expect_orders(errors, 2, 0.3, 5);
  EXPECT_LT(errors.back(), 2);  // N of 6.6 kN; F_dot under the signal that was: 13
}

}  // namespace smooth_inputs_test
}  // namespace slew::coupling::test
