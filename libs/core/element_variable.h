// SPDX-License-Identifier: Apache-2.0
// A variable that an element offers: any quantity with a name and a dimension, for plots, status, controllers.
#pragma once

#include <string>

#include "core/dimension.h"

namespace slew {

// Full name "Element.quantity" ("Cyl_Lift.force", "Bag.position.y"); value in the dimension's SI unit.
struct ElementVariable {
  std::string name;
  Dimension dimension = Dimension::none;
  bool is_detail = false;  // member of a large set: published only if a pattern other than "*" matches
};

}  // namespace slew
