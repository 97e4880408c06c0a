// SPDX-License-Identifier: Apache-2.0
// The mechanism of a scene as a Subsystem: life cycle, inputs, parameters, published sample, hash and saved state.
//
// A step advances the mechanism (mechanism.h) by sub-steps of the port problem (port_problem.h) under the partner's
// linearisation (partner_force.h) and publishes the ports' motion with their mobility (published_mobility.h). Where
// another integrator computes the motion, follow() takes its states and publishes the same.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coupling/parameter_ramps.h"
#include "coupling/subsystem.h"
#include "mechanics_node/divergence.h"
#include "mechanics_node/mechanics_variables.h"
#include "mechanics_node/mechanism.h"
#include "mechanics_node/modal_exchange.h"
#include "mechanics_node/partner_force.h"
#include "mechanics_node/payload.h"
#include "mechanics_node/port_problem.h"
#include "mechanics_node/published_mobility.h"
#include "mechanics_node/row_mobility.h"
#include "multibody/model/parameters.h"
#include "scene/scene.h"

namespace slew::mechanics_node {

// What integrates the motion: step() of this subsystem, or another integrator whose states follow() takes. A followed
// motion is shown in joint coordinates, whatever the scene's formulation.
enum class Motion : std::uint8_t { integrated, followed };

// The end of a step that another integrator computed; forces, and work and impulse over the step, by port.
struct FollowedStep {
  const multibody::State& state;
  std::span<const double> F, work, impulse;  // N, J, N s
};

class MechanicsSubsystem final : public coupling::Subsystem {
 public:
  // Pre-condition: a validated scene with bodies.
  explicit MechanicsSubsystem(const scene::Scene& scene, Motion motion = Motion::integrated);

  [[nodiscard]] bool first_sample(coupling::OwnSample& sample) noexcept override;
  Status start(const coupling::PartnerSamples& partners, coupling::OwnSample& sample) override;
  StepReport step(StepIndex n, const coupling::PartnerSamples& partners, std::span<const double> controls,
                  coupling::OwnSample& sample) noexcept override;
  // In the place of step(): applies parameters and signals of this step, then publishes the step's end.
  StepReport follow(StepIndex n, const FollowedStep& step, std::span<const double> controls,
                    coupling::OwnSample& sample) noexcept;
  bool change_parameter(StepIndex n, const coupling::ParameterChange& change) noexcept override;
  void reset() override;
  [[nodiscard]] std::uint64_t state_hash() const noexcept override;
  [[nodiscard]] Status can_save() const override;
  void save(std::vector<std::byte>& state) const override;
  Status load(std::span<const std::byte> state, coupling::OwnSample& sample) override;
  [[nodiscard]] coupling::Level level() const noexcept override { return partner_.levels().lowest(); }
  [[nodiscard]] std::span<const ElementVariable> variables() const noexcept override { return variables_.list(); }
  void read_variables(std::span<double> values) const noexcept override;
  [[nodiscard]] std::string_view offender_name(std::int32_t index) const noexcept override;
  [[nodiscard]] std::string_view failure_text() const noexcept override { return divergence_.text(); }

  [[nodiscard]] const multibody::Model& model() const noexcept { return mechanism_.model(); }
  [[nodiscard]] const multibody::State& state() const noexcept { return mechanism_.state(); }
  [[nodiscard]] const multibody::Dynamics& mechanism() const noexcept { return mechanism_.dynamics(); }
  // For tests; not between samples.
  [[nodiscard]] multibody::State& mutable_state() noexcept { return mechanism_.state_as_evaluated(); }

 private:
  // A multibody parameter as one number, the handle of the ramps.
  [[nodiscard]] static int handle_of(multibody::Parameter parameter) noexcept {
    return (static_cast<int>(parameter.kind) << 24) | (parameter.element << 8) | parameter.member;
  }
  [[nodiscard]] static multibody::Parameter parameter_of(int handle) noexcept {
    return {static_cast<multibody::ParameterKind>(handle >> 24), (handle >> 8) & 0xffff, handle & 0xff};
  }
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void show_loaded() noexcept;
  [[nodiscard]] double exchange_interval() const noexcept {
    return H_.seconds() * static_cast<double>(exchange_every_);
  }
  void apply_ramps(StepIndex n) noexcept;
  void apply_signals(std::span<const double> controls) noexcept;
  void take_elastic_forces(const coupling::ElasticSample* sample, StepReport& report) noexcept;
  void receive_forces(StepIndex n, const coupling::PartnerSamples& partners, StepReport& report) noexcept;
  void publish(coupling::OwnSample& sample) noexcept;
  // Ends a step whose sub-steps, of h [s], began with these strokes: publishes, or ends the run.
  StepReport finish_step(const coupling::PortArray& strokes_before, double h, const StepReport& report,
                         coupling::OwnSample& sample) noexcept;
  void raise_flags(StepReport& report) const noexcept;
  // The run ends with this report: everything returns to the last good state.
  StepReport end_with(const StepReport& report, coupling::OwnSample& sample) noexcept;

  SimDuration H_;
  StepIndex exchange_every_;
  Mechanism mechanism_;
  int substeps_;
  PartnerForce partner_;
  RowMobility row_mobility_;
  PortProblem port_problem_;
  PublishedMobility published_mobility_;
  ModalExchange modal_;
  std::vector<int> sensed_bodies_;  // of the model, in the order of PoseSample
  coupling::ParameterRamps ramps_;
  DivergenceWatch divergence_;
  const std::unique_ptr<MechanicsVariables::Work> observing_;  // what read_variables() computes in
  MechanicsVariables variables_;
  multibody::State last_good_;
  std::vector<double> row_force_;  // by row, at the published instant, on the row's own coordinate
  coupling::OwnSample published_;
  bool has_failed_ = false;
  StepReport failure_;
  std::uint64_t saved_model_;  // identifies the scenes whose saved states fit
};

[[nodiscard]] std::unique_ptr<coupling::Subsystem> make_mechanics_subsystem(const scene::Scene& scene);

}  // namespace slew::mechanics_node
