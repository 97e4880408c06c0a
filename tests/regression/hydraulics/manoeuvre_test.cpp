// SPDX-License-Identifier: Apache-2.0
// A fixed manoeuvre of the crane's circuit with cylinder friction: its cost and its end state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coupling/line_force.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics/curve.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace manoeuvre_test {

// Two strongly coupled booms and a slewing inertia, as seen at the pistons, with friction and end stops.
class ReducedCrane final : public PistonMotion {
 public:
  explicit ReducedCrane(const HydraulicsDef& def, const Circuit& circuit) {
    for (const Actuator& actuator : circuit.actuators()) {
      const LineForceParameters& line = actuator.line_force;
      laws_.emplace_back(coupling::LineForceDef{.friction_curve = straight_lines(*find_curve(def, line.friction_curve)),
                                                .efficiency = line.cylinder_coefficient,
                                                .seal_friction = line.seal_friction,
                                                .stroke_min = line.minimum_stroke,
                                                .stroke_max = line.maximum_stroke,
                                                .stop_stiffness = line.end_stiffness,
                                                .stop_damping = line.end_damping});
    }
  }
  void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept override {
    for (int i = 0; i < 3; ++i) {
      a[i] = 0;
      for (int j = 0; j < 3; ++j) {
        a[i] +=
            kMobility[i][j] * (laws_[static_cast<std::size_t>(j)].evaluate(F[j], x[j], v[j]).force - kCraneForces[j]);
      }
    }
  }
  void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override {
    for (int j = 0; j < 3; ++j) {
      const coupling::LineForce line = laws_[static_cast<std::size_t>(j)].evaluate(F[j], x[j], v[j]);
      for (int i = 0; i < 3; ++i) {
        da_dF[3 * i + j] = kMobility[i][j] * line.d_pressure;
        da_dx[3 * i + j] = kMobility[i][j] * line.d_position;
        da_dv[3 * i + j] = kMobility[i][j] * line.d_speed;
      }
    }
  }

 private:
  static constexpr double kMobility[3][3] = {{1.52e-4, -1.44e-4, 0}, {-1.44e-4, 1.52e-4, 0}, {0, 0, 5.6e-7}};
  std::vector<coupling::LineForceLaw> laws_;
};

struct Outcome {
  double substeps_per_step = 0, rejected_per_step = 0;
  std::uint32_t worst = 0, dense = 0, flags = 0;
  double x[3];
};

// strokes at the end, as first released; friction lets them depend on the tolerance by some micrometres
constexpr double kEnd[] = {0.839989, 0.789751, 0.619174};

// Lift up and down, jib up, slew, over 8 s.
Outcome manoeuvre(double H) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const ReducedCrane crane(def, circuit);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const int lift = circuit.find_control("L90Lift"), jib = circuit.find_control("L90Jib");
  const int slew = circuit.find_control("L90Slew");
  Outcome outcome;
  const int steps = static_cast<int>(std::lround(8 / H));
  for (int k = 0; k < steps; ++k) {
    const double t = k * H;
    const auto ramp = [t](double from, double to) {
      return 500 * std::clamp(std::min((t - from) / 0.5, (to - t) / 0.5), 0.0, 1.0);
    };
    circuit.set_control(lift, ramp(0.2, 2.5) - ramp(5, 6.5));
    circuit.set_control(jib, ramp(1, 3));
    circuit.set_control(slew, ramp(2.8, 4.5));
    outcome.flags |= integrator.step(H, crane).flags;
    const math::StiffReport& report = integrator.last_report();
    outcome.substeps_per_step += static_cast<double>(report.accepted) / steps;
    outcome.rejected_per_step += static_cast<double>(report.rejected) / steps;
    outcome.worst = std::max(outcome.worst, report.accepted + report.rejected);
    outcome.dense += report.dense_factorisations;
  }
  for (std::size_t j = 0; j < 3; ++j) outcome.x[j] = integrator.actuators()[j].x;
  return outcome;
}

TEST(CircuitManoeuvre, takes_about_one_substep_per_millisecond) {
  const Outcome outcome = manoeuvre(1e-3);
  EXPECT_LT(outcome.substeps_per_step, 1.12);
  EXPECT_LT(outcome.rejected_per_step, 0.08);
  EXPECT_LT(outcome.worst, 60u);
  EXPECT_EQ(outcome.dense, 0u);
  EXPECT_EQ(outcome.flags, 0u);
}

TEST(CircuitManoeuvre, ends_where_it_ended_before) {
  const Outcome outcome = manoeuvre(1e-3);
  EXPECT_NEAR(outcome.x[0], kEnd[0], 2e-5);
  EXPECT_NEAR(outcome.x[1], kEnd[1], 2e-5);
  EXPECT_NEAR(outcome.x[2], kEnd[2], 2e-4);
}

TEST(CircuitManoeuvre, gives_the_same_bits_twice) {
  const Outcome first = manoeuvre(1e-3), second = manoeuvre(1e-3);
  for (int j = 0; j < 3; ++j) EXPECT_EQ(first.x[j], second.x[j]);
}

}  // namespace manoeuvre_test
}  // namespace slew::hydraulics::test
