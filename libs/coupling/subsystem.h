// SPDX-License-Identifier: Apache-2.0
// A physics subsystem: a node steps it, hashes and records its state, and changes its parameters. One implementation
// per physics role.
//
// Life cycle: built from a scene -> first_sample() -> start() -> step(), step(), ... ; reset() returns to the state
// before first_sample(). From start() on, no function allocates, locks or throws. A saved run continues with load() in
// place of first_sample() and start().
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "core/status.h"
#include "core/step_report.h"
#include "core/time.h"
#include "coupling/level.h"
#include "coupling/samples.h"

namespace slew::coupling {

// The partners' samples of one step, or the newest available; null if the scene has no such partner. An age is the
// number of steps since the sample's step. A repeated sample is ignored. A late sample corrects the partner model at
// the step it belongs to (docs/models/coupling_late_samples.md).
struct PartnerSamples {
  const MechanismSample* mechanism = nullptr;
  const ActuatorSample* actuators = nullptr;
  const FlexibleSample* flexible = nullptr;
  const ElasticSample* elastic = nullptr;
  const PoseSample* poses = nullptr;
  StepIndex mechanism_age = 0;
  StepIndex actuators_age = 0;
};

// The sample that this subsystem publishes; the samples of other subsystems stay empty.
struct OwnSample {
  MechanismSample mechanism;
  ActuatorSample actuators;
  FlexibleSample flexible;
  ElasticSample elastic;
  PoseSample poses;
  SensorSample sensors;
};

// A parameter change of a tick: the value is reached after `over`, linearly, beginning with this step.
struct ParameterChange {
  std::string_view path;  // "Bag.mass"
  double value = 0;       // SI
  SimDuration over;
};

class Subsystem {
 public:
  virtual ~Subsystem() = default;

  // Sample 'INIT', available before the partner has started; false if this subsystem needs the partner's first.
  [[nodiscard]] virtual bool first_sample(OwnSample& sample) noexcept = 0;

  // Start state, from the partners' INIT (or sample 0 when they started first); then own sample 0.
  // Error: no start state exists, with the reason.
  virtual Status start(const PartnerSamples& partners, OwnSample& sample) = 0;

  // Advances from t_n to t_{n+1} and gives sample n+1. controls: values of the input channels, by channel index.
  // After a non-finite state the sample stays the last good one and every further report has the flag.
  virtual StepReport step(StepIndex n, const PartnerSamples& partners, std::span<const double> controls,
                          OwnSample& sample) noexcept = 0;

  // True if the parameter belongs to this subsystem; the change has then begun and is part of the hash.
  virtual bool change_parameter(StepIndex n, const ParameterChange& change) noexcept = 0;

  // Back to the state before first_sample(), parameters as the scene gives them.
  virtual void reset() = 0;

  // Hash of the raw bits of all state that influences the future.
  [[nodiscard]] virtual std::uint64_t state_hash() const noexcept = 0;

  // Ok if the whole state can be saved and loaded. Error (bad_input): the reason, with the key of the scene.
  [[nodiscard]] virtual Status can_save() const = 0;
  // Appends the state at t_n, after step n-1 and its sample: all data that later samples, reports, hashes, variables
  // and failures depend on, as raw bits of this architecture (core/state_bytes.h). Appends no bytes if can_save()
  // refuses. No allocation if `state` has the capacity. The caller compares state_hash() after load() with its value at
  // save().
  virtual void save(std::vector<std::byte>& state) const = 0;
  // Replaces first_sample() and start(), at any time: restores the state from save() of a subsystem of the same scene,
  // and gives sample n again. Error (bad_input): the bytes are cut, damaged or of another scene, or can_save() refuses;
  // the subsystem is then as after reset(). Accepts any bytes. A scene that differs in numbers alone (a mass, a
  // tolerance) is not detected; the caller compares those. Allocates.
  virtual Status load(std::span<const std::byte> state, OwnSample& sample) = 0;

  [[nodiscard]] virtual Level level() const noexcept = 0;

  // Variables in a fixed order; values of the last published instant.
  [[nodiscard]] virtual std::span<const ElementVariable> variables() const noexcept = 0;
  virtual void read_variables(std::span<double> values) const noexcept = 0;

  // Name of the state or volume of a StepReport's offender index.
  [[nodiscard]] virtual std::string_view offender_name(std::int32_t index) const noexcept = 0;

  // The subsystem that computes the physics: this one, or the one that this one adds variables to.
  [[nodiscard]] virtual const Subsystem& physics() const noexcept { return *this; }

  // Reason of a failed step, beyond the name of the state that is not finite; may be empty.
  [[nodiscard]] virtual std::string_view failure_text() const noexcept { return {}; }
};

}  // namespace slew::coupling
