// SPDX-License-Identifier: Apache-2.0
#include "analysis/scene_plots.h"

#include <algorithm>
#include <filesystem>

#include "core/failure.h"
#include "core/text_output.h"
#include "node/identity.h"
#include "recording/run_directory.h"
#include "scene/name_pattern.h"
#include "session/recorded.h"
#include "session/unrecorded.h"

namespace slew::analysis {

std::vector<std::string> plotted(const scene::Scene& scene) {
  std::vector<std::string> patterns;
  for (const scene::PlotDef& plot : scene.plots) {
    patterns.insert(patterns.end(), plot.variables.begin(), plot.variables.end());
  }
  return patterns;
}

ScenePlots read_plots(const scene::Scene& scene, const recording::Reader& reader) {
  return draw_plots(scene, session::view_recording(reader, plotted(scene)).tally.curves(), reader);
}

ScenePlots draw_plots(const scene::Scene& scene, const session::Curves& curves, const recording::Reader& reader) {
  ScenePlots read;
  const std::vector<std::string> names = curves.names();
  for (const scene::PlotDef& plot : scene.plots) {
    std::vector<std::string> wanted = plot.variables;
    const std::vector<std::string> missing = scene::unmatched(wanted, names);
    if (!missing.empty()) {
      read.left_out.push_back("plot " + plot.name + ": not drawn: " + session::why_missing(reader, missing, names));
      std::erase_if(wanted, [&missing](const std::string& pattern) {
        return std::find(missing.begin(), missing.end(), pattern) != missing.end();
      });
    }
    if (wanted.empty()) continue;
    read.plots.push_back({plot.title.empty() ? plot.name : plot.title, curves.select(wanted, session::Units::display)});
    plotting::part_at_gaps(read.plots.back().series);
  }
  return read;
}

plotting::PlotOptions plot_heading(const recording::Reader& reader) {
  plotting::PlotOptions options;
  options.title = reader.identity().scene;
  options.subtitle = "session " + reader.identity().session_name + ", " + node::time_text(reader.identity().started_ns);
  return options;
}

std::string write_plots(const std::vector<plotting::Plot>& plots, const recording::Reader& reader) {
  if (plots.empty()) return "";
  const std::string& scene = reader.identity().scene;
  const std::filesystem::path path = reader.path().parent_path() / (recording::file_name(scene) + ".svg");
  const std::string text = plotting::plot_svg(std::span<const plotting::Plot>(plots), plot_heading(reader));
  if (!replace_file(path, [&text](const auto& part) { return put_text(part, text); }).is_ok()) {
    throw Failure(ExitCode::storage, "the plots could not be written to " + path.string() +
                                         "; the recording is complete; free some space and use 'slewring "
                                         "plot'");
  }
  return path.string();
}

}  // namespace slew::analysis
