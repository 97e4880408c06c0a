// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "scene/edited_scene.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/scene.h"
#include "scene/scene_reader.h"
#include "scene/source.h"
#include "scene/yaml_tree.h"

namespace slew::scene {
namespace {

Scene read_tree(Node root, LoadContext load_context, const std::string& name, const Overrides& overrides,
                Report& report) {
  std::vector<std::string> warnings;
  // the text of a session or a recording is expanded already
  std::vector<ParameterText> parameter_texts;
  if (!expand(root, overrides, report, load_context.has_folder ? &warnings : nullptr, parameter_texts)) {
    report.fail(kMaxReportedProblems);
  }
  Scene scene = read_scene(root, std::move(load_context), report, name);
  if (!report.is_clean()) report.fail(kMaxReportedProblems);
  scene.parameter_texts = std::move(parameter_texts);
  scene.warnings.insert(scene.warnings.begin(), warnings.begin(), warnings.end());
  return scene;
}

std::string line_of(const std::string& text, std::size_t at) {
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

[[noreturn]] void refuse_expansion(const Scene& scene, std::string what) {
  throw LoadError(
      {{.file = scene.name,
        .path = "",
        .what = "the scene as published to the nodes does not read back as the same scene: " + std::move(what),
        .expected = "the same scene; report it as a fault of this program, with the file",
        .suggestion = ""}},
      0);
}

// Every node reads the expanded text, which must therefore give the same scene.
void read_back(const Scene& scene) {
  std::string again;
  try {
    again = load_text(scene.expanded_text, scene.name).expanded_text;
  } catch (const LoadError& error) {
    refuse_expansion(scene, error.what());
  }
  if (again == scene.expanded_text) return;
  const auto differs =
      std::mismatch(again.begin(), again.end(), scene.expanded_text.begin(), scene.expanded_text.end());
  refuse_expansion(scene, fmt::format("'{}' became '{}'",
                                      line_of(scene.expanded_text,
                                              static_cast<std::size_t>(differs.second - scene.expanded_text.begin())),
                                      line_of(again, static_cast<std::size_t>(differs.first - again.begin()))));
}

// text: null: that of the file.
Scene load_from(const std::string& path, const std::string* text, const Overrides& overrides) {
  return guarded(path, [&] {
    Report report;
    std::optional<Node> root = read_with_includes(path, report, Includes::with_prefix, text);
    if (!root) report.fail(kMaxReportedProblems);
    const std::filesystem::path file(path);
    LoadContext load_context{true, file.parent_path().string()};
    load_context.device_folder = load_context.folder;
    Scene scene = read_tree(std::move(*root), std::move(load_context), file.stem().string(), overrides, report);
    read_back(scene);
    return scene;
  });
}

}  // namespace

Scene load_file(const std::string& path, const Overrides& overrides) {
  return load_from(path, nullptr, overrides);
}

Scene load_edited(const std::string& path, const std::string& text, const Overrides& overrides) {
  return load_from(path, &text, overrides);
}

Scene load_text(std::string text, const std::string& name, const Overrides& overrides,
                const std::optional<std::string>& files, ScriptFile script) {
  return guarded(name, [&] {
    Report report;
    const std::optional<SourceText> source = check_source(std::move(text), report.add_source(name), report);
    std::optional<Node> root = source ? parse_yaml(*source, report) : std::nullopt;
    if (!root) report.fail(kMaxReportedProblems);
    LoadContext load_context;
    load_context.has_assets = files.has_value();
    load_context.asset_folder = files.value_or("");
    load_context.reads_script = script == ScriptFile::read;
    return read_tree(std::move(*root), std::move(load_context), name, overrides, report);
  });
}

Scene with_devices(const Scene& scene, const std::string& file) {
  return guarded(file, [&] {
    Report report;
    const std::optional<SourceText> source = check_source(scene.expanded_text, report.add_source(scene.name), report);
    std::optional<Node> root = source ? parse_yaml(*source, report) : std::nullopt;
    const std::optional<Node> added = read_with_includes(file, report);
    if (!root || !added) report.fail(kMaxReportedProblems);
    constexpr std::string_view kSections[] = {"devices", "outputs"};
    for (const std::string_view section : kSections) {
      std::erase_if(root->entries, [&](const Node::Entry& entry) { return entry.key == section; });
    }
    report_duplicates(*added, "", report);
    for (const Node::Entry& entry : added->entries) {
      if (std::find(std::begin(kSections), std::end(kSections), entry.key) == std::end(kSections)) {
        report.add(entry.mark, entry.key, {"is no section of a file of devices", "devices or outputs", ""});
      } else {
        root->entries.push_back(entry);
      }
    }
    if (!report.is_clean()) report.fail(kMaxReportedProblems);
    LoadContext load_context;
    load_context.reads_script = false;
    load_context.device_folder = std::filesystem::path(file).parent_path().string();
    return read_tree(std::move(*root), std::move(load_context), scene.name, {}, report);
  });
}

Status check_is_split(const Scene& scene) {
  if (scene.session.solution == Solution::split) return Status::ok();
  return Status::error(ExitCode::bad_input,
                       "the scene's session.solution is monolithic: its physics is one system in one process and no "
                       "node can take a part of it; run it with 'slewring run SCENE --monolithic', or set "
                       "session.solution to split");
}

}  // namespace slew::scene
