// SPDX-License-Identifier: Apache-2.0
#include "node/session_options.h"

#include <algorithm>
#include <iterator>

#include "transport/wire.h"

namespace slew::node {
namespace {

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

std::string problem_of_session_id(const std::string& id) {
  return node::session_id_of(id) ? "" : "a session's id has 32 hexadecimal digits";
}

}  // namespace

std::string problem_of_session_name(const std::string& name) {
  if (name.empty() || name.size() > wire::kMaxNameLength) return "a session's name has 1 to 63 characters";
  if (!std::all_of(name.begin(), name.end(), is_name_character)) {
    return "a session's name consists of letters, digits, '_', '-' and '.'";
  }
  return "";
}

std::string session_name_of(const std::string& scene) {
  std::string name = scene.substr(0, wire::kMaxNameLength);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_name_character(c); }, '_');
  return name.empty() ? "session" : name;
}

void add_network_options(options::Command& app, SessionOptions& options) {
  app.option("--domain", options.domain, "DDS domain; sessions of different domains do not see each other")
      .between(0u, transport::kMaxDomain)
      .value_name("N")
      .show_default()
      .environment("SLEWRING_DOMAIN")
      .group("Network");
  app.option("--interface", options.interface, "network interface to send on; 'lo' keeps everything on this machine")
      .value_name("IF")
      .show_default()
      .environment("SLEWRING_INTERFACE")
      .group("Network");
  app.option("--peer", options.peers, "address of another machine of the session; repeat or separate by commas")
      .value_name("ADDR")
      .one_value_each()
      .comma_separated()
      .group("Network");
  options::Option keys =
      app.option("--keys", options.keys,
                 "key store (slewring keys): only processes with its keys take part and can read the messages")
          .value_name("DIR")
          .environment("SLEWRING_KEYS")
          .group("Network");
  app.option("--identity", options.identity, "name of the keys in the store; without it those of the role")
      .value_name("NAME")
      .needs(keys)
      .group("Network");
  app.flag("--insecure-lan", options.is_insecure_lan,
           "send beyond this machine without keys: any program on that network can read and steer the session")
      .excludes(keys)
      .group("Network");
  app.option("--middleware", options.middleware,
             "DDS of this program and of those that it starts; nodes of different ones take part in one session")
      .one_of({std::begin(transport::kMiddlewares), std::end(transport::kMiddlewares)})
      .value_name("DDS")
      .show_default()
      .environment("SLEWRING_MIDDLEWARE")
      .group("Network");
}

void add_session_options(options::Command& app, SessionOptions& options, bool is_required) {
  options::Option session = app.option("--session", options.session, "name of the session")
                                .value_name("NAME")
                                .check(problem_of_session_name, "session name")
                                .group("Session");
  if (is_required) session.required();
  add_network_options(app, options);
}

void add_node_options(options::Command& app, NodeOptions& options) {
  add_session_options(app, options.session, true);
  app.flag("--rt", options.is_real_time, "real-time scheduling (SCHED_FIFO) and locked memory").group("Real time");
  app.option("--priority", options.priority, "its priority")
      .between(1, 99)
      .value_name("N")
      .show_default()
      .group("Real time");
  app.option("--cpu", options.cpu, "processor to run on, from 0; without it any")
      .between(0, 1023)
      .value_name("N")
      .group("Real time");
}

void add_join_timeout(options::Command& app, NodeOptions& options) {
  app.option("--join-timeout", options.join_timeout,
             "seconds to wait for the other nodes of the session; of io for lockstep controllers too")
      .between(kShortestJoin, kLongestJoin)
      .value_name("S")
      .show_default()
      .group("Session");
}

void add_finding_options(options::Command& app, NodeOptions& options) {
  app.option("--session-timeout", options.session_timeout, "seconds to wait for the session")
      .between(0.1, 86400.0)
      .value_name("S")
      .show_default()
      .group("Session");
  app.option("--session-id", options.session_id, "take part in the session of this id only, whatever has its name")
      .check(problem_of_session_id, "session id")
      .value_name("HEX")
      .group("Session");
}

void add_physics_node_options(options::Command& app, NodeOptions& options) {
  add_node_options(app, options);
  add_finding_options(app, options);
  add_join_timeout(app, options);
  app.option("--assets", options.assets, "folder with the scene's files (meshes, tables)")
      .value_name("DIR")
      .show_default();
  app.option("--add-work", options.added_work_us,
             "CPU time that every step burns beside its own, to measure the reserve of the machine")
      .between(0.0, 1e6)
      .value_name("US")
      .group("Real time");
}

node::JoinOptions NodeOptions::join() const {
  return {duration_of_seconds(session_timeout), duration_of_seconds(join_timeout), node::session_id_of(session_id)};
}

std::vector<std::string> network_arguments(const SessionOptions& options) {
  // those that the environment would give otherwise too
  std::vector<std::string> arguments = {
      "--domain", std::to_string(options.domain), "--interface", options.interface, "--middleware", options.middleware};
  for (const std::string& peer : options.peers) {
    arguments.push_back("--peer");
    arguments.push_back(peer);
  }
  if (!options.keys.empty()) arguments.insert(arguments.end(), {"--keys", options.keys});
  if (!options.identity.empty()) arguments.insert(arguments.end(), {"--identity", options.identity});
  if (options.is_insecure_lan) arguments.emplace_back("--insecure-lan");
  return arguments;
}

}  // namespace slew::node
