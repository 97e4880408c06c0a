// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_options.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "core/installation.h"
#include "scene/canonical.h"
#include "scene/edited_scene.h"
#include "scene/script_reader.h"
#include "scene/without_effect.h"

namespace slew::scene {
namespace {

scene::Node text_node(const std::string& text, const scene::Mark& mark) {
  scene::Node node;
  node.kind = scene::Node::Kind::scalar;
  node.is_quoted = true;
  node.text = text;
  node.mark = mark;
  return node;
}

// Replaces the scene's script by that of a file; problems are reported with their place in that file.
void replace_script(scene::Scene& scene, const std::string& file) {
  scene::Report report;
  const scene::Mark mark{report.add_source("--input " + file, scene::Report::Lines::none), 0, 0};
  scene::Node section;
  section.kind = scene::Node::Kind::map;
  section.mark = mark;
  section.entries.push_back({"file", mark, text_node(file, mark)});

  // names of the scene's elements, from its canonical text
  scene::Report own_report;
  const auto source = scene::check_source(scene.expanded_text, own_report.add_source(scene.name), own_report);
  const auto root = source ? scene::parse_yaml(*source, own_report) : std::nullopt;
  if (!root) own_report.fail(scene::kMaxReportedProblems);
  scene::NameTable names;
  names.declare_all(*root, own_report);

  scene.script = {};
  scene::UnitSystem units;
  scene::PlaceMap places;
  std::vector<scene::Reference> references;
  // the command line may name a file anywhere
  const scene::LoadContext beside{.has_folder = true, .folder = "", .is_confined = false};
  const scene::ReadContext context{units, report, places, references, &beside};
  scene::read_script(section, mark, beside, names, scene, context);
  // a recording keeps both in one folder
  for (const scene::Asset& asset : scene.assets) {
    const auto& script = scene.script.file;
    if (!script || asset.name != script->file || asset.sha256 == script->sha256) continue;
    report.add(mark, "", {"the scene has another file '" + asset.name + "'", "an input file of another name", ""});
  }
  if (!report.is_clean()) report.fail(scene::kMaxReportedProblems);
}

}  // namespace

std::string find_scene(const std::string& file) {
  constexpr std::string_view kFolder = "scenes/";
  std::error_code error;
  const std::string installed = installed_scenes();
  if (installed.empty() || file.starts_with('/') || std::filesystem::exists(file, error)) return file;
  const std::string name = file.starts_with(kFolder) ? file.substr(kFolder.size()) : file;
  const std::filesystem::path found = std::filesystem::path(installed) / name;
  return std::filesystem::is_regular_file(found, error) ? found.string() : file;
}

namespace {

scene::Overrides of_session(const SceneOptions& options) {
  scene::Overrides overrides;
  if (!options.step.empty()) overrides.push_back("session.step=" + options.step);
  if (!options.duration.empty()) overrides.push_back("session.duration=" + options.duration);
  if (!options.pace.empty()) overrides.push_back("session.pace=" + options.pace);
  if (!options.recorded_steps.empty()) overrides.push_back("recording.steps=" + options.recorded_steps);
  return overrides;
}

// Changes of parameters are no input: those of the scene stay where a file has none of its own.
scene::Scene with_input(scene::Scene scene, const SceneOptions& options) {
  if (options.input == "script") return scene;
  std::vector<scene::ScriptChange> changes = std::move(scene.script.changes);
  if (options.has_script()) {
    replace_script(scene, options.input);
  } else {
    scene.script = {};
  }
  if (scene.script.changes.empty()) scene.script.changes = std::move(changes);
  scene.expanded_text = scene::canonical_text(scene);
  return scene;
}

}  // namespace

Overrides overrides_of(const SceneOptions& options) {
  Overrides overrides = options.overrides;
  const Overrides more = of_session(options);
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

scene::Scene load_scene(const SceneOptions& options) {
  scene::Scene scene = with_input(scene::load_file(options.file, overrides_of(options)), options);
  if (options.has_script() && scene.session.duration > 0) {
    for (std::string& warning : scene::find_unplayed_inputs(scene, "--input " + options.input, scene.session.duration))
      scene.warnings.push_back(std::move(warning));
  }
  return scene;
}

namespace {

// The controller of an input is no part of the saved state: io_node's state holds only its value and ramp.
constexpr std::string_view kOfController[] = {".controller", ".controller_delay", ".controller_wait", ".supervisor"};

bool is_of_controller(const std::string& setting) {
  const std::string_view path = std::string_view(setting).substr(0, setting.find('='));
  return std::any_of(std::begin(kOfController), std::end(kOfController),
                     [path](std::string_view key) { return path.ends_with(key); });
}

}  // namespace

ContinuedScene continue_scene(const SceneOptions& options, const std::string& scene_text,
                              const std::string& scene_name) {
  if (!options.step.empty()) {
    throw Failure(ExitCode::bad_input,
                  "the step of a saved session is part of its state; nothing was started; omit --step");
  }
  scene::Overrides overrides = of_session(options);
  std::copy_if(options.overrides.begin(), options.overrides.end(), std::back_inserter(overrides), is_of_controller);
  ContinuedScene continued{
      with_input(scene::load_text(scene_text, scene_name, overrides, options.assets.empty() ? "." : options.assets,
                                  options.input == "script" ? scene::ScriptFile::read : scene::ScriptFile::left_out),
                 options),
      {}};
  scene::ParameterDirectory directory(continued.scene);
  for (const std::string& setting : options.overrides) {
    if (is_of_controller(setting)) continue;
    scene::Assignment change = directory.parse_assignment(setting);
    if (!change.status.is_ok()) {
      throw Failure(ExitCode::bad_input, "--set " + setting + ": " + change.status.text +
                                             "; a continued session accepts changes of live parameters, and of the "
                                             "controller, controller_delay, controller_wait and supervisor of inputs, "
                                             "only; nothing was started");
    }
    continued.changes.push_back(std::move(change));
  }
  return continued;
}

std::vector<std::string> scene_arguments(const SceneOptions& options) {
  std::vector<std::string> arguments;
  if (options.from.empty()) arguments.push_back(options.file);
  const auto add = [&](const char* name, const std::string& value) {
    if (value.empty()) return;
    arguments.emplace_back(name);
    arguments.push_back(value);
  };
  add("--from", options.from);
  add("--assets", options.assets);
  for (const std::string& setting : options.overrides) add("--set", setting);
  add("--step", options.step);
  add("--duration", options.duration);
  add("--pace", options.pace);
  add("--input", options.input);
  add("--record-steps", options.recorded_steps);
  if (!options.is_recording) arguments.emplace_back("--no-record");
  return arguments;
}

}  // namespace slew::scene
