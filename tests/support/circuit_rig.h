// SPDX-License-Identifier: Apache-2.0
// A circuit that a test defines, runs at a fixed communication step without a partner, and reads by names.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics/hydraulics_def.h"
#include "hydraulics/piston_motion.h"

namespace slew::hydraulics::test {

class CircuitRig {
 public:
  HydraulicsDef def;  // complete before the first run() or set_signal()

  void run(double seconds, double H = 1e-3) {
    build();
    for (int k = 0; k < std::lround(seconds / H); ++k) {
      ASSERT_FALSE(integrator_->step(H, HeldSpeed(0)).has_failed());
    }
  }
  double variable(const std::string& name) {
    build();
    std::vector<double> values(circuit_->variables().size());
    circuit_->read_variables(integrator_->state().data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit_->variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << name;
    return 0;
  }
  void set(const std::string& path, double value) {
    build();
    ASSERT_EQ(circuit_->set_parameter(circuit_->find_parameter(path), value), ParameterResult::ok) << path;
  }
  void set_signal(const std::string& component, double signal) {
    build();
    circuit_->set_control(circuit_->find_control(component), signal);
  }

 private:
  void build() {
    if (integrator_) return;
    Problems errors, warnings;
    validate(def, errors, warnings);
    for (const Problem& error : errors) ADD_FAILURE() << error.path << ": " << error.what;
    circuit_ = std::make_unique<Circuit>(def);
    integrator_ = std::make_unique<CircuitIntegrator>(*circuit_, def);
    integrator_->start({}, {}, {});
  }

  std::unique_ptr<Circuit> circuit_;
  std::unique_ptr<CircuitIntegrator> integrator_;
};

}  // namespace slew::hydraulics::test
