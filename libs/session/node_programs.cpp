// SPDX-License-Identifier: Apache-2.0
#include "session/node_programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/failure.h"
#include "core/installation.h"
#include "core/real_time_thread.h"
#include "io_node/scene_config.h"
#include "node/identity.h"
#include "transport/roles.h"

namespace slew::session {

using wire::Role;

namespace {

void check_cpu(const scene::CpuPlace& place) {
  const std::vector<int> cpus = usable_cpus();
  if (std::binary_search(cpus.begin(), cpus.end(), place.cpu)) return;
  throw Failure(
      ExitCode::bad_input,
      fmt::format("{}={}: there is no processor {} for this process; there are {}; nothing was started; name one of "
                  "them in --cpu or session.cpus",
                  place.role, place.cpu, place.cpu, cpu_list(cpus)));
}

}  // namespace

NodePrograms::NodePrograms(const RunOptions& options, const scene::Scene& scene)
    : options_(options),
      roles_(io_node::required_roles(
          scene, options.scene.is_recording ? io_node::Recording::required : io_node::Recording::none)) {
  const std::string& places = options.cpus.empty() ? scene.session.cpus : options.cpus;
  require(scene::parse_cpu_places(places, cpus_));
  for (const scene::CpuPlace& place : cpus_) {
    if (const auto role = transport::role_of(place.role)) check_place(*role, place);
  }
}

bool NodePrograms::is_ours(Role role) const {
  const bool is_remote =
      std::find(options_.remote.begin(), options_.remote.end(), node::to_text(role)) != options_.remote.end();
  return (roles_ & bit(role)) != 0 && !is_remote;
}

void NodePrograms::check_place(Role role, const scene::CpuPlace& place) const {
  // the list of a scene may name more than this session has
  if ((roles_ & bit(role)) == 0 && !options_.cpus.empty()) {
    throw Failure(ExitCode::bad_input,
                  fmt::format("--cpu {}={}: this session has no {} node; nothing was started; leave it out", place.role,
                              place.cpu, place.role));
  }
  if (is_ours(role)) check_cpu(place);
}

std::unique_ptr<ChildProcess> NodePrograms::start(Role role, const std::string& session_id) const {
  std::vector<std::string> arguments;
  if (role == Role::io) arguments = scene::scene_arguments(options_.scene);
  if (role != Role::recorder && options_.join_timeout) {
    arguments.insert(arguments.end(), {"--join-timeout", fmt::format("{}", *options_.join_timeout)});
  }
  arguments.insert(arguments.end(), {"--session", options_.session.session});
  if (transport::is_physics(role)) {
    arguments.insert(arguments.end(), {"--assets", options_.assets()});
  }
  if (!session_id.empty()) arguments.insert(arguments.end(), {"--session-id", session_id});
  const std::vector<std::string> network = node::network_arguments(options_.session);
  arguments.insert(arguments.end(), network.begin(), network.end());
  if (role == Role::recorder)
    arguments.insert(arguments.end(),
                     {"--out", options_.runs, "--keep-free", fmt::format("{}", options_.keep_free_mb)});
  if (options_.is_real_time) arguments.emplace_back("--rt");
  for (const scene::CpuPlace& place : cpus_) {
    if (place.role == node::to_text(role)) arguments.insert(arguments.end(), {"--cpu", std::to_string(place.cpu)});
  }
  if (transport::is_physics(role) && options_.added_work_us > 0) {
    arguments.insert(arguments.end(), {"--add-work", fmt::format("{}", options_.added_work_us)});
  }
  const std::string name(node::to_text(role));
  return std::make_unique<ChildProcess>(name, sibling_program(name + "_node"), arguments);
}

std::vector<std::string> NodePrograms::device_arguments(const std::string& name) const {
  std::vector<std::string> arguments = {"--device",     name,       "--session",      options_.session.session,
                                        "--supervised", "--assets", options_.assets()};
  const std::vector<std::string> network = node::network_arguments(options_.session);
  arguments.insert(arguments.end(), network.begin(), network.end());
  if (options_.are_devices_insecure) arguments.emplace_back("--insecure-devices");
  return arguments;
}

}  // namespace slew::session
