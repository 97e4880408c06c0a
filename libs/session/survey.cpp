// SPDX-License-Identifier: Apache-2.0
#include "session/survey.h"

#include <algorithm>
#include <map>

#include "core/failure.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

constexpr SimDuration kSurveyTime = milliseconds(700);
constexpr SimDuration kLongestSurvey = milliseconds(3000);  // on a machine that is busy
constexpr SimDuration kSurveyWait = milliseconds(20);
constexpr SimDuration kFindTimeout = milliseconds(3000);

using Found = std::map<wire::SessionId, FoundSession>;

void take(const transport::Received& message, Found& found) {
  switch (message.topic) {
    case wire::Topic::session: {
      wire::SessionDescription description;
      // one in phase JOIN only claims the name
      if (transport::decode(message.bytes, description) && description.header.phase == wire::Phase::running) {
        FoundSession& session = found[description.header.session];
        session.description = std::move(description);
      }
      return;
    }
    case wire::Topic::node_status: {
      wire::NodeStatus status;
      if (!transport::decode(message.bytes, status)) return;
      const auto role = static_cast<std::size_t>(status.header.role);
      if (role >= wire::kRoles) return;
      FoundSession& session = found[status.header.session];
      session.has_status[role] = true;
      session.nodes[role] = std::move(status);
      return;
    }
    case wire::Topic::health: {
      wire::Health health;
      if (!transport::decode(message.bytes, health)) return;
      FoundSession& session = found[health.header.session];
      session.step = std::max(session.step, health.header.step);
      return;
    }
    default:
      return;
  }
}

bool is_running(const FoundSession& session) {
  const auto io = static_cast<std::size_t>(wire::Role::io);
  const bool is_over = session.has_status[io] && session.nodes[io].state >= wire::NodeState::ended;
  return !session.description.name.empty() && !is_over;
}

// Name of the one session of the domain. Throws Failure when there is none or more than one.
std::string only_session(const node::SessionOptions& options) {
  const std::vector<FoundSession> sessions = find_sessions(options, kSurveyTime, kLongestSurvey);
  if (sessions.size() == 1) return sessions.front().description.name;
  if (sessions.empty()) {
    throw Failure(ExitCode::failed,
                  "no session runs on domain " + std::to_string(options.domain) +
                      "; start one with 'slewring run SCENE', or name its --domain, --interface, --peer and --keys");
  }
  std::string names;
  for (const FoundSession& session : sessions) names += (names.empty() ? "" : ", ") + session.description.name;
  throw Failure(ExitCode::bad_input, "several sessions run: " + names + "; name one with --session");
}

}  // namespace

std::vector<FoundSession> find_sessions(const node::SessionOptions& options, SimDuration time, SimDuration longest) {
  const auto transport = node::open_survey(options);
  Found found;
  const std::int64_t begin_ns = monotonic_ns();
  const auto end_ns = [&] {
    const bool is_any =
        std::any_of(found.begin(), found.end(), [](const auto& entry) { return is_running(entry.second); });
    return begin_ns + (is_any ? time.ns : std::max(time.ns, longest.ns));
  };
  while (monotonic_ns() < end_ns() && node::stop_requested.load() == 0) {
    transport::Received message;
    while (transport->take(message)) take(message, found);
    transport->wait_until(std::min(end_ns(), monotonic_ns() + kSurveyWait.ns));
  }
  std::vector<FoundSession> sessions;
  for (auto& [id, session] : found) {
    if (is_running(session)) sessions.push_back(std::move(session));
  }
  std::sort(sessions.begin(), sessions.end(),
            [](const FoundSession& a, const FoundSession& b) { return a.description.name < b.description.name; });
  return sessions;
}

std::unique_ptr<observer::Observer> find_session(node::SessionOptions options, Access access,
                                                 observer::Receiver* receiver) {
  if (options.session.empty()) options.session = only_session(options);
  const wire::Role role = access == Access::control ? wire::Role::controller : wire::Role::observer;
  auto transport = access == Access::look ? node::open_viewer(options) : node::open_transport(role, options);
  auto found = std::make_unique<observer::Observer>(
      std::move(transport),
      observer::ObserverOptions{.session = options.session, .receiver = receiver, .stop = &node::stop_requested});
  if (found->wait_for([&] { return found->view().has_session(); }, kFindTimeout)) return found;
  if (const int stop = node::stop_requested.load(); stop != 0)
    throw Failure(static_cast<ExitCode>(stop), "interrupted");
  throw Failure(ExitCode::failed, "no session '" + options.session + "' was found on domain " +
                                      std::to_string(options.domain) +
                                      " within 3 s; see 'slewring sessions', and compare --domain, --interface, "
                                      "--peer and --keys with those of the session");
}

}  // namespace slew::session
