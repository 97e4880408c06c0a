// SPDX-License-Identifier: Apache-2.0
// `slewring schema`: the formats of scenes and of flexible bodies for editors and programs.
#include <fmt/format.h>

#include "cli/verbs.h"
#include "scene/schema.h"

namespace slew::cli {

void add_schema(options::Command& program) {
  options::Command verb = program.command("schema", "print the JSON Schema of scene files");
  // both live as long as the command line's callbacks
  const auto is_table = std::make_shared<bool>(false), is_flexible = std::make_shared<bool>(false);
  verb.flag("--table", *is_table, "as text for people (Markdown): fields, dimensions, ranges, defaults");
  verb.flag("--flexible", *is_flexible, "of descriptions of flexible bodies instead");
  verb.footer("Example:\n  slewring schema > slewring.schema.json");
  verb.action([is_table, is_flexible] {
    if (*is_flexible) {
      fmt::print("{}\n", *is_table ? scene::flexible_field_reference() : scene::flexible_json_schema());
    } else {
      fmt::print("{}\n", *is_table ? scene::field_reference() : scene::json_schema());
    }
    return ExitCode::ok;
  });
}

}  // namespace slew::cli
