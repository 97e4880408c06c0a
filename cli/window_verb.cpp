// SPDX-License-Identifier: Apache-2.0
// `slewring window [SCENE | RECORDING]`: a session or a recording in a browser and in clients of the Foxglove protocol.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "cli/run_session.h"
#include "cli/verbs.h"
#include "cli/window_process.h"
#include "core/failure.h"
#include "core/installation.h"
#include "program/add_session_options.h"
#include "scene/edited_scene.h"
#include "session/interrupts.h"
#include "view_node/door_check.h"

namespace slew::cli {
namespace {

struct Options {
  std::string source;
  session::RunOptions run;
  view_node::WindowOptions window;
};

bool is_recording(const std::string& source) {
  std::error_code ignored;
  return source.ends_with(".mcap") || std::filesystem::is_directory(source, ignored);
}

// The program in the place of this process.
[[noreturn]] void become_window(const view_node::WindowOptions& options) {
  const std::string program = sibling_program("view_node");
  const std::vector<std::string> arguments = view_node::window_arguments(options);
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  throw Failure(ExitCode::resources, "cannot start " + program + " (" + std::strerror(errno) +
                                         "); nothing was started; build it, or install all programs together");
}

ExitCode open_window(Options options, const options::Command& verb) {
  options.window.session = options.run.session;
  if (options.source.empty() || is_recording(options.source)) {
    for (const char* option : {"--set", "--step", "--duration", "--pace", "--input", "--out", "--rt"}) {
      if (!verb.has(option)) continue;
      throw Failure(ExitCode::bad_input, std::string(option) +
                                             " is for a session that the window starts; nothing was started; name a "
                                             "scene, or leave the option out");
    }
    options.window.recording = options.source;
    become_window(options.window);
  }
  if (!options.window.beside.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--beside is for the window of a recording; nothing was started; name a "
                  "recording in the place of the scene, or leave it out");
  }
  options.run.scene.file = scene::find_scene(options.source);
  // in front of the session, which would go on without a window
  view_node::check_door(options.window);
  if (!verb.has("--duration")) options.run.scene.duration = "0";
  if (!verb.has("--input")) options.run.scene.input = "none";
  if (options.window.assets.empty()) options.window.assets = options.run.assets();
  options.window.scene = options.run.scene.file;
  options.window.set = scene::overrides_of(options.run.scene);
  while (true) {
    const io_node::SessionScene session = io_node::load_session_scene(options.run.scene);
    WindowProcess window(options.window);
    const ExitCode code = run_session(options.run, session, &window);
    if (!window.wants_restart() || session::interrupt_code() != 0) return code;
    options.window = window.options_of_next();
  }
}

}  // namespace

void add_window(options::Command& program) {
  options::Command verb =
      program.command("window", "show a session or a recording in a browser, in Foxglove or in Lichtblick");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  verb.option("source", options->source,
              "scene, whose session is started; recording, or the folder of a run; without it the session that runs")
      .value_name("SCENE|REC");
  view_node::add_window_options(verb, options->window);
  verb.option("--set", options->run.scene.overrides, "with a scene: change a value of it, such as Bag.mass=1500kg")
      .value_name("PATH=VALUE")
      .one_value_each()
      .group("Scene");
  verb.option("--step", options->run.scene.step, "with a scene: communication step").value_name("TIME").group("Scene");
  verb.option("--duration", options->run.scene.duration,
              "with a scene: end of the session's time; 0, as without it: none")
      .value_name("TIME")
      .group("Scene");
  verb.option("--pace", options->run.scene.pace, "with a scene: real or free")
      .one_of({"real", "free"})
      .value_name("PACE")
      .group("Scene");
  verb.option("--input", options->run.scene.input, "with a scene: script, none (as without it), or a file")
      .value_name("SOURCE")
      .group("Scene");
  verb.flag("--record,!--no-record", options->run.scene.is_recording, "with a scene: record it (default)")
      .group("Scene");
  program::add_session_options(verb, options->run.session, false);
  add_running_options(verb, options->run);
  verb.flag("--json", options->window.is_json, "print the addresses as JSON");
  verb.footer(
      "Prints the address of the page, which is also that of the Foxglove protocol. Ends with the session, or at "
      "Ctrl-C, which ends a session that it started.\n\n"
      "Examples:\n"
      "  slewring window scenes/truck_crane.yaml\n"
      "  slewring window --session truck_crane --view-only\n"
      "  slewring window runs/truck_crane-20260501-102030 --beside runs/truck_crane-20260501-112233");
  verb.action([options, verb] { return open_window(*options, verb); });
}

}  // namespace slew::cli
