// SPDX-License-Identifier: Apache-2.0
// `slewring sessions`: lists the sessions on this domain.
#include <fmt/format.h>

#include <optional>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/json.h"
#include "core/report_table.h"
#include "node/identity.h"
#include "program/add_session_options.h"
#include "session/survey.h"
#include "transport/session_state.h"

namespace slew::cli {
namespace {

using wire::Role;

struct SessionsOptions {
  node::SessionOptions network;
  std::optional<double> seconds;
  bool is_json = false;
};

std::string host_of(const std::string& identity) {
  return identity.substr(0, identity.find('#'));
}

std::string nodes_text(const session::FoundSession& session) {
  std::string text;
  for (std::size_t role = 0; role < wire::kRoles; ++role) {
    const bool is_required = (session.description.required_roles & (1u << role)) != 0;
    if (!is_required) continue;
    const wire::NodeStatus& status = session.nodes[role];
    const bool is_paused = static_cast<Role>(role) == Role::io && transport::is_pause(status);
    const std::string state = is_paused ? "paused" : std::string(node::to_text(status.state));
    text += (text.empty() ? "" : ", ") + std::string(node::to_text(static_cast<Role>(role))) + ' ' +
            (session.has_status[role] ? state : "no status");
  }
  return text;
}

Json to_json(const session::FoundSession& session) {
  Json nodes = Json::array();
  for (std::size_t role = 0; role < wire::kRoles; ++role) {
    if ((session.description.required_roles & (1u << role)) == 0) continue;
    const wire::NodeStatus& status = session.nodes[role];
    nodes.push_back({{"role", node::to_text(static_cast<Role>(role))},
                     {"state", session.has_status[role] ? node::to_text(status.state) : "not heard"},
                     {"host", host_of(status.host)},
                     {"pid", status.pid}});
  }
  const wire::SessionDescription& description = session.description;
  return {{"name", description.name},
          {"scene", description.scene_name},
          {"id", node::to_text(description.header.session)},
          {"host", host_of(description.host)},
          {"pid", description.pid},
          {"started_ns", description.started_ns},
          {"step_ns", description.step_ns},
          {"pace", description.pace == Pace::free ? "free" : "real"},
          {"step", session.step},
          {"nodes", nodes}};
}

ExitCode show(const SessionsOptions& options) {
  session::SurveyTime survey = session::SurveyTime::usual(options.network);
  if (options.seconds) survey.quiet = survey.longest = duration_of_seconds(*options.seconds);
  const std::vector<session::FoundSession> sessions = session::find_sessions(options.network, survey);
  if (options.is_json) {
    Json all = Json::array();
    for (const session::FoundSession& session : sessions) all.push_back(to_json(session));
    fmt::print("{}\n", all.dump(2));
    return ExitCode::ok;
  }
  if (sessions.empty()) {
    fmt::print("no session runs on domain {} (interface {})\n", options.network.domain, options.network.interface);
    return ExitCode::ok;
  }
  ReportTable table({"session", "scene", "time", "pace", "owner", "started", "nodes"});
  for (const session::FoundSession& session : sessions) {
    const wire::SessionDescription& description = session.description;
    const double time = static_cast<double>(std::max<StepIndex>(0, session.step) * description.step_ns) * 1e-9;
    table.add({description.name, description.scene_name, fmt::format("{:.2f} s", time),
               description.pace == Pace::free ? "free" : "real",
               fmt::format("process {} on {}", description.pid, host_of(description.host)),
               node::time_text(description.started_ns), nodes_text(session)});
  }
  print_table(table);
  return ExitCode::ok;
}

}  // namespace

void add_sessions(options::Command& program) {
  options::Command verb = program.command("sessions", "list the sessions that run on a domain");
  const auto options = std::make_shared<SessionsOptions>();  // lives as long as the command line's callbacks
  program::add_network_options(verb, options->network);
  verb.option(
          "--time", options->seconds,
          "seconds to listen after the last session or node that was found; without it 1, and while there is none 3, "
          "with --keys 10")
      .between(0.1, 60.0)
      .value_name("S");
  verb.flag("--json", options->is_json, "for machines");
  verb.footer("Example:\n  slewring sessions --interface eth0 --peer 192.168.1.20 --keys plant");
  verb.action([options] { return show(*options); });
}

}  // namespace slew::cli
