// The program flex_node: refuses, because in this version the mechanics holds flexible bodies itself.
#include "cli_support/failure.h"
#include "cli_support/node_program.h"

int main(int argc, char** argv) {
  using namespace slew;
  CLI::App app(
      "Flexible bodies of a Slewring session. In this version the mechanics holds them itself: the program refuses.",
      "flex_node");
  app.footer("Example:\n  flex_node --session truck_crane");
  cli_support::NodeOptions options;
  cli_support::add_physics_node_options(app, options);
  cli_support::add_version(app);
  int exit_code = 0;
  if (!cli_support::parse(app, argc, argv, exit_code)) return exit_code;
  return cli_support::guarded("flex_node", []() -> ExitCode {
    throw cli_support::Failure(
        ExitCode::bad_input,
        "this version has no flex node: the mechanics holds flexible bodies itself; it ends; start "
        "the session without it");
  });
}
