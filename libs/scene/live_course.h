// SPDX-License-Identifier: Apache-2.0
// Values that live parameters take in a session, change after change, and the first rule between the fields of a
// hydraulic component that they break.
//
// Rules compare fields of one component with one another, and ramps are straight: a rule that holds at the begin and at
// the end of each change, and before a change that replaces a ramp under way, holds between them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/problem.h"
#include "core/time.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::scene {

struct LiveChange {
  std::string path;  // "Bag.mass"
  double value = 0;  // SI
  StepIndex step = 0;
  StepIndex steps = 1;  // over which it is spread
};

struct BrokenRule {
  Problem problem;
  StepIndex step = 0;
  std::size_t change = 0;  // the last one of the component
};

// circuit: validated. present: values before the first change, by path; those of the circuit where none is given.
// changes: in order of steps; those of one step count together. Paths of other elements are passed over.
[[nodiscard]] std::optional<BrokenRule> find_broken_rule(const hydraulics::HydraulicsDef& circuit,
                                                         std::span<const std::pair<std::string, double>> present,
                                                         std::span<const LiveChange> changes);

}  // namespace slew::scene
