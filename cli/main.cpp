// The program `slewring`.
#include "cli/verbs.h"

#include <string_view>

#include "node/node_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  // the node's program has its own options and help
  if (argc > 2 && std::string_view(argv[1]) == "node" && argv[2][0] != '-') return cli::become_node(argc, argv);

  options::Program program("slewring",
                           "Slewring: hydraulically driven working machines as a distributed real-time co-simulation.");
  program.footer(
      "Example:\n"
      "  slewring run scenes/truck_crane.yaml --set Bag.mass=1000kg --duration 10\n\n"
      "Exit codes: 0 ok, 1 failed, 2 usage or bad input or refused, 3 losses, 4 node lost, 5 diverged, 6 storage,\n"
      "7 resources or packages, 130 and 143 ended by a signal.");
  program.require_command();
  for (const auto add :
       {cli::add_run,      cli::add_check,    cli::add_describe,      cli::add_import,   cli::add_variables,
        cli::add_schema,   cli::add_flex,     cli::add_sessions,      cli::add_watch,    cli::add_param,
        cli::add_control,  cli::add_info,     cli::add_plot,          cli::add_animate,  cli::add_export,
        cli::add_recover,  cli::add_replay,   cli::add_compare,       cli::add_tradeoff, cli::add_tradeoff_row,
        cli::add_simplify, cli::add_extremes, cli::add_extremes_case, cli::add_stress,   cli::add_stress_load,
        cli::add_node,     cli::add_keys,     cli::add_doctor,        cli::add_bridge,   cli::add_device,
        cli::add_window}) {
    add(program);
  }
  return node::run_program(program, argc, argv);
}
