// SPDX-License-Identifier: Apache-2.0
// The program io_node: owner of a session, its clock, its operator input and its commands.
#include "core/failure.h"
#include "io_node/io_node.h"
#include "io_node/session_scene.h"
#include "node/open_transport.h"
#include "program/add_scene_options.h"
#include "program/node_options.h"
#include "program/node_program.h"
#include "scene/scene_options.h"
#include "transport/roles.h"

namespace {

using namespace slew;

struct IoOptions {
  program::NodeOptions node;
  scene::SceneOptions scene;
};

ExitCode run(const IoOptions& options) {
  program::apply_real_time(options.node, "io_node");
  const io_node::SessionScene session = io_node::load_session_scene(options.scene);
  const auto transport = node::open_transport(wire::Role::io, options.node.session);
  const auto recording = options.scene.is_recording ? io_node::Recording::required : io_node::Recording::none;
  io_node::IoConfig config = io_node::make_config(session, options.node.session.session, recording);
  config.join_timeout = options.node.join().join_timeout;
  // on loopback every controller has this host's clock
  const bool is_on_loopback = options.node.session.interface == node::SessionOptions{}.interface;
  config.controllers_clock = is_on_loopback ? node::WriterClock::same : node::WriterClock::other;
  io_node::IoNode node(*transport, std::move(config));
  return program::run_node(node).value();  // io follows no session of another node
}

}  // namespace

int main(int argc, char** argv) {
  options::Program program(
      "io_node",
      "Owner of a Slewring session: publishes the scene, gives the clock, takes operator input and commands.");
  program.footer(
      "Example; the other nodes of the session find it by its name:\n"
      "  slewring node io scenes/truck_crane.yaml --session truck_crane --interface eth0 --peer 192.168.1.10 "
      "--keys plant");
  IoOptions options;
  options.node.priority = transport::traits(wire::Role::io).priority;
  program::add_scene_options(program, options.scene);
  program::add_node_options(program, options.node);
  program::add_join_timeout(program, options.node);
  program.action([&] { return run(options); });
  return program::run_program(program, argc, argv);
}
