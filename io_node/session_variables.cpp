// io_node's part that publishes variables: its own, and those of the nodes' health.
#include "io_node/session_variables.h"

#include <utility>

#include "io_node/io_node.h"

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
// of the session as io sees it, and of each physics node as its last health message says
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

constexpr double kNoLoop = -1;  // loop delay of a channel that no controller moves

}  // namespace

void IoNode::keep_health(std::span<const std::byte> bytes) {
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
  for (const Role role : wire::kPhysicsRoles) {
    if ((roles & bit(role)) == 0) continue;
    for (const SessionVariable& variable : kNodeVariables) {
      entries.push_back({std::string(to_text(role)) + variable.name, variable.unit});
    }
  }
  return entries;
}

void IoNode::publish_directory() {
  wire::VariableDirectory directory;
  directory.header = member_.header(Phase::running, 0);
  std::vector<std::string> inputs;
  for (std::size_t i = 0; i < gate_.size(); ++i) inputs.push_back(gate_.config(i).name);
  directory.entries = own_variables(inputs, config_.required_roles);
  directory.total = static_cast<std::uint32_t>(directory.entries.size());
  member_.publish(Topic::variable_directory, directory);
}

// From the tick of the step that a channel's value was computed from to this one.
double IoNode::loop_time_ms(std::size_t channel, std::int64_t now_ns) const noexcept {
  const StepIndex based_on = gate_.based_on(channel);
  if (based_on < 0) return kNoLoop;
  const StepIndex delay = n_ - based_on;
  const std::int64_t spent_ns =
      delay < kLoopMemory ? now_ns - tick_ns_[static_cast<std::size_t>(based_on % kLoopMemory)] : delay * H_.ns;
  return static_cast<double>(spent_ns) * 1e-6;
}

void IoNode::publish_variables(std::int64_t now_ns) {
  block_.header = member_.header(Phase::running, n_);
  block_.values.clear();
  for (std::size_t i = 0; i < gate_.size(); ++i) {
    block_.values.push_back(gate_.raw(i));
    block_.values.push_back(gate_.control(i));
    block_.values.push_back(gate_.age(i));
    const StepIndex based_on = gate_.based_on(i);
    block_.values.push_back(based_on < 0 ? kNoLoop : static_cast<double>(n_ - based_on));
    block_.values.push_back(loop_time_ms(i, now_ns));
  }
  block_.values.push_back(seconds(clock_.slip_ns()));
  block_.values.push_back(
      static_cast<double>(gate_.rejected_not_finite() + gate_.rejected_no_lease() + gate_.rejected_late()));
  block_.values.push_back(static_cast<double>(gate_.clamped()));
  block_.values.push_back(static_cast<double>(gate_.went_neutral()));
  block_.values.push_back(static_cast<double>(gate_.fell_out_of_step()));
  add_timing_values(now_ns);
  member_.publish(Topic::variables, block_);
}

// in the order of kSessionVariables from the release jitter on, then of kNodeVariables by role
void IoNode::add_timing_values(std::int64_t now_ns) {
  const node::NodeTiming& own = timing();
  const auto count = [](std::uint64_t n) { return static_cast<double>(n); };
  for (const double value : {seconds(own.last_release_jitter_ns), seconds(own.last_response_ns),
                             is_paced() ? seconds(now_ns - clock_.due_ns(n_)) : 0.0, count(own.overruns),
                             count(clock_.skipped()), count(own.transitions), seconds(own.input_latency.max())}) {
    block_.values.push_back(value);
  }
  for (const Role role : wire::kPhysicsRoles) {
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
