// SPDX-License-Identifier: Apache-2.0
// scene_format DOCUMENT: writes all fields into docs/scene-format.md, between its two markers.
// scene_format --schema: prints the JSON Schema.
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "core/status.h"
#include "scene/schema.h"

namespace {

int fail(const std::string& text, slew::ExitCode code) {
  std::fprintf(stderr, "scene_format: %s\n", text.c_str());
  return static_cast<int>(code);
}

int rewrite(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) return fail(path + " cannot be read", slew::ExitCode::bad_input);
  const std::string document = slew::scene::with_field_reference(text.str());
  if (document.empty())
    return fail(path + " lacks the two markers; see libs/scene/schema.h", slew::ExitCode::bad_input);
  std::ofstream out(path);
  out << document;
  out.close();
  return out ? 0 : fail(path + " cannot be written", slew::ExitCode::storage);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string argument = argc == 2 ? argv[1] : "";
  if (argument.empty()) return fail("expected the document's path or --schema", slew::ExitCode::bad_input);
  if (argument != "--schema") return rewrite(argument);
  std::fputs(slew::scene::json_schema().c_str(), stdout);
  return 0;
}
