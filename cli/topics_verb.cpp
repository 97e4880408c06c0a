// SPDX-License-Identifier: Apache-2.0
// `slewring topics`: rate, size and delay of the messages on each topic of a running session.
#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/report_table.h"
#include "node/driver.h"
#include "node/open_transport.h"
#include "program/add_session_options.h"
#include "session/survey.h"
#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::cli {
namespace {

constexpr SimDuration kRound = milliseconds(5);  // a delay is not longer by this: messages wake the process

struct TopicsOptions {
  node::SessionOptions session;
  double seconds = 2;
  bool is_json = false;
};

struct Traffic {
  std::int64_t messages = 0;
  double bytes = 0;     // sum
  double delay_ns = 0;  // sum, from the write to the receipt by the clocks of both machines
  double longest_delay_ns = 0;
};

using AllTraffic = std::array<Traffic, wire::kTopics>;

// Messages that were written before it listened, which late readers of some topics receive, are left out.
AllTraffic listen(transport::Transport& transport, SimDuration time) {
  AllTraffic traffic;
  const std::int64_t begin_ns = monotonic_ns(), begin_wall_ns = wall_clock_ns();
  while (monotonic_ns() < begin_ns + time.ns && node::stop_requested.load() == 0) {
    transport::Received message;
    while (transport.take(message)) {
      if (message.source_ns < begin_wall_ns) continue;
      Traffic& of_topic = traffic[static_cast<std::size_t>(message.topic)];
      const auto delay_ns = static_cast<double>(wall_clock_ns() - message.source_ns);
      ++of_topic.messages;
      of_topic.bytes += static_cast<double>(message.bytes.size());
      of_topic.delay_ns += delay_ns;
      of_topic.longest_delay_ns = std::max(of_topic.longest_delay_ns, delay_ns);
    }
    transport.wait_until(std::min(begin_ns + time.ns, monotonic_ns() + kRound.ns));
  }
  return traffic;
}

std::string roles_text(std::uint32_t bits) {
  std::string text;
  for (const transport::RoleTraits& role : transport::roles()) {
    if ((bits & (1u << static_cast<unsigned>(role.role))) == 0) continue;
    text += (text.empty() ? "" : ", ") + std::string(role.name);
  }
  return text;
}

// Nodes of the session, and other programs, by the table of roles.
std::uint32_t roles_of(std::uint32_t required, wire::Topic topic,
                       const transport::TopicSet transport::RoleTraits::*set) {
  std::uint32_t bits = 0;
  for (const transport::RoleTraits& role : transport::roles()) {
    const std::uint32_t bit = 1u << static_cast<unsigned>(role.role);
    const bool is_there = role.needed == transport::Needed::never || (required & bit) != 0;
    if (is_there && (role.*set).contains(topic)) bits |= bit;
  }
  return bits;
}

ExitCode show(TopicsOptions options) {
  node::install_signal_handlers();
  std::uint32_t required = 0;
  {
    const auto observer = session::find_session(options.session, session::Access::look);
    options.session.session = observer->session_name();
    required = observer->view().session().required_roles;
  }
  const transport::TopicSet readable = node::listener_topics(options.session);
  const auto transport = node::open_listener(options.session);
  const AllTraffic all = listen(*transport, duration_of_seconds(options.seconds));
  ReportTable table({{"topic", "topic", "topic"},
                     {"messages/s", "rate [1/s]", "rate"},
                     {"bytes", "size [B]", "size"},
                     {"kB/s", "throughput [B/s]", "throughput"},
                     {"delay", "delay [s]", "delay"},
                     {"longest", "longest delay [s]", "longest_delay"},
                     {"writers", "writers", "writers"},
                     {"written by", "written by", "written_by"},
                     {"read by", "read by", "read_by"}});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto topic = static_cast<wire::Topic>(i);
    const Traffic& of_topic = all[i];
    const auto messages = static_cast<double>(of_topic.messages);
    std::vector<ReportCell> row = {transport::traits(topic).name};
    if (!readable.contains(topic)) {
      for (int cell = 0; cell < 6; ++cell) row.push_back({"-", Json()});
    } else {
      const bool is_any = of_topic.messages > 0;
      const double rate = messages / options.seconds, throughput = of_topic.bytes / options.seconds;
      const double size = is_any ? of_topic.bytes / messages : 0, delay = is_any ? of_topic.delay_ns / messages : 0;
      row.push_back({fmt::format("{:.1f}", rate), rate});
      row.push_back(is_any ? ReportCell(fmt::format("{:.0f}", size), size) : ReportCell("-", Json()));
      row.push_back({fmt::format("{:.1f}", throughput * 1e-3), throughput});
      row.push_back(is_any ? ReportCell(fmt::format("{:.0f} us", delay * 1e-3), delay * 1e-9)
                           : ReportCell("-", Json()));
      row.push_back(is_any ? ReportCell(fmt::format("{:.0f} us", of_topic.longest_delay_ns * 1e-3),
                                        of_topic.longest_delay_ns * 1e-9)
                           : ReportCell("-", Json()));
      const std::size_t writers = transport->discovered_writers(topic).size();
      row.push_back({std::to_string(writers), writers});
    }
    row.emplace_back(roles_text(roles_of(required, topic, &transport::RoleTraits::writes)));
    row.emplace_back(roles_text(roles_of(required, topic, &transport::RoleTraits::reads)));
    table.add(std::move(row));
  }
  if (options.is_json) {
    fmt::print(
        "{}\n",
        Json({{"session", options.session.session}, {"seconds", options.seconds}, {"topics", table.json()}}).dump(2));
  } else {
    print_table(table);
  }
  return static_cast<ExitCode>(node::stop_requested.load());
}

}  // namespace

void add_topics(options::Command& program) {
  options::Command verb =
      program.command("topics", "rate, size and delay of the messages of a running session, by topic");
  const auto options = std::make_shared<TopicsOptions>();  // lives as long as the command line's callbacks
  program::add_session_options(verb, options->session, false);
  verb.option("--time", options->seconds, "seconds to listen").between(0.1, 60.0).value_name("S").show_default();
  verb.flag("--json", options->is_json, "for machines, in SI units");
  verb.footer(
      "Reads all topics, which costs their writers the time of one more reader; with keys those that the keys allow, "
      "the others show '-'. Delays are those between the clocks of two machines where a writer is on another one. "
      "'writers' counts what the middleware sees; 'written by' and 'read by' name the roles that may.\n\n"
      "Example:\n  slewring topics --session truck_crane --time 5");
  verb.action([options] { return show(*options); });
}

}  // namespace slew::cli
