// SPDX-License-Identifier: Apache-2.0
// Pictures of the cards: written into the folder that SLEWRING_FIGURE_FOLDER names, or not at all.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "plotting/scatter_svg.h"
#include "plotting/svg_plot.h"

namespace slew::testing {

inline void write_figure(const std::string& name, const std::string& svg) {
  const char* const folder = std::getenv("SLEWRING_FIGURE_FOLDER");
  if (folder == nullptr) return;
  std::ofstream file(std::string(folder) + "/" + name);
  file << svg;
  EXPECT_TRUE(file.good()) << folder << "/" << name;
}

}  // namespace slew::testing
