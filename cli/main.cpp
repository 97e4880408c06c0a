// SPDX-License-Identifier: Apache-2.0
// The program `slewring`.
#include "cli/verbs.h"

#include <algorithm>
#include <string>
#include <vector>

#include "program/node_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  // the node's program has its own options, help and completion
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.size() > 1 && words[0] == "node" && !words[1].starts_with("-")) {
    return cli::become_node({words.begin() + 1, words.end()});
  }
  if (words.size() > 3 && words[0] == "--complete" && words[1] == "node") {
    std::vector<std::string> of_node = {words[2], words[0]};
    of_node.insert(of_node.end(), words.begin() + 3, words.end());
    return cli::become_node(of_node);
  }

  options::Program program("slewring",
                           "Slewring: hydraulically driven working machines as a distributed real-time co-simulation.");
  program.footer(
      "Example:\n"
      "  slewring run scenes/truck_crane.yaml --set Bag.mass=1000kg --duration 10\n\n"
      "Exit codes: 0 ok, 1 failed, 2 usage or bad input or refused, 3 losses, 4 node lost, 5 diverged, 6 storage,\n"
      "7 resources or packages, 130 and 143 ended by a signal.\n\n"
      "Environment: SLEWRING_DOMAIN, SLEWRING_INTERFACE, SLEWRING_KEYS and SLEWRING_MIDDLEWARE stand for the options\n"
      "--domain, --interface, --keys and --middleware where these are not given. Controllers with the client library\n"
      "take SLEWRING_KEYS, SLEWRING_IDENTITY and SLEWRING_INSECURE_LAN=1. NO_COLOR: no colours on a terminal.");
  program.require_command();
  for (const auto add :
       {cli::add_run,       cli::add_check,         cli::add_describe,  cli::add_draw,         cli::add_import,
        cli::add_variables, cli::add_schema,        cli::add_flex,      cli::add_sessions,     cli::add_topics,
        cli::add_watch,     cli::add_param,         cli::add_control,   cli::add_info,         cli::add_plot,
        cli::add_animate,   cli::add_export,        cli::add_recover,   cli::add_slice,        cli::add_merge,
        cli::add_replay,    cli::add_compare,       cli::add_fit,       cli::add_fit_row,      cli::add_sweep,
        cli::add_sweep_row, cli::add_sweep_part,    cli::add_tradeoff,  cli::add_tradeoff_row, cli::add_simplify,
        cli::add_extremes,  cli::add_extremes_case, cli::add_loadchart, cli::add_stress,       cli::add_stress_load,
        cli::add_node,      cli::add_keys,          cli::add_doctor,    cli::add_bridge,       cli::add_device,
        cli::add_window}) {
    add(program);
  }
  cli::add_help(program);
  return program::run_program(program, argc, argv);
}
