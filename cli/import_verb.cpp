// SPDX-License-Identifier: Apache-2.0
// `slewring import urdf FILE [-o SCENE]`: makes a scene from a robot's URDF file.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "urdf/import.h"

namespace slew::cli {
namespace {

struct ImportOptions {
  std::string file;
  std::string output;  // empty: standard output
  bool is_floating = false;
  bool is_overwriting = false;
  bool is_json = false;
  urdf::Repairs repairs;
};

void write(const std::string& path, const std::string& text, bool is_overwriting) {
  std::error_code error;
  if (!is_overwriting && std::filesystem::exists(path, error)) {
    throw Failure(ExitCode::bad_input,
                  "'" + path + "' is there already; nothing was written; name another file or add --force");
  }
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw Failure(ExitCode::storage, "'" + path + "' cannot be written; name another file");
}

Json to_json(const ImportOptions& options, const urdf::Import& made) {
  const auto listed = [](const std::vector<urdf::Note>& notes) {
    Json list = Json::array();
    for (const urdf::Note& note : notes) list.push_back({{"line", note.line}, {"text", note.text}});
    return list;
  };
  Json json = {{"bodies", made.bodies},
               {"joints", made.joints},
               {"shapes", made.shapes},
               {"notes", listed(made.notes)},
               {"changes", listed(made.changes)}};
  if (options.output.empty()) {
    json["scene"] = made.text;
  } else {
    json["file"] = options.output;
  }
  return json;
}

ExitCode import_urdf(const ImportOptions& options) {
  const auto mount = options.is_floating ? urdf::RootMount::floating : urdf::RootMount::fixed;
  const urdf::Import made = urdf::import_file(options.file, mount, options.output, options.repairs);
  if (!options.output.empty()) write(options.output, made.text, options.is_overwriting);
  if (options.is_json) {
    fmt::print("{}\n", to_json(options, made).dump(2));
  } else if (options.output.empty()) {
    fmt::print("{}", made.text);
  } else {
    fmt::print("{}: {}, {}, {}, {}\n", options.output, counted(made.bodies, "body", "bodies"),
               counted(made.joints, "joint", "joints"), counted(made.shapes, "shape", "shapes"),
               counted(made.notes.size(), "note on what was not taken over", "notes on what was not taken over"));
    for (const urdf::Note& change : made.changes) {
      fmt::print("  changed: {}:{}: {}\n", options.file, change.line, change.text);
    }
  }
  return ExitCode::ok;
}

}  // namespace

void add_import(options::Command& program) {
  options::Command verb = program.command("import", "make a scene from a file of another program");
  verb.require_command();
  verb.footer("Example:\n  slewring import urdf robot.urdf -o robot.yaml");
  options::Command part = verb.command("urdf", "a robot's tree of links and joints");
  const auto options = std::make_shared<ImportOptions>();  // lives as long as the command line's callbacks
  part.option("file", options->file, "URDF file, macros expanded").required().value_name("FILE");
  part.option("-o,--output", options->output, "the scene's file; without it the scene is printed").value_name("SCENE");
  part.flag("--floating", options->is_floating, "the root link is free, not fixed to Ground");
  const options::Option repair =
      part.flag("--repair", options->repairs.is_repairing,
                "raise principal moments of inertia that no body has (listed); without it they are refused");
  part.option("--repair-share", options->repairs.share,
              "largest share of the largest moment that --repair may add to the others")
      .between(0.0, 1.0)
      .show_default()
      .value_name("SHARE")
      .needs(repair);
  part.flag("--merge", options->repairs.is_merging,
            "fix joints of links that move without mass or inertia (listed); without it they are refused");
  part.flag("--force", options->is_overwriting, "overwrite the scene's file");
  part.flag("--json", options->is_json, "for machines: counts and notes, and the scene when no file is named");
  part.footer("Example:\n  slewring import urdf robot.urdf -o robot.yaml && slewring check robot.yaml");
  part.action([options] { return import_urdf(*options); });
}

}  // namespace slew::cli
