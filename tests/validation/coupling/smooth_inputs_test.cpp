// A valve whose signal moves all the time, as a script of straight lines through the scene's input, against the
// monolith under the same lines (docs/models/coupling_levels.md, "An input that moves within a step"). Two machines: the
// boom on one cylinder with friction, whose valve has a spool with states, and the crane with two degrees of freedom,
// whose valve opens at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
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
constexpr std::int64_t kPieceNs = 250'000;  // of the signal that moves
constexpr double kOpening = 0.2;            // s, from neutral: no jump at the start

void require_ok(const Status& status) {
  if (!status.is_ok()) throw std::runtime_error(status.text);
}

struct Machine {
  scene::Scene scene;
  double mean, swing;  // of the raw value

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

// F on the grid, of a signal that is straight over each piece or held from its beginning
enum class Signal { moves, is_held };
std::vector<double> reference_forces(const Machine& machine, double frequency, std::int64_t piece_ns, Signal kind) {
  monolith::Monolith reference(machine.scene, {});
  require_ok(reference.start());
  const double scale = machine.scene.inputs[0].scale;
  std::vector<double> F;
  for (std::int64_t t = 0; t < kDuration.ns; t += piece_ns) {
    const std::vector<double> begin{scale * machine.raw(frequency, SimTime{t}.seconds())};
    const std::vector<double> end{scale * machine.raw(frequency, SimTime{t + piece_ns}.seconds())};
    require_ok(reference.advance_to({t + piece_ns}, begin, kind == Signal::moves ? end : begin));
    if ((t + piece_ns) % kGrid.ns == 0) F.push_back(reference.ports()[0].F);
  }
  return F;
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

// Largest difference on the grid [N].
double force_error(Machine& machine, double H, Level level, const std::vector<double>& reference) {
  machine.scene.session.step = H;
  machine.scene.session.coupling = level;
  const SimDuration step = machine.scene.session.step_duration();
  const io::IoConfig config = io::make_config(machine.scene, {.session_name = "s", .recording = io::Recording::none});
  io::InputGate gate(config.channels, config.gate, step);
  std::vector<SignalCourse> script(gate.size());
  CoupledRun run(machine.scene);
  require_ok(run.start());
  double error = 0;
  StepIndex n = 0;
  for (std::size_t k = 0; k < reference.size(); ++n) {
    config.source->courses(run.time(), run.time() + step, script);
    gate.advance(n, script, 0);
    run.step(std::vector<double>{gate.control(0)});
    if (run.has_failed()) throw std::runtime_error("the coupled run failed");
    if (run.time().ns % kGrid.ns == 0) error = std::max(error, std::fabs(run.actuators().F[0] - reference[k++]));
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
                                     scene::ScriptInterpolation interpolation) {
  const std::vector<double> moving = reference_forces(machine, frequency, kPieceNs, Signal::moves);
  set_script(machine, frequency, kPieceNs, interpolation);
  std::vector<double> errors;
  for (const double H : kSteps) errors.push_back(force_error(machine, H, level, moving));
  return errors;
}

// both sides of the comparison hold the same values over the same steps
std::vector<double> errors_to_held(Machine& machine, Level level, double frequency) {
  std::vector<double> errors;
  for (const double H : kSteps) {
    const std::int64_t step_ns = duration_of_seconds(H).ns;
    const std::vector<double> held = reference_forces(machine, frequency, step_ns, Signal::is_held);
    set_script(machine, frequency, step_ns, scene::ScriptInterpolation::step);
    errors.push_back(force_error(machine, H, level, held));
  }
  return errors;
}

TEST(SmoothInputs, DISABLED_study) {
  for (const bool is_crane : {false, true}) {
    Machine machine = is_crane ? crane() : boom();
    for (const double frequency : {1.0, 5.0}) {
      const std::vector<double> reference = reference_forces(machine, frequency, kPieceNs, Signal::moves);
      const auto [low, high] = std::minmax_element(reference.begin(), reference.end());
      std::printf("%s %g Hz range %.4g N\n", is_crane ? "crane" : "boom", frequency, *high - *low);
      for (const Level level : {Level::hold, Level::linear, Level::two, Level::tlm}) {
        for (int kind = 0; kind < 3; ++kind) {
          try {
            const std::vector<double> e =
                kind == 0   ? errors_to_held(machine, level, frequency)
                : kind == 1 ? errors_to_moving(machine, level, frequency, scene::ScriptInterpolation::step)
                            : errors_to_moving(machine, level, frequency, scene::ScriptInterpolation::linear);
            std::printf("  level %d %s: %10.4g %10.4g %10.4g  orders %5.2f %5.2f\n", static_cast<int>(level),
                        kind == 0 ? "held  " : kind == 1 ? "begin " : "mean  ", e[0], e[1], e[2], orders(e)[0],
                        orders(e)[1]);
          } catch (const std::exception& error) {
            std::printf("  level %d %d: %s\n", static_cast<int>(level), kind, error.what());
          }
          std::fflush(stdout);
        }
      }
    }
  }
}

}  // namespace smooth_inputs_test
}  // namespace slew::coupling::test
