// `slewring plot REC VAR...`: a recording's variables as a picture or a page.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>

#include "analysis/scene_plots.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/printable.h"
#include "core/text_output.h"
#include "plotting/html_plot.h"
#include "plotting/svg_plot.h"
#include "session/recorded.h"

namespace slew::cli {
namespace {

struct PlotOptions {
  std::string recording;
  std::vector<std::string> variables;
  std::vector<std::string> others;  // recordings to compare with
  std::string output;
  std::string title;
};

using Readers = std::vector<std::unique_ptr<recording::Reader>>;

// Labels of several recordings: their scenes, or where those are alike their folders.
std::vector<std::string> labels_of(const Readers& readers) {
  std::vector<std::string> scenes, folders;
  for (const auto& reader : readers) {
    scenes.push_back(reader->identity().scene);
    folders.push_back(std::filesystem::absolute(reader->path()).parent_path().filename().string());
  }
  const std::set<std::string> different(scenes.begin(), scenes.end());
  return different.size() == scenes.size() ? scenes : folders;
}

// The variables of all recordings, those of one beside each other.
std::vector<plotting::Series> read_beside(const Readers& readers, const std::vector<std::string>& variables) {
  const std::vector<std::string> labels = labels_of(readers);
  std::vector<std::vector<plotting::Series>> by_recording;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    try {
      by_recording.push_back(session::read_series(*readers[i], variables, session::Units::display));
    } catch (const Failure& failure) {
      throw Failure(failure.code(), readers[i]->path().string() + ": " + failure.what());
    }
    plotting::part_at_gaps(by_recording.back());
    for (plotting::Series& curve : by_recording.back()) curve.name += " (" + labels[i] + ")";
  }
  std::vector<plotting::Series> curves;
  std::size_t longest = 0;
  for (const auto& of_one : by_recording) longest = std::max(longest, of_one.size());
  for (std::size_t k = 0; k < longest; ++k) {
    for (auto& of_one : by_recording) {
      if (k < of_one.size()) curves.push_back(std::move(of_one[k]));
    }
  }
  return curves;
}

// The format follows the file's name: a page for .html, a picture otherwise.
ExitCode draw(std::span<const plotting::Plot> plots, const plotting::PlotOptions& look, const std::string& output) {
  const std::string path = output.empty() ? "plot.svg" : output;
  const bool is_page = std::filesystem::path(path).extension() == ".html";
  write_text(path, is_page ? plotting::plot_html(plots, look) : plotting::plot_svg(plots, look));
  if (path != "-") fmt::print("{}\n", path);
  return ExitCode::ok;
}

ExitCode plot_beside(const PlotOptions& options) {
  if (options.variables.empty()) {
    throw Failure(ExitCode::bad_input, "--with compares variables; nothing was written; name the variables to plot");
  }
  Readers readers;
  readers.push_back(session::open_recording(options.recording));
  for (const std::string& other : options.others) readers.push_back(session::open_recording(other));
  plotting::PlotOptions look;
  look.title = options.title;
  for (const std::string& label : labels_of(readers)) {
    if (options.title.empty()) look.title += (look.title.empty() ? "" : ", ") + label;
  }
  const plotting::Plot plot{.title = "", .series = read_beside(readers, options.variables)};
  return draw({&plot, 1}, look, options.output);
}

ExitCode plot(const PlotOptions& options) {
  if (!options.others.empty()) return plot_beside(options);
  const auto reader = session::open_recording(options.recording);
  plotting::PlotOptions look = analysis::plot_heading(*reader);
  if (!options.title.empty()) look.title = options.title;
  if (!options.variables.empty()) {
    plotting::Plot plot{.title = "",
                        .series = session::read_series(*reader, options.variables, session::Units::display)};
    plotting::part_at_gaps(plot.series);
    return draw({&plot, 1}, look, options.output);
  }
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(*reader), reader->identity().scene);
  if (scene.plots.empty()) {
    throw Failure(ExitCode::bad_input,
                  "the scene of this recording has no plots; nothing was written; name the variables to plot");
  }
  const analysis::ScenePlots read = analysis::read_plots(scene, *reader);
  if (read.plots.empty()) {
    throw Failure(ExitCode::bad_input, fmt::format("{}; nothing was written", fmt::join(read.left_out, "; ")));
  }
  for (const std::string& left_out : read.left_out)
    std::fprintf(stderr, "warning: %s\n", printable_lines(left_out).c_str());
  if (!options.output.empty()) return draw(read.plots, look, options.output);
  fmt::print("{}\n", analysis::write_plots(read.plots, *reader));
  return ExitCode::ok;
}

}  // namespace

void add_plot(options::Command& program) {
  options::Command verb =
      program.command("plot", "draw variables of a recording: a picture, or a page to look around in");
  const auto options = std::make_shared<PlotOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.option("variables", options->variables, "names, or patterns with * and ?; without them the scene's plots")
      .value_name("VAR");
  verb.option("-o,--output", options->output,
              "file to write: .svg, .html, or - for standard output; without it plot.svg, or for the scene's plots "
              "<scene>.svg beside the recording")
      .value_name("FILE");
  verb.option("--title", options->title, "heading; without it the scene's name").value_name("TEXT");
  verb.option("--with", options->others, "another recording whose variables are drawn beside; repeat for more")
      .value_name("REC")
      .repeatable();
  verb.footer(
      "Examples:\n"
      "  slewring plot runs/truck_crane-20260501-102030 'Cyl_*.force' Bag.position.y -o lift.svg\n"
      "  slewring plot runs/truck_crane-20260501-102030 -o run.html\n"
      "  slewring plot runs/truck_crane-20260501-102030 Bag.position.y --with "
      "runs/truck_crane_flexible-20260501-103000");
  verb.action([options] { return plot(*options); });
}

}  // namespace slew::cli
