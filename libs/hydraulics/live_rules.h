// SPDX-License-Identifier: Apache-2.0
// Rules between the fields of components, for values that change while a session runs: what validate() refuses at load,
// no change may bring about.
//
// An engine that its friction stalls is no broken rule here: a fault that a session may want.
#pragma once

#include <optional>
#include <string_view>

#include "core/problem.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// The same circuit with components of its own.
[[nodiscard]] HydraulicsDef copy_of(const HydraulicsDef& circuit);

class LiveRules {
 public:
  // circuit: validated. Not used after construction.
  explicit LiveRules(const HydraulicsDef& circuit) : circuit_(copy_of(circuit)) {}

  // Number of a component's field, by "Valve.cut_in_pressure"; null: the path names none. Valid as long as this.
  [[nodiscard]] double* find(std::string_view path);
  // First rule that the component of the path breaks.
  [[nodiscard]] std::optional<Problem> broken_rule_of(std::string_view path) const;

 private:
  HydraulicsDef circuit_;
};

}  // namespace slew::hydraulics
