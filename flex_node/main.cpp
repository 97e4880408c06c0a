// The program flex_node: the flexible bodies of a session's scene as a process of its own.
#include "flex_node/flex_subsystem.h"
#include "node/node_program.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "node/subsystem_factory.h"

namespace {

using namespace slew;

std::optional<ExitCode> run(const node::NodeOptions& options) {
  node::apply_real_time(options, "flex_node");
  const auto transport = node::open_transport(wire::Role::flex, options.session);
  node::PhysicsNode node(
      wire::Role::flex, *transport,
      node::subsystem_factory([](const scene::Scene& scene) { return flexible::make_flex_subsystem(scene); },
                              options.assets),
      options.join());
  node.add_work(microseconds(static_cast<std::int64_t>(options.added_work_us)));
  return node::run_node(node);
}

}  // namespace

int main(int argc, char** argv) {
  options::Program program(
      "flex_node",
      "Flexible bodies of a Slewring session: elastic forces, deflection of every node, stress, strain energy. Takes "
      "the scene from the session, the flexible files from --assets.");
  program.footer(
      "Example, on the machine that computes the flexible bodies:\n"
      "  flex_node --session truck_crane_flexible --assets scenes --interface eth0 --peer 192.168.1.20 "
      "--keys for_crane2");
  node::NodeOptions options;
  node::add_physics_node_options(program, options);
  program.action([&] { return node::run_until_in_session([&] { return run(options); }); });
  return node::run_program(program, argc, argv);
}
