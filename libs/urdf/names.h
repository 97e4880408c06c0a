// Names of links and joints as names of a scene's elements.
#pragma once

#include <set>
#include <string>

namespace slew::urdf {

// Gives every name once. Other scripts are transliterated, other characters that a scene does not take become _, what
// is too long loses its middle, what is taken or reserved gets `suffix`, then a number.
class SceneNames {
 public:
  SceneNames();
  [[nodiscard]] std::string take(const std::string& name, const std::string& suffix);

 private:
  std::set<std::string> taken_;
};

}  // namespace slew::urdf
