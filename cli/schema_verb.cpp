// `slewring schema`: the scene format for editors and programs.
#include <fmt/format.h>

#include "cli/verbs.h"
#include "scene/schema.h"

namespace slew::cli {

void add_schema(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("schema", "print the JSON Schema of scene files");
  const auto is_table = std::make_shared<bool>(false);  // lives as long as the command line's callbacks
  verb->add_flag("--table", *is_table, "as tables for people (Markdown): fields, dimensions, ranges, defaults");
  verb->footer("Example:\n  slewring schema > slewring.schema.json");
  verb->callback([&action, is_table] {
    action = [is_table] {
      fmt::print("{}\n", *is_table ? scene::field_reference() : scene::json_schema());
      return ExitCode::ok;
    };
  });
}

}  // namespace slew::cli
