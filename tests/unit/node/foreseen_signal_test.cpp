// SPDX-License-Identifier: Apache-2.0
// F_dot of the hydraulics' sample holds under the signal that the coming step is expected to have
// (docs/models/coupling_levels.md, "An input that moves within a step"): the crane with two degrees of freedom, whose
// valve opens at once.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "math/relaxing_spring.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/scene.h"

namespace slew::testing {
namespace foreseen_signal_test {

scene::Scene load() {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/two_dof_crane.yaml");
}

// The circuit behind a mechanism that stays where it started.
class Circuit {
 public:
  explicit Circuit(const scene::Scene& scene) : hydraulics(scene) {
    mechanics_node::MechanicsSubsystem mechanics(scene);
    static_cast<void>(mechanics.first_sample(mechanism_));
    EXPECT_TRUE(hydraulics.start({&mechanism_.mechanism, nullptr}, sample).is_ok());
  }
  void step(double signal) {
    EXPECT_EQ(hydraulics.step(n++, {&mechanism_.mechanism, nullptr}, std::vector<double>{signal}, sample).flags, 0u);
  }
  [[nodiscard]] double F_dot() const { return sample.actuators.F_dot[0]; }
  // under the signal of the last step
  [[nodiscard]] double F_dot_as_it_was() {
    hydraulics.integrator().refresh();
    return math::one_for_all(hydraulics.integrator().actuators()[0].springs, 1e-3).F_dot;
  }
  [[nodiscard]] double variable(const std::string& name) const {
    std::vector<double> values(hydraulics.variables().size());
    hydraulics.read_variables(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (hydraulics.variables()[i].name == name) return values[i];
    }
    return std::nan("");
  }

  hydraulics_node::HydraulicsSubsystem hydraulics;
  coupling::OwnSample sample;

  StepIndex n = 0;

 private:
  coupling::OwnSample mechanism_;
};

TEST(ForeseenSignal, OfARampAddsWhatTheValveDoesToTheForcesRate) {
  const scene::Scene scene = load();
  Circuit circuit(scene);
  constexpr double kChange = 1e-4;
  for (int i = 1; i <= 3; ++i) circuit.step(i * kChange);
  const double found = (circuit.F_dot() - circuit.F_dot_as_it_was()) / kChange;
  // by hand: edges of 5e-4 m2 that open by a tenth of the signal, 65 cm2 on both sides, 442 mm between the ends
  const double p_A = circuit.sample.actuators.p_A[0], p_B = circuit.sample.actuators.p_B[0], p_P = 76e5, p_T = 1e5;
  const double k = 0.1 * 0.67 * 5e-4 * std::sqrt(2 / 850.0), A = 65e-4, x = circuit.sample.actuators.x_ref[0];
  const double C_A = A * x / circuit.variable("Vol_A.effective_bulk_modulus");
  const double C_B = A * (0.442 - x) / circuit.variable("Vol_B.effective_bulk_modulus");
  const double dQ_A = k * (std::sqrt(p_P - p_A) + std::sqrt(p_A - p_T));
  const double dQ_B = -k * (std::sqrt(p_P - p_B) + std::sqrt(p_B - p_T));
  const double G = A * (dQ_A / C_A - dQ_B / C_B);
  EXPECT_NEAR(G, 8.8e7, 1e6);  // N/s
  EXPECT_NEAR(found / G, 1, 1e-4);
}

TEST(ForeseenSignal, OfAJumpATurnAndASignalAtRestIsTheSignalThatWas) {
  const scene::Scene scene = load();
  for (const std::vector<double>& signals : std::vector<std::vector<double>>{
           {0, 0, 0}, {0, 0, 0.1}, {0, 0.1, 0.1}, {0, 0.1, 0.05}, {0.1, -0.1, 0.1, -0.1}}) {
    Circuit circuit(scene);
    for (const double signal : signals) circuit.step(signal);
    const double F_dot = circuit.F_dot();
    EXPECT_EQ(F_dot, circuit.F_dot_as_it_was()) << signals.back();
  }
  // twice the change before at most, with G as above
  Circuit jump(scene);
  for (const double signal : {0.01, 0.11}) jump.step(signal);
  EXPECT_NEAR(jump.F_dot() - jump.F_dot_as_it_was(), 8.8e7 * 0.02, 0.02 * 8.8e7 * 0.02);
}

TEST(ForeseenSignal, IsPartOfTheSavedState) {
  const scene::Scene scene = load();
  Circuit first(scene), second(scene);
  for (int i = 0; i < 20; ++i) first.step(0.1 * std::sin(0.1 * i));
  std::vector<std::byte> state;
  first.hydraulics.save(state);
  ASSERT_TRUE(second.hydraulics.load(state, second.sample).is_ok());
  EXPECT_EQ(second.hydraulics.state_hash(), first.hydraulics.state_hash());
  second.n = first.n;
  for (int i = 20; i < 40; ++i) {
    first.step(0.1 * std::sin(0.1 * i));
    second.step(0.1 * std::sin(0.1 * i));
    EXPECT_EQ(second.sample.actuators, first.sample.actuators) << i;
    EXPECT_EQ(second.hydraulics.state_hash(), first.hydraulics.state_hash()) << i;
  }
}

}  // namespace foreseen_signal_test
}  // namespace slew::testing
