// SPDX-License-Identifier: Apache-2.0
#include "io_node/session_variables.h"
#include "transport/roles.h"

namespace slew::io_node {

using node::to_text;
using wire::Phase;
using wire::Role;
using wire::Topic;

namespace {

struct SessionVariable {
  const char* name;
  const char* unit;
};
// variables of the session, and of each physics node from its last health message
constexpr SessionVariable kSessionVariables[] = {{"session.slip", "s"},
                                                 {"session.rejected_inputs", "1"},
                                                 {"session.clamped_inputs", "1"},
                                                 {"session.silent_controllers", "1"},
                                                 {"session.late_controllers", "1"},
                                                 {"session.release_jitter", "s"},
                                                 {"session.response", "s"},
                                                 {"session.lag", "s"},
                                                 {"session.overruns", "1"},
                                                 {"session.skipped_steps", "1"},
                                                 {"session.transitions", "1"},
                                                 {"session.input_latency", "s"}};
constexpr SessionVariable kNodeVariables[] = {{".step_time", "s"},      {".step_time_max", "s"}, {".cpu_time", "s"},
                                              {".release_jitter", "s"}, {".wait", "s"},          {".response", "s"},
                                              {".overruns", "1"},       {".allocations", "1"}};

double seconds(std::int64_t ns) noexcept {
  return static_cast<double>(ns) * 1e-9;
}

constexpr double kNoLoop = -1;  // loop delay of a channel without a controller

}  // namespace

void SessionVariables::receive_health(std::span<const std::byte> bytes) {
  wire::Health health;
  if (!transport::decode(bytes, health)) return;
  const auto role = static_cast<std::size_t>(health.header.role);
  if (role >= healths_.size() || health.header.session != member_.session().header.session) return;
  if (health.header.incarnation == member_.peer(health.header.role).incarnation) healths_[role] = health;
}

std::vector<wire::VariableEntry> own_variables(std::span<const std::string> inputs, std::uint32_t roles) {
  std::vector<wire::VariableEntry> entries;
  for (const std::string& input : inputs) {
    for (const ChannelVariable& variable : kChannelVariables) {
      entries.push_back({input + variable.quantity, variable.unit});
    }
  }
  for (const SessionVariable& variable : kSessionVariables) entries.push_back({variable.name, variable.unit});
  for (const Role role : transport::physics_roles()) {
    if ((roles & bit(role)) == 0) continue;
    for (const SessionVariable& variable : kNodeVariables) {
      entries.push_back({std::string(to_text(role)) + variable.name, variable.unit});
    }
  }
  return entries;
}

void SessionVariables::publish_directory() {
  wire::VariableDirectory directory;
  directory.header = member_.header(Phase::running, 0);
  std::vector<std::string> inputs;
  for (std::size_t i = 0; i < gate_.size(); ++i) inputs.push_back(gate_.config(i).name);
  directory.entries = own_variables(inputs, member_.session().required_roles);
  directory.total = static_cast<std::uint32_t>(directory.entries.size());
  member_.publish(Topic::variable_directory, directory);
}

void SessionVariables::publish_probe() {
  block_.header = member_.header(Phase::join, kJoinStep);
  member_.publish(Topic::variables, block_);
}

void SessionVariables::publish(StepIndex n, std::int64_t now_ns) {
  block_.header = member_.header(Phase::running, n);
  block_.values.clear();
  for (std::size_t i = 0; i < gate_.size(); ++i) add_channel(i, n, now_ns);
  block_.values.push_back(seconds(clock_.slip_ns()));
  block_.values.push_back(
      static_cast<double>(gate_.rejected_not_finite() + gate_.rejected_no_lease() + gate_.rejected_late()));
  block_.values.push_back(static_cast<double>(gate_.clamped()));
  block_.values.push_back(static_cast<double>(gate_.went_neutral()));
  block_.values.push_back(static_cast<double>(gate_.fell_out_of_step()));
  add_timing(n, now_ns);
  member_.publish(Topic::variables, block_);
}

// in the order of kChannelVariables; the loop goes from the tick of the step that the value was computed from to now
void SessionVariables::add_channel(std::size_t channel, StepIndex n, std::int64_t now_ns) {
  const StepIndex based_on = gate_.based_on(channel);
  const bool has_loop = based_on >= 0;
  const double loop_ms = has_loop ? static_cast<double>(times_.since_tick_ns(based_on, n, now_ns)) * 1e-6 : kNoLoop;
  for (const double value : {gate_.raw(channel), gate_.control(channel), static_cast<double>(gate_.age(channel)),
                             has_loop ? static_cast<double>(n - based_on) : kNoLoop, loop_ms}) {
    block_.values.push_back(value);
  }
}

// in the order of kSessionVariables from the release jitter on, then of kNodeVariables by role
void SessionVariables::add_timing(StepIndex n, std::int64_t now_ns) {
  const bool is_paced = member_.session().pace == Pace::real;
  const auto count = [](std::uint64_t number) { return static_cast<double>(number); };
  for (const double value :
       {seconds(timing_.last_release_jitter_ns), seconds(timing_.last_response_ns),
        is_paced ? seconds(now_ns - clock_.due_ns(n)) : 0.0, count(timing_.overruns), count(clock_.skipped()),
        count(timing_.transitions), seconds(timing_.input_latency.max())}) {
    block_.values.push_back(value);
  }
  for (const Role role : transport::physics_roles()) {
    if (!member_.requires_role(role)) continue;
    const wire::Health& node = healths_[static_cast<std::size_t>(role)];
    for (const double value :
         {node.step_time_mean, node.step_time_max, node.cpu_time.p50, node.release_jitter.p99, node.wait.p50,
          node.response_recent, count(node.overruns), static_cast<double>(node.allocations)}) {
      block_.values.push_back(value);
    }
  }
}

}  // namespace slew::io_node
