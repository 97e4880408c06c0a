// The program mechanics_node: the mechanism of a session's scene as a process of its own.
#include "mechanics_node/mechanics_subsystem.h"

#include "node/node_program.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "node/subsystem_factory.h"

namespace {

using namespace slew;

std::optional<ExitCode> run(const node::NodeOptions& options) {
  node::apply_real_time(options, "mechanics_node");
  const auto transport = node::open_transport(wire::Role::mechanics, options.session);
  node::PhysicsNode node(
      wire::Role::mechanics, *transport,
      node::subsystem_factory([](const scene::Scene& scene) { return mechanics::make_mechanics_subsystem(scene); },
                              options.assets),
      options.join());
  node.add_work(microseconds(static_cast<std::int64_t>(options.added_work_us)));
  return node::run_node(node);
}

}  // namespace

int main(int argc, char** argv) {
  options::Program program(
      "mechanics_node", "Mechanics of a Slewring session: bodies, joints, forces. Takes the scene from the session.");
  program.footer(
      "Example, on the machine that computes the mechanics:\n"
      "  mechanics_node --session truck_crane --interface eth0 --peer 192.168.1.20 "
      "--keys for_crane2");
  node::NodeOptions options;
  node::add_physics_node_options(program, options);
  program.action([&] { return node::run_until_in_session([&] { return run(options); }); });
  return node::run_program(program, argc, argv);
}
