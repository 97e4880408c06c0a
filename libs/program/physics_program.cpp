// SPDX-License-Identifier: Apache-2.0
#include "program/physics_program.h"

#include "node/open_transport.h"
#include "node/physics_node.h"
#include "program/node_program.h"
#include "transport/roles.h"

namespace slew::program {
namespace {

std::string name_of(wire::Role role) {
  return std::string(transport::traits(role).name) + "_node";
}

std::optional<ExitCode> run(const PhysicsProgram& program, const NodeOptions& options) {
  apply_real_time(options, name_of(program.role));
  const auto transport = node::open_transport(program.role, options.session);
  node::PhysicsNode node(program.role, *transport, node::subsystem_factory(program.make, options.assets),
                         options.join());
  node.add_work(microseconds(static_cast<std::int64_t>(options.added_work_us)));
  return run_node(node);
}

}  // namespace

int run_physics_program(const PhysicsProgram& program, int argc, const char* const* argv) noexcept {
  const std::string name = name_of(program.role);
  options::Program frame(name, program.description + " Takes the scene from the session.");
  frame.footer("Example, on the machine that runs this node:\n  slewring node " +
               std::string(transport::traits(program.role).name) + " " + program.example);
  NodeOptions options;
  add_physics_node_options(frame, options);
  frame.action([&] { return run_until_in_session([&] { return run(program, options); }); });
  return run_program(frame, argc, argv);
}

}  // namespace slew::program
