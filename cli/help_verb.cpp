// SPDX-License-Identifier: Apache-2.0
// `slewring help [VERB...]`: the same text as `slewring VERB --help`.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/verbs.h"

namespace slew::cli {

void add_help(options::Program& program) {
  options::Command verb = program.command("help", "explain a verb, or the program");
  const auto verbs = std::make_shared<std::vector<std::string>>();
  std::vector<std::string> names;
  for (const options::CommandText& one : program.text().commands) names.push_back(one.name);
  std::sort(names.begin(), names.end());
  verb.option("verb", *verbs, "verb and its own verb; one of: " + fmt::format("{}", fmt::join(names, ", ")))
      .value_name("VERB");
  verb.footer("Examples:\n  slewring help run\n  slewring help control pause\n  slewring help node mechanics");
  verb.action([verbs, &program] {
    // a role's program has its own options
    if (verbs->size() == 2 && verbs->front() == "node") {
      return static_cast<ExitCode>(become_node({verbs->back(), "--help"}));
    }
    fmt::print("{}", program.find_command(*verbs).help());
    return ExitCode::ok;
  });
}

}  // namespace slew::cli
