// SPDX-License-Identifier: Apache-2.0
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
#include "plotting/decimation.h"
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
  std::string from, to;

  [[nodiscard]] bool is_part() const noexcept { return !from.empty() || !to.empty(); }
  [[nodiscard]] session::TimeRange range() const { return session::recorded_range(from, to); }
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
std::vector<plotting::Series> read_beside(const Readers& readers, const PlotOptions& options) {
  const std::vector<std::string> labels = labels_of(readers);
  std::vector<std::vector<plotting::Series>> by_recording;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    try {
      by_recording.push_back(
          session::read_series(*readers[i], options.variables, session::Units::display, options.range()));
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

// Of curves that were read whole: their part in the time range, as times in seconds.
void cut(std::vector<plotting::Plot>& plots, const session::TimeRange& range) {
  const double from = static_cast<double>(range.from_ns) * 1e-9, to = static_cast<double>(range.to_ns) * 1e-9;
  for (plotting::Plot& plot : plots) {
    for (plotting::Series& curve : plot.series) {
      plotting::Series part{curve.name, curve.unit, {}, {}, curve.spacing};
      for (std::size_t i = 0; i < curve.time.size(); ++i) {
        if (!(curve.time[i] >= from && curve.time[i] <= to)) continue;
        part.time.push_back(curve.time[i]);
        part.values.push_back(curve.values[i]);
      }
      curve = std::move(part);
    }
  }
}

void require_values(std::span<const plotting::Plot> plots) {
  for (const plotting::Plot& plot : plots) {
    for (const plotting::Series& curve : plot.series) {
      if (!curve.time.empty()) return;
    }
  }
  throw Failure(ExitCode::bad_input,
                "the recording has no value of these variables in this time; nothing was written; choose other times");
}

// A picture must be readable, a page must open.
constexpr std::size_t kMostCurvesOfPicture = 120;
constexpr std::size_t kMostValuesOfPage = 2'000'000;
constexpr std::size_t kLeastValuesOfCurve = 1000;

std::size_t curves_of(std::span<const plotting::Plot> plots) {
  std::size_t count = 0;
  for (const plotting::Plot& plot : plots) count += plot.series.size();
  return count;
}

void check_curves(std::span<const plotting::Plot> plots) {
  const std::size_t count = curves_of(plots);
  if (count <= kMostCurvesOfPicture) return;
  throw Failure(ExitCode::bad_input,
                fmt::format("{} curves are more than the {} that a picture may have; nothing was written; name fewer "
                            "variables, or write a page: -o plot.html",
                            count, kMostCurvesOfPicture));
}

// Long curves of a page keep the least and the largest value of each of their parts.
void thin_out(std::vector<plotting::Plot>& plots, plotting::PlotOptions& look) {
  const std::size_t most =
      std::max(kLeastValuesOfCurve, kMostValuesOfPage / std::max<std::size_t>(1, curves_of(plots)));
  std::size_t bin = 1;
  for (plotting::Plot& plot : plots) bin = std::max(bin, plotting::thin_out(plot.series, most));
  if (bin == 1) return;
  look.subtitle += fmt::format("{}long curves: the least and the largest of every {} values; --from and --to show more",
                               look.subtitle.empty() ? "" : "; ", bin);
}

// The format follows the file's name: a page for .html, a picture otherwise.
ExitCode draw(std::vector<plotting::Plot> plots, plotting::PlotOptions look, const std::string& output) {
  const std::string path = output.empty() ? "plot.svg" : output;
  const bool is_page = std::filesystem::path(path).extension() == ".html";
  is_page ? thin_out(plots, look) : check_curves(plots);
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
  std::vector<plotting::Plot> plots{{.title = "", .series = read_beside(readers, options)}};
  if (options.is_part()) require_values(plots);
  return draw(std::move(plots), look, options.output);
}

ExitCode plot(const PlotOptions& options) {
  if (!options.others.empty()) return plot_beside(options);
  const auto reader = session::open_recording(options.recording);
  plotting::PlotOptions look = analysis::plot_heading(*reader);
  if (!options.title.empty()) look.title = options.title;
  if (!options.variables.empty()) {
    plotting::Plot plot{
        .title = "",
        .series = session::read_series(*reader, options.variables, session::Units::display, options.range())};
    plotting::part_at_gaps(plot.series);
    std::vector<plotting::Plot> plots{std::move(plot)};
    if (options.is_part()) require_values(plots);
    return draw(std::move(plots), look, options.output);
  }
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(*reader), reader->identity().scene);
  if (scene.plots.empty()) {
    throw Failure(ExitCode::bad_input,
                  "the scene of this recording has no plots; nothing was written; name the variables to plot");
  }
  analysis::ScenePlots read = analysis::read_plots(scene, *reader);
  if (read.plots.empty()) {
    throw Failure(ExitCode::bad_input, fmt::format("{}; nothing was written", fmt::join(read.left_out, "; ")));
  }
  for (const std::string& left_out : read.left_out)
    std::fprintf(stderr, "warning: %s\n", printable_lines(left_out).c_str());
  if (options.is_part()) {
    cut(read.plots, options.range());
    require_values(read.plots);
  }
  // the picture beside the recording is that of the whole
  if (options.is_part() || !options.output.empty()) return draw(std::move(read.plots), look, options.output);
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
      .value_name("FILE")
      .check(plotting::problem_of_picture_name, "");
  verb.option("--from", options->from, "leave out what lies before, such as '2.5 s'").value_name("TIME");
  verb.option("--to", options->to, "leave out what lies behind").value_name("TIME");
  verb.option("--title", options->title, "heading; without it the scene's name").value_name("TEXT");
  verb.option("--with", options->others, "another recording whose variables are drawn beside; repeat for more")
      .value_name("REC")
      .repeatable();
  verb.footer(
      "Examples:\n"
      "  slewring plot runs/truck_crane-20260501-102030 'Cyl_*.force' Bag.position.y -o lift.svg\n"
      "  slewring plot runs/truck_crane-20260501-102030 -o run.html --from 2s --to 5s\n"
      "  slewring plot runs/truck_crane-20260501-102030 Bag.position.y --with "
      "runs/truck_crane_flexible-20260501-103000");
  verb.action([options] { return plot(*options); });
}

}  // namespace slew::cli
