// SPDX-License-Identifier: Apache-2.0
// Names of links and joints as names of a scene's elements.
#pragma once

#include <set>
#include <string>

namespace slew::urdf {

// Gives every name once. Other scripts are transliterated, characters not allowed in a scene become _, long names lose
// their middle, used or reserved names get `suffix`, then a number.
class SceneNames {
 public:
  SceneNames();
  [[nodiscard]] std::string take(const std::string& name, const std::string& suffix);

 private:
  std::set<std::string> taken_;
};

}  // namespace slew::urdf
