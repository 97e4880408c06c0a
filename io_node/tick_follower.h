// What io_node's own state has become after the ticks of a recording, so that a session can go on behind them.
//
// The live parameters are those of io_node to the bit. Of the channels the ticks tell the control value alone, the mean
// over a step: the raw value is taken as control / scale, and where the ramp stood at the end of the step as if the
// last change went on for half a step. In a ramp and at rest that is so, to the last bits; where one of them ends
// within the last step, it is off by a third of what the ramp does in a step at most.
#pragma once

#include <vector>

#include "io_node/io_node.h"
#include "io_node/live_parameters.h"
#include "node/checkpoint.h"

namespace slew::io_node {

class TickFollower {
 public:
  explicit TickFollower(const IoConfig& config);

  // At the begin of an epoch: as the scene has it, or as io_node was. Error (bad_input): the state is of another scene.
  [[nodiscard]] Status begin(const node::Checkpoint* own);
  // The ticks of all steps in order.
  void take(const wire::Tick& tick);
  // The state before the tick of this step.
  [[nodiscard]] node::Checkpoint state(StepIndex step) const;

 private:
  const IoConfig& config_;
  LiveParameters parameters_;
  std::vector<double> controls_, before_;  // of the last two ticks
};

}  // namespace slew::io_node
