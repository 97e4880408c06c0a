// SPDX-License-Identifier: Apache-2.0
// Simbody 3.7's headers in C++20, where comparing two of its index types is ambiguous: each has members for all types
// of integer, and the language now tries them with the operands swapped as well. An exact match decides.
#pragma once

namespace SimTK {
template <typename Index>
requires requires(const Index& index) {
  index.isValidExtended();
}
bool operator==(const Index& a, const Index& b) {
  return static_cast<int>(a) == static_cast<int>(b);
}
}  // namespace SimTK

#include <simbody/SimTKsimbody.h>
