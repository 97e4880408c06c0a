// SPDX-License-Identifier: Apache-2.0
// Both physics subsystems of a scene stepped by hand inside a test: an independent exchange of samples, with which
// sessions are compared.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"
#include "scene/scene.h"

namespace slew::testing {

class CranePair {
 public:
  explicit CranePair(const scene::Scene& scene)
      : mechanics(std::make_unique<mechanics_node::MechanicsSubsystem>(scene)),
        hydraulics(std::make_unique<hydraulics_node::HydraulicsSubsystem>(scene)) {}

  // Hash of the mechanics at INIT.
  std::uint64_t start() {
    coupling::OwnSample init;
    static_cast<void>(mechanics->first_sample(init));
    const std::uint64_t init_hash = mechanics->state_hash();
    require(hydraulics->start({&init.mechanism, nullptr}, hydraulics_now));
    require(mechanics->start({nullptr, &hydraulics_now.actuators}, mechanics_now));
    n = 0;
    return init_hash;
  }

  // one communication step with these control values; no allocation
  void step(std::span<const double> controls) noexcept {
    mechanics->step(n, {nullptr, &hydraulics_now.actuators}, controls, mechanics_next_);
    hydraulics->step(n, {&mechanics_now.mechanism, nullptr}, controls, hydraulics_next_);
    std::swap(mechanics_now, mechanics_next_);
    std::swap(hydraulics_now, hydraulics_next_);
    ++n;
  }

  // levers that move all three cylinders to and fro: valves, friction and shuttles change their states
  [[nodiscard]] static std::array<double, 3> levers(StepIndex step) noexcept {
    const auto wave = [step](StepIndex period) { return (step / period) % 2 == 0 ? 420.0 : -420.0; };
    return {wave(310), wave(450), wave(270)};
  }

  // overrides: "mechanics.formulation=lagrange", ...
  static scene::Scene load(const std::vector<std::string>& overrides = {}) {
    return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml", overrides);
  }

  std::unique_ptr<mechanics_node::MechanicsSubsystem> mechanics;
  std::unique_ptr<hydraulics_node::HydraulicsSubsystem> hydraulics;
  coupling::OwnSample mechanics_now, hydraulics_now;  // samples at t_n
  StepIndex n = 0;

 private:
  static void require(const Status& status) {
    if (!status.is_ok()) throw std::runtime_error(status.text);
  }
  coupling::OwnSample mechanics_next_, hydraulics_next_;
};

}  // namespace slew::testing
