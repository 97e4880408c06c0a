// SPDX-License-Identifier: Apache-2.0
// `slewring animate REC`: the machine of a recording in side and top view, as a page that needs no installation.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>

#include "analysis/animation/animation.h"
#include "analysis/scene_plots.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "scene/name_pattern.h"
#include "session/recorded.h"
#include "session/unrecorded.h"

namespace slew::cli {
namespace {

constexpr std::size_t kMostFrames = 2000;  // limit of a page, also in the help
constexpr int kMostInstants = 50;

struct AnimateOptions {
  std::string recording, output;
  std::string from, to;
  int instants = 7;
};

// members of a Pose, in their order
constexpr const char* kParts[] = {"position.x",    "position.y",    "position.z",   "orientation.w",
                                  "orientation.x", "orientation.y", "orientation.z"};

void check_poses(const recording::Reader& reader, const scene::Scene& scene, const std::vector<std::string>& names) {
  const std::vector<std::string> missing = scene::unmatched(names, session::recorded_names(reader));
  if (missing.empty()) return;
  const std::string more = missing.size() > 1 ? fmt::format(" (and {} more)", missing.size() - 1) : "";
  throw Failure(ExitCode::bad_input,
                fmt::format("the poses were not recorded: {}{} is not in this recording, whose scene records {} "
                            "(recording.variables); nothing was written; run it again with *.position.* and "
                            "*.orientation.* among them",
                            missing.front(), more, session::recorded_patterns_text(scene)));
}

analysis::Motion read_motion(const recording::Reader& reader, const scene::Scene& scene,
                             const analysis::MachineDrawing& machine, const session::TimeRange& range) {
  std::vector<std::string> names;
  for (std::size_t body = 1; body < machine.bodies.size(); ++body) {
    for (const char* part : kParts) names.push_back(machine.bodies[body].name + "." + part);
  }
  check_poses(reader, scene, names);
  std::vector<plotting::Series> series = session::read_series(reader, names, session::Units::si, range);
  plotting::keep_common_instants(series);
  const plotting::PlotOptions heading = analysis::plot_heading(reader);
  analysis::Motion motion{heading.title, heading.subtitle, series.front().time, {}, {}};
  for (std::size_t k = 1; k < motion.time.size(); ++k) {
    if (plotting::is_gap(series.front(), k)) motion.gaps.push_back({motion.time[k - 1], motion.time[k]});
  }
  for (std::size_t body = 0; body + 1 < machine.bodies.size(); ++body) {
    const plotting::Series* of = &series[body * std::size(kParts)];
    motion.poses.emplace_back();
    for (std::size_t k = 0; k < motion.time.size(); ++k) {
      motion.poses.back().push_back(
          {.position = {of[0].values[k], of[1].values[k], of[2].values[k]},
           .orientation = {of[3].values[k], of[4].values[k], of[5].values[k], of[6].values[k]}});
    }
  }
  return motion;
}

// "2nd", "15th"
std::string ordinal_text(std::size_t n) {
  const std::size_t last = n % 100 >= 11 && n % 100 <= 13 ? 0 : n % 10;
  return fmt::format("{}{}", n, last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th");
}

// A page holds a limited number of instants; it names the ones shown.
std::string page_text(const analysis::MachineDrawing& machine, const analysis::Motion& motion) {
  const std::size_t n = analysis::stride_for(motion, kMostFrames);
  if (n == 1) return analysis::animation_html(machine, motion);
  analysis::Motion thin = analysis::every_nth(motion, n);
  const std::string shown = fmt::format("every {} recorded instant", ordinal_text(n));
  thin.subtitle += ", " + shown;
  std::fprintf(stderr, "slewring: the page shows %s; --from and --to take a part of the recording\n", shown.c_str());
  return analysis::animation_html(machine, thin);
}

ExitCode animate(const AnimateOptions& options) {
  const std::string path = options.output.empty() ? "animation.html" : options.output;
  const std::string kind = std::filesystem::path(path).extension().string();
  if (kind != ".html" && kind != ".svg") {
    throw Failure(ExitCode::bad_input, path + " is neither .html nor .svg; nothing was written; name such a file");
  }
  const session::TimeRange range = session::recorded_range(options.from, options.to);
  const auto reader = session::open_recording(options.recording);
  const scene::Scene scene = scene::load_text(session::recorded_scene_text(*reader), reader->identity().scene);
  if (scene.mechanics.bodies.empty()) {
    throw Failure(ExitCode::bad_input, "the scene of this recording has no bodies; nothing was written");
  }
  const analysis::MachineDrawing machine = analysis::draw_machine(scene.mechanics);
  const analysis::Motion motion = read_motion(*reader, scene, machine, range);
  if (motion.time.empty()) {
    const double end = static_cast<double>(reader->statistics().end_time) * 1e-9;
    throw Failure(
        ExitCode::bad_input,
        fmt::format("the recording holds no poses in this time; it goes from 0 to {:.6g} s; nothing was written", end));
  }
  write_text(path, kind == ".html"
                       ? page_text(machine, motion)
                       : analysis::animation_svg(
                             machine, analysis::thinned(motion, static_cast<std::size_t>(options.instants))));
  fmt::print("{}\n", path);
  return ExitCode::ok;
}

}  // namespace

void add_animate(options::Command& program) {
  options::Command verb = program.command("animate", "show the machine of a recording as it moves");
  const auto options = std::make_shared<AnimateOptions>();  // lives as long as the command line's callbacks
  verb.option("recording", options->recording, "recording, or the folder of a run").required().value_name("REC");
  verb.option("-o,--output", options->output,
              "file to write: .html, a page with a time slider, or .svg, some instants over each other; without it "
              "animation.html")
      .value_name("FILE");
  verb.option("--from", options->from, "first time that is shown, such as '2.5 s'").value_name("TIME");
  verb.option("--to", options->to, "last time that is shown").value_name("TIME");
  verb.option("--instants", options->instants, "number of instants of a .svg")
      .between(1, kMostInstants)
      .value_name("N")
      .show_default();
  verb.footer(
      "Bodies are drawn as lines between joints, forces and centre of mass and by their contact shapes, or as a small\n"
      "cross, at the poses that were recorded; bending, ropes and planes are not drawn.\n\n"
      "A page holds 2000 instants: of a longer recording every n-th, named on the page.\n\n"
      "Examples:\n"
      "  slewring animate runs/truck_crane-20260501-102030 -o crane.html\n"
      "  slewring animate runs/truck_crane-20260501-102030 --from 2s --to 5s -o crane.svg");
  verb.action([options] { return animate(*options); });
}

}  // namespace slew::cli
