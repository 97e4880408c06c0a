// SPDX-License-Identifier: Apache-2.0
// An error in a Def, found by the physics library that owns it; the scene reader adds the place in the file.
#pragma once

#include <string>
#include <vector>

namespace slew {

// path: dotted from the element's name ("Bag.mass", "Cyl_Lift.rod"); the others are sentences without a full stop.
struct Problem {
  std::string path;
  std::string what;        // error, with the value got
  std::string expected;    // accepted value; may be empty
  std::string suggestion;  // a name that was probably meant; may be empty
};

using Problems = std::vector<Problem>;

}  // namespace slew
