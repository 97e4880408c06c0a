// SPDX-License-Identifier: Apache-2.0
// Reading scenes from strings in tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "scene/scene.h"

namespace slew::scene {

// Text of all problems; empty when the scene is sound.
inline std::string problems_of(std::string text, const Overrides& overrides = {}) {
  try {
    (void)load_text(std::move(text), "test", overrides);
  } catch (const LoadError& error) {
    return error.what();
  }
  return {};
}

// a sound scene to hang things on
inline const std::string kPendulum =
    "bodies:\n"
    "  Rod: {mass: 2 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 1, 1]}\n"
    "joints:\n"
    "  Hinge: {type: revolute, body2: Rod}\n";

}  // namespace slew::scene
