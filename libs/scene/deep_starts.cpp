// SPDX-License-Identifier: Apache-2.0
#include "scene/deep_starts.h"

#include "multibody/build/validate.h"

namespace slew::scene {

std::string deep_starts(const Scene& scene) {
  Problems found;
  multibody::find_unlikely_contacts(scene.mechanics, found);
  std::string text;
  for (const Problem& one : found) text += (text.empty() ? "" : "; ") + one.path + ": " + one.what;
  return text;
}

}  // namespace slew::scene
