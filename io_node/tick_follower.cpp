// SPDX-License-Identifier: Apache-2.0
#include "io_node/tick_follower.h"

#include <algorithm>
#include <utility>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "io_node/session_inputs.h"

namespace slew::io_node {

TickFollower::TickFollower(const IoConfig& config)
    : config_(config),
      parameters_(config.parameters, config.session.step_duration()),
      controls_(config.channels.size()),
      before_(controls_.size()) {
  static_cast<void>(begin(nullptr));
}

Status TickFollower::begin(const node::Checkpoint* own) {
  parameters_.reset();
  InputGate gate(config_.channels, config_.gate(), config_.session.step_duration());
  Status status = Status::ok();
  if (own != nullptr) {
    StateReader bytes(own->bytes, state_format(config_));
    gate.load(bytes, own->step);
    parameters_.load(bytes);
    if (!bytes.is_sound()) status = bytes.finish("io");
  }
  for (std::size_t i = 0; i < controls_.size(); ++i) controls_[i] = before_[i] = gate.control(i);
  return status;
}

void TickFollower::take(const wire::Tick& tick) {
  for (const wire::Command& command : tick.commands) parameters_.begin(command, tick.header.step);
  parameters_.advance(tick.header.step);
  std::swap(controls_, before_);
  for (std::size_t i = 0; i < controls_.size() && i < tick.controls.size(); ++i) controls_[i] = tick.controls[i];
}

node::Checkpoint TickFollower::state(StepIndex step) const {
  node::Checkpoint checkpoint;
  checkpoint.step = step;
  StateHash hash;
  hash.add(step);
  StateWriter bytes(checkpoint.bytes, state_format(config_));
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double scale = config_.channels[i].scale, neutral = config_.channels[i].neutral;
    const double raw = scale == 0 ? neutral : controls_[i] / scale;
    const double before = scale == 0 ? neutral : before_[i] / scale;
    const double ramped = std::clamp(raw + 0.5 * (raw - before), -1.0, 1.0);
    for (const double value : {raw, ramped, controls_[i]}) {
      bytes.number(value);
      hash.add(value);
    }
  }
  parameters_.save(bytes);
  bytes.number(std::uint64_t{0});  // no changes wait
  bytes.finish();
  checkpoint.state_hash = hash.digest();
  return checkpoint;
}

}  // namespace slew::io_node
