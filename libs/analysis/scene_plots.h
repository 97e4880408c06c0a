// The plots that a scene defines, for a recording of it.
#pragma once

#include <string>
#include <vector>

#include "plotting/svg_plot.h"
#include "recording/reader.h"
#include "scene/scene.h"

namespace slew::analysis {

// The scene's plots of a recording, without missing variables.
struct ScenePlots {
  std::vector<plotting::Plot> plots;
  std::vector<std::string> left_out;  // a sentence for each plot that lacks a variable
};
[[nodiscard]] ScenePlots read_plots(const scene::Scene& scene, const recording::Reader& reader);
// Heading of pictures of a recording.
[[nodiscard]] plotting::PlotOptions plot_heading(const recording::Reader& reader);

// Writes plots as one picture beside the recording. Returns its path; empty when there are none.
[[nodiscard]] std::string write_plots(const std::vector<plotting::Plot>& plots, const recording::Reader& reader);

}  // namespace slew::analysis
