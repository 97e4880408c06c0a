// `slewring import urdf FILE [-o SCENE]`: makes a scene from a robot's URDF file.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "cli/display.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "urdf/import.h"

namespace slew::cli {
namespace {

struct Options {
  std::string file;
  std::string output;  // empty: standard output
  bool is_floating = false;
  bool is_overwriting = false;
  bool is_json = false;
};

void write(const std::string& path, const std::string& text, bool is_overwriting) {
  std::error_code error;
  if (!is_overwriting && std::filesystem::exists(path, error)) {
    throw Failure(ExitCode::bad_input,
                  "'" + path + "' is there already; nothing was written; name another file or say --force");
  }
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw Failure(ExitCode::storage, "'" + path + "' cannot be written; name another file");
}

Json to_json(const Options& options, const urdf::Import& made) {
  Json notes = Json::array();
  for (const urdf::Note& note : made.notes) notes.push_back({{"line", note.line}, {"text", note.text}});
  Json json = {{"bodies", made.bodies}, {"joints", made.joints}, {"shapes", made.shapes}, {"notes", notes}};
  if (options.output.empty()) {
    json["scene"] = made.text;
  } else {
    json["file"] = options.output;
  }
  return json;
}

ExitCode import_urdf(const Options& options) {
  const auto mount = options.is_floating ? urdf::RootMount::floating : urdf::RootMount::fixed;
  const urdf::Import made = urdf::import_file(options.file, mount, options.output);
  if (!options.output.empty()) write(options.output, made.text, options.is_overwriting);
  if (options.is_json) {
    fmt::print("{}\n", to_json(options, made).dump(2));
  } else if (options.output.empty()) {
    fmt::print("{}", made.text);
  } else {
    fmt::print("{}: {}, {}, {}, {}\n", options.output, counted(made.bodies, "body", "bodies"),
               counted(made.joints, "joint", "joints"), counted(made.shapes, "shape", "shapes"),
               counted(made.notes.size(), "note on what was not taken over", "notes on what was not taken over"));
  }
  return ExitCode::ok;
}

}  // namespace

void add_import(options::Command& program) {
  options::Command verb = program.command("import", "make a scene from a file of another program");
  verb.require_command();
  verb.footer("Example:\n  slewring import urdf robot.urdf -o robot.yaml");
  options::Command part = verb.command("urdf", "a robot's tree of links and joints");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  part.option("file", options->file, "URDF file, macros expanded").required().value_name("FILE");
  part.option("-o,--output", options->output, "the scene's file; without it the scene is printed").value_name("SCENE");
  part.flag("--floating", options->is_floating, "the root link is free, not fixed to Ground");
  part.flag("--force", options->is_overwriting, "overwrite the scene's file");
  part.flag("--json", options->is_json, "for machines: counts and notes, and the scene when no file is named");
  part.footer("Example:\n  slewring import urdf robot.urdf -o robot.yaml && slewring check robot.yaml");
  part.action([options] { return import_urdf(*options); });
}

}  // namespace slew::cli
