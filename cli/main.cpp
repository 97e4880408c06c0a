// The program `slewring`.
#include "cli/verbs.h"

#include <string_view>

#include "cli_support/node_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  // a node's own options and help are the node's matter
  if (argc > 2 && std::string_view(argv[1]) == "node" && argv[2][0] != '-') return cli::become_node(argc, argv);

  CLI::App app("Slewring: hydraulically driven working machines as a distributed real-time co-simulation.", "slewring");
  app.footer(
      "Example:\n"
      "  slewring run scenes/truck_crane.yaml --set Bag.mass=1000kg --duration 10\n\n"
      "Exit codes: 0 ok, 1 failed, 2 usage or bad input or refused, 3 losses, 4 node lost, 5 diverged, 6 storage,\n"
      "7 resources or packages, 130 and 143 ended by a signal.");
  cli_support::add_version(app);
  app.require_subcommand(1);
  cli::Action action;
  cli::add_run(app, action);
  cli::add_check(app, action);
  cli::add_describe(app, action);
  cli::add_import(app, action);
  cli::add_variables(app, action);
  cli::add_schema(app, action);
  cli::add_flex(app, action);
  cli::add_sessions(app, action);
  cli::add_watch(app, action);
  cli::add_param(app, action);
  cli::add_control(app, action);
  cli::add_info(app, action);
  cli::add_plot(app, action);
  cli::add_animate(app, action);
  cli::add_export(app, action);
  cli::add_recover(app, action);
  cli::add_replay(app, action);
  cli::add_compare(app, action);
  cli::add_tradeoff(app, action);
  cli::add_tradeoff_row(app, action);
  cli::add_simplify(app, action);
  cli::add_extremes(app, action);
  cli::add_extremes_case(app, action);
  cli::add_stress(app, action);
  cli::add_stress_load(app, action);
  cli::add_node(app, action);
  cli::add_keys(app, action);
  cli::add_doctor(app, action);
  int exit_code = 0;
  if (!cli_support::parse(app, argc, argv, exit_code)) return exit_code;
  return cli_support::guarded("slewring", action);
}
