// `slewring animate REC`: the machine of a recording in side and top view, to look at without installing anything.
#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <memory>

#include "cli/animation/animation.h"
#include "cli/recorded.h"
#include "cli/scene_plots.h"
#include "cli/text_output.h"
#include "cli/unrecorded.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "cli_support/name_pattern.h"

namespace slew::cli {
namespace {

using cli_support::Failure;

constexpr std::size_t kMostFrames = 2000;  // of a page
constexpr int kMostInstants = 50;

struct Options {
  std::string recording, output;
  int instants = 7;
};

// of a Pose, in the order of its members
constexpr const char* kParts[] = {"position.x",    "position.y",    "position.z",   "orientation.w",
                                  "orientation.x", "orientation.y", "orientation.z"};

void check_poses(const recording::Reader& reader, const scene::Scene& scene, const std::vector<std::string>& names) {
  const std::vector<std::string> missing = cli_support::unmatched(names, recorded_names(reader));
  if (missing.empty()) return;
  const std::string more = missing.size() > 1 ? fmt::format(" (and {} more)", missing.size() - 1) : "";
  throw Failure(ExitCode::bad_input,
                fmt::format("the poses were not recorded: {}{} is not in this recording, whose scene records {} "
                            "(recording.variables); nothing was written; run it again with *.position.* and "
                            "*.orientation.* among them",
                            missing.front(), more, recorded_patterns_text(scene)));
}

Motion read_motion(const recording::Reader& reader, const scene::Scene& scene, const MachineDrawing& machine) {
  std::vector<std::string> names;
  for (std::size_t body = 1; body < machine.bodies.size(); ++body) {
    for (const char* part : kParts) names.push_back(machine.bodies[body].name + "." + part);
  }
  check_poses(reader, scene, names);
  std::vector<plotting::Series> series = read_series(reader, names, Units::si);
  plotting::keep_common_instants(series);
  const plotting::PlotOptions heading = plot_heading(reader);
  Motion motion{heading.title, heading.subtitle, series.front().time, {}, {}};
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

ExitCode animate(const Options& options) {
  const std::string path = options.output.empty() ? "animation.html" : options.output;
  const std::string kind = std::filesystem::path(path).extension().string();
  if (kind != ".html" && kind != ".svg") {
    throw Failure(ExitCode::bad_input, path + " is neither .html nor .svg; nothing was written; name such a file");
  }
  const auto reader = open_recording(options.recording);
  const scene::Scene scene = scene::load_text(attachment_text(*reader, "scene.yaml"), reader->identity().scene);
  if (scene.mechanics.bodies.empty()) {
    throw Failure(ExitCode::bad_input, "the scene of this recording has no bodies; nothing was written");
  }
  const MachineDrawing machine = draw_machine(scene.mechanics);
  const Motion motion = read_motion(*reader, scene, machine);
  if (motion.time.empty()) throw Failure(ExitCode::bad_input, "the recording holds no values; nothing was written");
  write_text(path, kind == ".html"
                       ? animation_html(machine, thinned(motion, kMostFrames))
                       : animation_svg(machine, thinned(motion, static_cast<std::size_t>(options.instants))));
  fmt::print("{}\n", path);
  return ExitCode::ok;
}

}  // namespace

void add_animate(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("animate", "show the machine of a recording as it moves");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb->add_option("recording", options->recording, "recording, or the folder of a run")->required()->type_name("REC");
  verb->add_option(
          "-o,--output", options->output,
          "file to write: .html, a page with a time slider, or .svg, some instants over each other; without it "
          "animation.html")
      ->type_name("FILE");
  verb->add_option("--instants", options->instants, "of a .svg")
      ->check(CLI::Range(1, kMostInstants))
      ->type_name("N")
      ->capture_default_str();
  verb->footer(
      "Bodies are drawn as lines between joints, forces and centre of mass and by their contact shapes, or as a small\n"
      "cross, at the poses that were recorded; bending, ropes and planes are not drawn.\n\n"
      "Example:\n"
      "  slewring animate runs/truck_crane-20260501-102030 -o crane.html");
  verb->callback([&action, options] { action = [options] { return animate(*options); }; });
}

}  // namespace slew::cli
