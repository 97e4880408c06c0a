// SPDX-License-Identifier: Apache-2.0
// The mechanics of a scene without hydraulics, stepped by hand inside a test.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "build_paths.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/scene.h"

namespace slew::testing {

class MechanicsAlone {
 public:
  // file: relative to the source tree.
  explicit MechanicsAlone(const std::string& file, const std::vector<std::string>& overrides = {})
      : MechanicsAlone(scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/" + file, overrides)) {}
  explicit MechanicsAlone(scene::Scene loaded) : scene(std::move(loaded)), subsystem(scene) { start(); }

  void start() {
    static_cast<void>(subsystem.first_sample(sample));
    EXPECT_TRUE(subsystem.start({}, sample).is_ok());
    n = 0;
  }
  void step() noexcept { report = subsystem.step(n++, {}, {}, sample); }

  // steps up to a time [s]
  void run_to(double time) {
    const double H = scene.session.step_duration().seconds();
    while (static_cast<double>(n) * H < time - 1e-9) step();
  }

  [[nodiscard]] double value(const std::string& variable) const {
    std::vector<double> values(subsystem.variables().size());
    subsystem.read_variables(values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (subsystem.variables()[i].name == variable) return values[i];
    }
    ADD_FAILURE() << "no variable " << variable;
    return 0;
  }

  scene::Scene scene;
  mechanics_node::MechanicsSubsystem subsystem;
  coupling::OwnSample sample;
  StepReport report;
  StepIndex n = 0;
};

}  // namespace slew::testing
