// A valve whose signal moves all the time, 0.5 + 0.3 sin(2 pi f t) of its range, on the boom with one cylinder and
// friction, against the monolith (docs/models/coupling_levels.md, "An input that moves within a step").
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace smooth_inputs_test {

constexpr SimDuration kDuration = milliseconds(992);
constexpr SimDuration kGrid = milliseconds(16);
constexpr std::int64_t kPieceNs = 250'000;  // of the signal that moves
constexpr double kOpening = 0.2;            // s, from neutral: no jump at the start

double signal(const scene::Scene& scene, double frequency, double t) {
  const double opened = t < kOpening ? 0.5 - 0.5 * std::cos(std::numbers::pi * t / kOpening) : 1.0;
  return scene.inputs[0].scale * opened * (0.5 + 0.3 * std::sin(2 * std::numbers::pi * frequency * t));
}

// with the integrators' own errors out of the way
scene::Scene load() {
  return scene::load_file(
      std::string(SLEWRING_SOURCE_DIR) + "/scenes/single_cylinder.yaml",
      {"Cyl_Lift.friction_curve=Spline_CylinderFriction", "Cyl_Lift.cylinder_coefficient=0.9",
       "Cyl_Lift.seal_friction=1 kN", "hydraulics.relative_tolerance=1e-6", "mechanics.max_substep=0.25 ms"});
}

void require_ok(const Status& status) {
  if (!status.is_ok()) throw std::runtime_error(status.text);
}

// F on the grid, of a signal that is straight over each piece or held from its beginning
enum class Signal { moves, is_held };
std::vector<double> reference_forces(const scene::Scene& scene, double frequency, std::int64_t piece_ns, Signal kind) {
  monolith::Monolith reference(scene, {});
  require_ok(reference.start());
  std::vector<double> F;
  for (std::int64_t t = 0; t < kDuration.ns; t += piece_ns) {
    const std::vector<double> begin{signal(scene, frequency, SimTime{t}.seconds())};
    const std::vector<double> end{signal(scene, frequency, SimTime{t + piece_ns}.seconds())};
    require_ok(reference.advance_to({t + piece_ns}, begin, kind == Signal::moves ? end : begin));
    if ((t + piece_ns) % kGrid.ns == 0) F.push_back(reference.ports()[0].F);
  }
  return F;
}

// Largest difference on the grid [N], of a run whose steps get the signal at `share` of their length.
double force_error(scene::Scene& scene, double H, Level level, double frequency, double share,
                   const std::vector<double>& reference) {
  scene.session.step = H;
  scene.session.coupling = level;
  CoupledRun run(scene);
  require_ok(run.start());
  double error = 0;
  for (std::size_t k = 0; k < reference.size();) {
    run.step(std::vector<double>{signal(scene, frequency, run.time().seconds() + share * H)});
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
constexpr double kAtBegin = 0, kInMiddle = 0.5;

std::vector<double> errors_to_moving(Level level, double frequency, double share) {
  scene::Scene scene = load();
  const std::vector<double> moving = reference_forces(scene, frequency, kPieceNs, Signal::moves);
  std::vector<double> errors;
  for (const double H : kSteps) errors.push_back(force_error(scene, H, level, frequency, share, moving));
  return errors;
}

// both sides of the comparison hold the same values over the same steps
std::vector<double> errors_to_held(Level level, double frequency) {
  scene::Scene scene = load();
  std::vector<double> errors;
  for (const double H : kSteps) {
    const std::vector<double> held = reference_forces(scene, frequency, duration_of_seconds(H).ns, Signal::is_held);
    errors.push_back(force_error(scene, H, level, frequency, kAtBegin, held));
  }
  return errors;
}

TEST(SmoothInputs, exchange_of_level_two_is_of_second_order_while_the_valve_moves) {
  for (const double frequency : {1.0, 5.0}) {
    for (const double order : orders(errors_to_held(Level::two, frequency))) EXPECT_NEAR(order, 2, 0.3) << frequency;
  }
}

TEST(SmoothInputs, value_held_from_the_begin_of_a_step_makes_level_two_first_order) {
  for (const double frequency : {1.0, 5.0}) {
    for (const double order : orders(errors_to_moving(Level::two, frequency, kAtBegin))) {
      EXPECT_NEAR(order, 1, 0.2) << frequency;
    }
  }
}

TEST(SmoothInputs, value_of_the_steps_middle_keeps_the_second_order_of_level_two) {
  for (const double frequency : {1.0, 5.0}) {
    const std::vector<double> errors = errors_to_moving(Level::two, frequency, kInMiddle);
    for (const double order : orders(errors)) EXPECT_NEAR(order, 2, 0.3) << frequency;
    EXPECT_LT(errors.back(), 30) << frequency;  // N of 36 and 62 kN
  }
}

TEST(SmoothInputs, level_hold_is_of_first_order_whichever_value_it_gets) {
  for (const double share : {kAtBegin, kInMiddle}) {
    for (const double order : orders(errors_to_moving(Level::hold, 5, share))) {
      EXPECT_GT(order, 0.8) << share;
      EXPECT_LT(order, 1.4) << share;
    }
  }
}

}  // namespace smooth_inputs_test
}  // namespace slew::coupling::test
