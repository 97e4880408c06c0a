// SPDX-License-Identifier: Apache-2.0
// A motor between two volumes or tanks, with the inertia of its load at the shaft, for tests.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {

class MotorRig {
 public:
  HydraulicsDef def;

  HydraulicMotorDef& add_motor() {
    HydraulicMotorDef& motor = add<HydraulicMotorDef>(def, "Motor");
    motor.force = "Force", motor.port_a = "A", motor.port_b = "B", motor.displacement = 10e-6;
    return motor;
  }
  void start(double v, double F) {
    Problems errors, warnings;
    validate(def, errors, warnings);
    ASSERT_TRUE(errors.empty()) << errors.front().path << ": " << errors.front().what;
    circuit_ = std::make_unique<Circuit>(def);
    integrator_ = std::make_unique<CircuitIntegrator>(*circuit_, def);
    integrator_->start(std::array{0.0}, std::array{v}, std::array{F});
  }
  void run(double seconds, const PistonMotion& load, double H = 1e-3) {
    for (int k = 0; k < std::lround(seconds / H); ++k) ASSERT_FALSE(integrator_->step(H, load).has_failed());
  }
  // An exchange that leaves the shaft at x with the speed v.
  void align(double x, double v) {
    integrator_->align(std::array{x}, std::array{v});
    integrator_->refresh();
  }
  double variable(const std::string& name) {
    std::vector<double> values(circuit_->variables().size());
    circuit_->read_variables(integrator_->state().data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit_->variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << "no variable " << name;
    return 0;
  }
  void set_signal(double signal) { circuit_->set_control(0, signal); }
  void set(const std::string& path, double value) {
    ASSERT_EQ(circuit_->set_parameter(circuit_->find_parameter(path), value), ParameterResult::ok) << path;
  }
  [[nodiscard]] const ActuatorLinearisation& shaft() const { return integrator_->actuators()[0]; }

 private:
  std::unique_ptr<Circuit> circuit_;
  std::unique_ptr<CircuitIntegrator> integrator_;
};

}  // namespace slew::hydraulics::test
