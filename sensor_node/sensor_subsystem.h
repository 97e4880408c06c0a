// SPDX-License-Identifier: Apache-2.0
// The sensors of a scene as a Subsystem: a follower that reads the poses of the mechanics and publishes events and
// variables (docs/models/sensors.md). No force follows from it.
//
// FCL allocates: step() is not real-time safe, and no step of the physics waits for it.
#pragma once

#include <memory>
#include <vector>

#include "coupling/port_levels.h"
#include "coupling/subsystem.h"
#include "scene/scene.h"
#include "sensors/sensors.h"

namespace slew::sensor_node {

class SensorSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene with sensors.
  explicit SensorSubsystem(const scene::Scene& scene);

  // False: sensors need the mechanics' sample.
  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] Status can_save() const override { return Status::ok(); }
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return levels_.lowest(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return sensors_.variables(); }
  void read_variables(std::span<double> values) const noexcept override { sensors_.read_variables(values); }
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;

 private:
  // False: a search failed, or the poses are not those of this scene.
  bool observe(const coupling::PoseSample& poses, coupling::OwnSample& sample);

  coupling::PortLevels levels_;  // the session's levels; this node has no port of its own
  sensors::SensorsDef def_;
  sensors::Sensors sensors_;
  std::vector<sensors::FrameMotion> frames_;
  coupling::SensorSample published_;
  std::uint64_t saved_model_ = 0;  // digest of the model of saved states
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_sensor_subsystem(const scene::Scene& scene);

}  // namespace slew::sensor_node
