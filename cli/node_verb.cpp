// SPDX-License-Identifier: Apache-2.0
// `slewring node ROLE`: one node of a session, in the place of this process.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "cli/verbs.h"
#include "core/installation.h"
#include "core/node_names.h"
#include "core/suggestion.h"

namespace slew::cli {

int become_node(const std::vector<std::string>& words) {
  const std::string& role = words.at(0);
  if (std::find(std::begin(kNodeNames), std::end(kNodeNames), role) == std::end(kNodeNames)) {
    const std::string meant = closest(role, {std::begin(kNodeNames), std::end(kNodeNames)});
    fmt::print(stderr, "slewring: there is no role '{}'; nothing was started; {}\n", role,
               meant.empty() ? fmt::format("roles: {}", fmt::join(kNodeNames, ", "))
                             : fmt::format("did you mean '{}'?", meant));
    return static_cast<int>(ExitCode::bad_input);
  }
  const std::string program = sibling_program(role + "_node");
  std::vector<char*> arguments = {const_cast<char*>(program.c_str())};
  std::transform(words.begin() + 1, words.end(), std::back_inserter(arguments),
                 [](const std::string& word) { return const_cast<char*>(word.c_str()); });
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  std::fprintf(stderr, "slewring: cannot start %s (%s); build it, or install all programs together\n", program.c_str(),
               strerror(errno));
  return static_cast<int>(ExitCode::resources);
}

void add_node(options::Command& program) {
  options::Command verb = program.command("node", "run one node of a session, here or on this machine's part of it");
  // read by main() already where it is given: for the help, the manual and completion
  const auto role = std::make_shared<std::string>();
  verb.option("role", *role, "role of the node")
      .one_of({std::begin(kNodeNames), std::end(kNodeNames)})
      .value_name("ROLE");
  verb.footer(
      fmt::format("Roles: {}. io owns the session and takes its SCENE.\n"
                  "'slewring node ROLE --help' lists the options of a role.\n\n"
                  "Example:\n  slewring node hydraulics --session truck_crane --interface eth0 --peer 192.168.1.10 "
                  "--keys for_crane2",
                  fmt::join(kNodeNames, ", ")));
  verb.action([role]() -> ExitCode {
    std::fprintf(stderr, "slewring: a role is missing; nothing was started; see 'slewring node --help'\n");
    return ExitCode::bad_input;
  });
}

}  // namespace slew::cli
