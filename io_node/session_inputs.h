// SPDX-License-Identifier: Apache-2.0
// The inputs of each tick, which are io_node's own state: control values of the channels, and changes of live
// parameters.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/status.h"
#include "io_node/io_config.h"
#include "node/checkpoint.h"

namespace slew::io_node {

class SessionInputs {
 public:
  using SeeWriter = std::function<transport::WriterSight(std::uint64_t writer)>;

  // sources: those of the configuration. see_writer: as GateConfig.
  SessionInputs(const IoConfig& config, std::vector<std::unique_ptr<InputSource>> sources, SeeWriter see_writer = {});

  [[nodiscard]] InputGate& gate() noexcept { return gate_; }
  [[nodiscard]] const InputGate& gate() const noexcept { return gate_; }
  [[nodiscard]] const LiveParameters& parameters() const noexcept { return parameters_; }

  // A change for the next tick, or a later one if that is full.
  void add_change(wire::Command change) { waiting_.push_back(std::move(change)); }
  // Values of the parameters from step n on with one more change, which the tick of step n is to carry.
  [[nodiscard]] LiveCourse course_with(const wire::Command& change, StepIndex n) const;
  // Changes that no tick has carried yet.
  [[nodiscard]] std::span<const wire::Command> waiting() const noexcept { return waiting_; }

  // Control values, parameter values and changes of the tick of step n.
  void advance(StepIndex n, std::int64_t now_ns, std::vector<wire::Command>& changes);

  // As at step 0 of the scene, without holders of channels.
  void reset();
  [[nodiscard]] std::uint64_t state_hash(StepIndex step) const;
  void save(StepIndex step, node::Checkpoint& checkpoint) const;
  // Error (bad_input): the state is damaged, or belongs to other channels or parameters.
  [[nodiscard]] Status check(const node::Checkpoint& checkpoint) const;
  // As check(); on an error nothing has changed.
  [[nodiscard]] Status load(const node::Checkpoint& checkpoint);

 private:
  [[nodiscard]] Status read(const node::Checkpoint& checkpoint, InputGate& gate, LiveParameters& parameters,
                            std::vector<wire::Command>& waiting) const;

  SimDuration step_;
  StateFormat format_;
  InputGate gate_;
  LiveParameters parameters_;
  InputSources sources_;
  std::vector<TimedChange> changes_;
  std::vector<wire::Command> waiting_;
};

// Format of the state: it belongs to these channels and parameters.
[[nodiscard]] StateFormat state_format(const IoConfig& config);

}  // namespace slew::io_node
