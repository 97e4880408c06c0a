// SPDX-License-Identifier: Apache-2.0
#include "urdf/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "scene/canonical.h"
#include "scene/diagnostic.h"
#include "scene/mesh_assets.h"
#include "scene/scene.h"
#include "scene/sections.h"
#include "scene/source.h"
#include "urdf/convert.h"
#include "urdf/reader.h"
#include "urdf/starts.h"

namespace slew::urdf {
namespace {

using scene::ElementRef;
using scene::ElementTable;

// one line, for any content of the file's names
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return text;
}

// The start of a name, cut between two characters.
std::string cut(const std::string& name) {
  std::size_t end = std::min(name.size(), scene::kMaxSceneNameLength);
  while (end > 0 && end < name.size() && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end;
  return name.substr(0, end);
}

// Texts of all fields of an element with its defaults, by key.
std::map<std::string_view, std::string> defaults_of(const ElementRef& element) {
  std::map<std::string_view, std::string> texts;
  for (const ElementTable& table : scene::element_tables()) {
    if (table.section != element.section) continue;
    if (table.type != element.type && !(table.is_default && element.type.empty())) continue;
    scene::Scene scratch;
    void* def = table.append(scratch, std::string(element.name));
    for (const Field& field : table.fields) texts[field.key] = scene::value_text(field, def);
  }
  return texts;
}

void write_element(std::string& text, const ElementRef& element, const Conversion& conversion) {
  text += fmt::format("  {}:\n", element.name);
  if (const auto comments = conversion.comments.find(std::string(element.name));
      comments != conversion.comments.end()) {
    for (const std::string& comment : comments->second) text += fmt::format("    # {}\n", one_line(comment));
  }
  if (!element.type.empty()) text += fmt::format("    type: {}\n", element.type);
  const auto defaults = defaults_of(element);
  for (const Field& field : element.fields) {
    const std::string value = scene::value_text(field, element.def);
    const bool is_written = field.presence == Presence::required || value != defaults.at(field.key);
    if (!value.empty() && is_written) text += fmt::format("    {}: {}\n", field.key, value);
  }
}

std::string header(const std::string& file, const Conversion& conversion) {
  std::string text = fmt::format("# From {} by `slewring import urdf`: a starting point.\n", one_line(file));
  const auto list = [&text](const char* what, const std::vector<Note>& notes) {
    if (notes.empty()) return;
    text += fmt::format("#\n# {}, by its lines:\n", what);
    for (const Note& note : notes) text += fmt::format("# {:>5}  {}\n", note.line, one_line(note.text));
  };
  list("Changed on request", conversion.changes);
  list("Further contents of the file", conversion.notes);
  return text;
}

std::string scene_text(const std::string& file, const std::string& name, const Conversion& conversion) {
  std::string text = header(file, conversion);
  text += fmt::format("\nscene: {}\n", scene::yaml_text(cut(name)));
  text += "\nmechanics:\n  gravity: [0, 0, -9.81]\n";
  if (const auto comments = conversion.comments.find(std::string(multibody::kGroundName));
      comments != conversion.comments.end()) {
    text += "\n# on Ground:\n";
    for (const std::string& comment : comments->second) text += fmt::format("#   {}\n", one_line(comment));
  }
  scene::Scene scene;
  scene.mechanics = conversion.mechanics;
  std::string_view section;
  for (const ElementRef& element : scene::elements(scene)) {
    if (element.section != section) text += fmt::format("\n{}:\n", element.section);
    section = element.section;
    write_element(text, element, conversion);
  }
  return text;
}

// The scene with the triangles of its meshes, as a session publishes it.
std::string text_without_files(const std::string& file, const std::string& name, Conversion conversion) {
  for (multibody::ShapeDef& shape : conversion.mechanics.shapes) {
    const auto mesh = conversion.meshes.find(shape.name);
    if (mesh != conversion.meshes.end()) scene::put_mesh(mesh->second, shape);
  }
  return scene_text(file, name, conversion);
}

// Reads the scene as a run does; reports its problems at the lines of the URDF.
void check(const std::string& text, const Conversion& conversion, int source, scene::Report& report) {
  try {
    (void)scene::load_text(text, "scene");
  } catch (const scene::LoadError& error) {
    for (const scene::Diagnostic& diagnostic : error.diagnostics()) {
      const std::string element = diagnostic.path.substr(0, diagnostic.path.find('.'));
      const auto line = conversion.lines.find(element);
      report.add({source, line == conversion.lines.end() ? 0 : line->second, 0}, diagnostic.path,
                 {diagnostic.what, diagnostic.expected, diagnostic.suggestion});
    }
  }
}

}  // namespace

Import import_file(const std::string& path, RootMount mount, const std::string& scene_file, const Repairs& repairs) {
  scene::Report report;
  const int source = report.add_source(path);
  const auto stop_at_problems = [&] {
    if (!report.is_clean()) report.fail(scene::kMaxReportedProblems);
  };
  const std::optional<scene::SourceText> text = scene::read_source(path, source, report);
  std::optional<Robot> robot = text ? read_robot(*text, report) : std::nullopt;
  stop_at_problems();
  const std::filesystem::path file(path), scene(scene_file.empty() ? path : scene_file);
  const Folders folders{file.parent_path(), scene.parent_path()};
  find_starts(*robot);
  std::vector<Note> changes;
  settle_mass_properties(*robot, mount, repairs, changes, [&](int line, std::string what, std::string expected) {
    report.add({source, line, 0}, "", {std::move(what), std::move(expected), ""});
  });
  stop_at_problems();
  Conversion conversion = convert(*robot, mount, folders);
  conversion.changes = std::move(changes);
  if (conversion.mechanics.bodies.empty()) {
    report.add({source, 0, 0}, "", {"no link of the robot has mass", "a machine: <inertial> in its links", ""});
  }
  stop_at_problems();
  Import result;
  const std::string name = file.filename().string();
  result.text = scene_text(name, robot->name, conversion);
  check(text_without_files(name, robot->name, conversion), conversion, source, report);
  stop_at_problems();
  result.notes = std::move(conversion.notes);
  result.changes = std::move(conversion.changes);
  result.bodies = conversion.mechanics.bodies.size();
  result.joints = conversion.mechanics.joints.size();
  result.shapes = conversion.mechanics.shapes.size();
  return result;
}

}  // namespace slew::urdf
