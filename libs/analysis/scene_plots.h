// SPDX-License-Identifier: Apache-2.0
// The plots that a scene defines, for a recording of it.
#pragma once

#include <string>
#include <vector>

#include "plotting/svg_plot.h"
#include "recording/reader.h"
#include "scene/scene.h"
#include "session/curves.h"

namespace slew::analysis {

// The scene's plots of a recording, without missing variables.
struct ScenePlots {
  std::vector<plotting::Plot> plots;
  std::vector<std::string> left_out;  // a sentence for each plot that lacks a variable
};
[[nodiscard]] ScenePlots read_plots(const scene::Scene& scene, const recording::Reader& reader);
// The same from curves that keep what the plots need; of the reader nothing but its scene is read.
[[nodiscard]] ScenePlots draw_plots(const scene::Scene& scene, const session::Curves& curves,
                                    const recording::Reader& reader);
// Names and patterns of all that the scene plots.
[[nodiscard]] std::vector<std::string> plotted(const scene::Scene& scene);
// What stands above pictures of a recording.
[[nodiscard]] plotting::PlotOptions plot_heading(const recording::Reader& reader);

// Writes plots as one picture beside the recording. Returns its path; empty when there are none.
[[nodiscard]] std::string write_plots(const std::vector<plotting::Plot>& plots, const recording::Reader& reader);

}  // namespace slew::analysis
