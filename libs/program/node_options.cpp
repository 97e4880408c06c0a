// SPDX-License-Identifier: Apache-2.0
#include "program/node_options.h"

#include "node/identity.h"
#include "program/add_session_options.h"

namespace slew::program {
namespace {

std::string problem_of_session_id(const std::string& id) {
  return node::session_id_of(id) ? "" : "a session's id has 32 hexadecimal digits";
}

}  // namespace

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

}  // namespace slew::program
