// SPDX-License-Identifier: Apache-2.0
// The program recorder_node: writes all messages of a session into one recording.
#include <cstdio>

#include "node/open_transport.h"
#include "node/subsystem_factory.h"
#include "program/node_options.h"
#include "program/node_program.h"
#include "recorder_node/recorder_node.h"
#include "transport/roles.h"

namespace {

using namespace slew;

std::optional<ExitCode> run(const program::NodeOptions& options, const std::string& runs, double keep_free_mb) {
  program::apply_real_time(options, "recorder_node");
  const auto transport = node::open_transport(wire::Role::recorder, options.session);
  recorder_node::RecorderConfig config;
  config.runs_directory = runs;
  config.keep_free = static_cast<std::uint64_t>(keep_free_mb * 1e6);
  config.join = options.join();
  config.part = recorder_node::part_of_scene;
  recorder_node::RecorderNode node(*transport, std::move(config));
  // the path is printed last, whatever the end was
  struct PrintPath {
    const recorder_node::RecorderNode& node;
    ~PrintPath() {
      if (!node.recording().empty()) std::printf("recording: %s\n", node.recording().c_str());
    }
  } const print_path{node};
  return program::run_node(node);
}

}  // namespace

int main(int argc, char** argv) {
  options::Program program("recorder_node", "Recorder of a Slewring session: one .mcap file in a new folder of --out.");
  program.footer("Example:\n  slewring node recorder --session truck_crane --out /data/runs");
  program::NodeOptions options;
  options.priority = transport::traits(wire::Role::recorder).priority;
  std::string runs = "runs";
  program::add_node_options(program, options);
  program::add_finding_options(program, options);
  program.option("--out", runs, "folder in which the session gets a folder of its own")
      .value_name("DIR")
      .show_default();
  double keep_free_mb = static_cast<double>(recorder_node::kKeepFreeBytes) * 1e-6;
  program.option("--keep-free", keep_free_mb, "space on the file system that is left free; 0: none")
      .between(0.0, 1e9)
      .value_name("MB")
      .show_default();
  program.action([&] { return program::run_until_in_session([&] { return run(options, runs, keep_free_mb); }); });
  return program::run_program(program, argc, argv);
}
