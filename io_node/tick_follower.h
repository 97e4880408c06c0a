// SPDX-License-Identifier: Apache-2.0
// State of io_node after the ticks of a recording, so that a session can continue behind them.
//
// The live parameters are those of io_node to the bit. A tick carries the control value of a channel alone, the mean
// over a step: the raw value is control / scale, and the ramp at the end of the step continues the last change for half
// a step. That is exact to the last bits in a ramp and at rest; where one of them ends within the last step, the error
// is at most a third of the ramp's change in a step.
#pragma once

#include <vector>

#include "io_node/io_config.h"
#include "io_node/live_parameters.h"
#include "node/checkpoint.h"

namespace slew::io_node {

class TickFollower {
 public:
  explicit TickFollower(const IoConfig& config);

  // The begin of an epoch: the scene's state, or a state of io_node. Error (bad_input): the state of another scene.
  [[nodiscard]] Status begin(const node::Checkpoint* own);
  // The ticks of all steps in order.
  void take(const wire::Tick& tick);
  // The state before the tick of this step.
  [[nodiscard]] node::Checkpoint state(StepIndex step) const;

 private:
  const IoConfig& config_;
  LiveParameters parameters_;
  std::vector<double> controls_, before_;  // control values of the last two ticks
};

}  // namespace slew::io_node
