// SPDX-License-Identifier: Apache-2.0
#include "session/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/failure.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "transport/cdr/codec.h"

namespace slew::session {
namespace {

constexpr SimDuration kOnlyQuiet = milliseconds(700);          // where one session is usual
constexpr SimDuration kLongestWithKeys = milliseconds(10000);  // on a machine that is busy
constexpr SimDuration kSurveyWait = milliseconds(20);
constexpr int kMostTimes = 10;  // end of a survey in which sessions come up all the time

using Found = std::map<wire::SessionId, FoundSession>;

// True for the first message of a session or of one of its nodes.
bool take(const transport::Received& message, Found& found) {
  switch (message.topic) {
    case wire::Topic::session: {
      wire::SessionDescription description;
      // one in phase JOIN only claims the name
      if (transport::decode(message.bytes, description) && description.header.phase == wire::Phase::running) {
        FoundSession& session = found[description.header.session];
        const bool is_new = session.description.name.empty();
        session.description = std::move(description);
        return is_new;
      }
      return false;
    }
    case wire::Topic::node_status: {
      wire::NodeStatus status;
      if (!transport::decode(message.bytes, status)) return false;
      const auto role = static_cast<std::size_t>(status.header.role);
      if (role >= wire::kRoles) return false;
      FoundSession& session = found[status.header.session];
      const bool is_new = !session.has_status[role];
      session.has_status[role] = true;
      session.nodes[role] = std::move(status);
      return is_new;
    }
    case wire::Topic::health: {
      wire::Health health;
      if (!transport::decode(message.bytes, health)) return false;
      FoundSession& session = found[health.header.session];
      session.step = std::max(session.step, health.header.step);
      return false;
    }
    default:
      return false;
  }
}

bool is_running(const FoundSession& session) {
  const auto io = static_cast<std::size_t>(wire::Role::io);
  const bool is_over = session.has_status[io] && session.nodes[io].state >= wire::NodeState::ended;
  return !session.description.name.empty() && !is_over;
}

// Name of the one session of the domain. Throws Failure when there is none or more than one.
std::string only_session(const node::SessionOptions& options) {
  SurveyTime time = SurveyTime::usual(options);
  time.quiet = kOnlyQuiet;
  const std::vector<FoundSession> sessions = find_sessions(options, time);
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

SurveyTime SurveyTime::usual(const node::SessionOptions& options) noexcept {
  return options.keys.empty() ? SurveyTime{} : SurveyTime{.longest = kLongestWithKeys};
}

std::vector<FoundSession> find_sessions(const node::SessionOptions& options, const SurveyTime& time) {
  const auto transport = node::open_survey(options);
  Found found;
  const std::int64_t last_ns = monotonic_ns() + kMostTimes * std::max(time.quiet.ns, time.longest.ns);
  std::int64_t end_ns = monotonic_ns() + std::max(time.quiet.ns, time.longest.ns);
  while (monotonic_ns() < std::min(end_ns, last_ns) && node::stop_requested.load() == 0) {
    transport::Received message;
    bool is_any_new = false;
    while (transport->take(message)) is_any_new = take(message, found) || is_any_new;
    const bool is_any_running =
        std::any_of(found.begin(), found.end(), [](const auto& entry) { return is_running(entry.second); });
    if (is_any_new && is_any_running) end_ns = monotonic_ns() + time.quiet.ns;
    const std::int64_t wake_ns = std::min(end_ns, monotonic_ns() + kSurveyWait.ns);
    transport->wait_until(wake_ns);
    // time in which the machine did not run this process
    end_ns += std::max<std::int64_t>(0, monotonic_ns() - wake_ns);
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
  const SimDuration longest = SurveyTime::usual(options).longest;
  if (found->wait_for([&] { return found->view().has_session(); }, longest)) return found;
  if (const int stop = node::stop_requested.load(); stop != 0)
    throw Failure(static_cast<ExitCode>(stop), "interrupted");
  throw Failure(ExitCode::failed, "no session '" + options.session + "' was found on domain " +
                                      std::to_string(options.domain) +
                                      fmt::format(" within {:g} s; see 'slewring sessions', and compare --domain, "
                                                  "--interface, --peer and --keys with those of the session",
                                                  longest.seconds()));
}

}  // namespace slew::session
