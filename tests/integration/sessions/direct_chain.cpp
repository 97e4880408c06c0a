// SPDX-License-Identifier: Apache-2.0
#include "direct_chain.h"

#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "node/physics_node.h"
#include "node/subsystem_factory.h"
#include "program.h"
#include "recorder_node/recorder_node.h"
#include "scene/scene_options.h"
#include "session/monolithic_session.h"
#include "support/crane_pair.h"
#include "transport/in_process/in_process_bus.h"

namespace slew::testing {

using wire::Role;

scene::Scene load_scene(const std::string& file, const std::string& duration,
                        const std::vector<std::string>& overrides) {
  scene::SceneOptions options;
  options.file = file;
  options.duration = duration;
  options.pace = "free";
  options.overrides = overrides;
  return scene::load_scene(options);
}

HashChain chain_of_ticks(const scene::Scene& scene, const std::map<StepIndex, wire::Tick>& ticks) {
  CranePair pair(scene);
  const auto hashes = [&] { return StepHashes{0, pair.mechanics->state_hash(), pair.hydraulics->state_hash()}; };
  HashChain chain;
  chain[kJoinStep].mechanics = pair.start();
  chain[0] = hashes();
  for (const auto& [step, tick] : ticks) {
    if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0 || step < 0) continue;
    for (const wire::Command& command : tick.commands) {
      const coupling::ParameterChange change{command.path, command.value, {command.over_ns}};
      pair.mechanics->change_parameter(step, change);
      pair.hydraulics->change_parameter(step, change);
    }
    pair.step(tick.controls.span());
    chain[step + 1] = hashes();
  }
  return chain;
}

namespace {

// All nodes on this thread, with a recorder when `runs` names its folder. The physics hashes after the last step.
StepHashes run_nodes(const scene::Scene& scene, const std::filesystem::path& runs) {
  transport::InProcessBus bus;
  std::vector<std::unique_ptr<transport::Transport>> ends;
  const auto endpoint = [&](Role role) -> transport::Transport& {
    return *ends.emplace_back(node::open_transport(role, bus));
  };
  const auto wanted = runs.empty() ? io_node::Recording::none : io_node::Recording::required;
  io_node::IoConfig config = io_node::make_config(scene, "in_process", wanted);
  config.name_check = {};
  io_node::IoNode io(endpoint(Role::io), std::move(config));
  std::map<Role, const coupling::Subsystem*> subsystems;
  const auto physics = [&](Role role) {
    const auto make = [role, &subsystems](const scene::Scene& s) {
      auto subsystem = session::SubsystemFamily().make(role, s);
      subsystems[role] = subsystem.get();
      return subsystem;
    };
    return std::make_unique<node::PhysicsNode>(role, endpoint(role), node::subsystem_factory(make, "."));
  };
  const auto mechanics = physics(Role::mechanics), hydraulics = physics(Role::hydraulics);
  std::vector<node::Node*> nodes = {&io, mechanics.get(), hydraulics.get()};
  std::unique_ptr<recorder_node::RecorderNode> recorder;
  if (!runs.empty()) {
    recorder_node::RecorderConfig recording;
    recording.runs_directory = runs;
    recorder = std::make_unique<recorder_node::RecorderNode>(endpoint(Role::recorder), std::move(recording));
    nodes.push_back(recorder.get());
  }
  const ExitCode code = node::run_together(nodes, {});
  if (code != ExitCode::ok) {
    throw std::runtime_error("the run in one process ended with an error: " + io.member().reason());
  }
  return {0, subsystems.at(Role::mechanics)->state_hash(), subsystems.at(Role::hydraulics)->state_hash()};
}

}  // namespace

RecordedSession run_in_one_process(const scene::Scene& scene, const std::filesystem::path& runs) {
  run_nodes(scene, runs);
  return read_session(runs);
}

StepHashes last_hashes_without_recorder(const scene::Scene& scene) {
  return run_nodes(scene, {});
}

HashChain undisturbed_chain(const std::string& scene_file, StepIndex steps) {
  const ScratchFolder folder;
  return run_in_one_process(load_scene(scene_file, std::to_string(steps) + " ms"), folder.path() / "runs").chain();
}

HashChain physics_only(HashChain chain) {
  for (auto& [step, hashes] : chain) hashes.io = 0;
  return chain;
}

}  // namespace slew::testing
