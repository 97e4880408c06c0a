// SPDX-License-Identifier: Apache-2.0
// Load-sensing pressure of a component that is the pressure of a volume above that of the tank.
#pragma once

#include "hydraulics/component.h"

namespace slew::hydraulics {

struct LsTap {
  LsIndex ls;
  StateIndex volume, tank;

  [[nodiscard]] double pressure(const CircuitView& view) const noexcept { return view[volume] - view[tank]; }
  void declare_dependencies(DependencyList& dependencies) const {
    dependencies.add(dependencies.ls_row(ls), volume);
    dependencies.add(dependencies.ls_row(ls), tank);
  }
  void stamp(JacobianStamp& jacobian) const noexcept {
    jacobian.add(jacobian.ls_row(ls), volume, 1);
    jacobian.add(jacobian.ls_row(ls), tank, -1);
  }
};

}  // namespace slew::hydraulics
