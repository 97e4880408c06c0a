#include "direct_chain.h"

#include <array>
#include <stdexcept>

#include "cli/direct_session.h"
#include "cli_support/carrier.h"
#include "cli_support/scene_options.h"
#include "cli_support/subsystem_factory.h"
#include "io_node/scene_config.h"
#include "node/driver.h"
#include "node/physics_node.h"
#include "recorder_node/recorder_node.h"
#include "transport/in_process_bus.h"

namespace slew::testing {

using wire::Role;

scene::Scene load_scene(const std::string& file, const std::string& duration,
                        const std::vector<std::string>& overrides) {
  cli_support::SceneOptions options;
  options.file = file;
  options.duration = duration;
  options.pace = "free";
  options.overrides = overrides;
  return cli_support::load_scene(options);
}

HashChain chain_of_ticks(const scene::Scene& scene, const std::map<StepIndex, wire::Tick>& ticks) {
  cli::DirectSession session(scene);
  if (const Status status = session.start(); !status.is_ok()) throw std::runtime_error(status.text);
  HashChain chain;
  const auto keep = [&](StepIndex step) {
    chain[step] = {0, session.state_hash(Role::mechanics), session.state_hash(Role::hydraulics)};
  };
  chain[kJoinStep].mechanics = session.init_hash();
  keep(0);
  for (const auto& [step, tick] : ticks) {
    if ((tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0 || step < 0) continue;
    session.step(step, tick.commands, tick.controls.span());
    keep(step + 1);
  }
  return chain;
}

RecordedSession run_in_one_process(const scene::Scene& scene, const std::filesystem::path& runs) {
  transport::InProcessBus bus;
  std::array<std::unique_ptr<transport::Transport>, 4> ends;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    constexpr std::array<Role, 4> kRoles = {Role::io, Role::mechanics, Role::hydraulics, Role::recorder};
    ends[i] = cli_support::open_carrier(kRoles[i], bus);
  }
  io::IoConfig config = io::make_config(scene, {"in_process", io::Operator::script, io::Recording::required});
  config.name_check = {};
  io::IoNode io(*ends[0], std::move(config));
  const auto physics = [](Role role) {
    return cli_support::subsystem_factory([role](const scene::Scene& s) { return cli::make_subsystem(role, s); }, ".");
  };
  node::PhysicsNode mechanics(Role::mechanics, *ends[1], physics(Role::mechanics), milliseconds(10'000));
  node::PhysicsNode hydraulics(Role::hydraulics, *ends[2], physics(Role::hydraulics), milliseconds(10'000));
  recorder::RecorderConfig recording;
  recording.runs_directory = runs;
  recorder::RecorderNode recorder(*ends[3], std::move(recording));
  const std::array<node::Node*, 4> nodes = {&io, &mechanics, &hydraulics, &recorder};
  const ExitCode code = node::run_together(nodes, {});
  if (code != ExitCode::ok)
    throw std::runtime_error("the run in one process ended with an error: " + io.member().reason());
  return read_session(runs);
}

HashChain physics_only(HashChain chain) {
  for (auto& [step, hashes] : chain) hashes.io = 0;
  return chain;
}

}  // namespace slew::testing
