// SPDX-License-Identifier: Apache-2.0
#include "session.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/time.h"
#include "node/identity.h"
#include "transport/cdr/codec.h"
#include "transport/cyclone/cyclone_transport.h"

namespace slew::testing {
namespace {

using wire::Role;
using wire::Topic;

constexpr std::int64_t kRequestIntervalNs = 500'000'000;

}  // namespace

// ---- observer -------------------------------------------------------------------------------------------------

Observer::Observer(std::uint32_t domain, const std::string& session) : session_(session) {
  const transport::Network network{domain, "lo", {}};
  const transport::TopicSet writes = {Topic::controller_input, Topic::controller_lease, Topic::control_request,
                                      Topic::session, Topic::node_status};
  const transport::Endpoint endpoint{session, "observer", writes, transport::TopicSet::all()};
  std::unique_ptr<transport::CycloneTransport> transport;
  if (const Status status = transport::CycloneTransport::open(network, endpoint, transport); !status.is_ok()) {
    throw std::runtime_error(status.text);
  }
  transport_ = std::move(transport);
}

bool Observer::wait_until(const std::function<bool()>& condition, std::int64_t longest_ns) {
  const std::int64_t deadline_ns = monotonic_ns() + longest_ns;
  while (true) {
    transport::Received message;
    while (transport_->take(message)) take(message);
    if (condition()) return true;
    const std::int64_t now_ns = monotonic_ns();
    if (now_ns >= deadline_ns) return false;
    transport_->wait_until(std::min(deadline_ns, now_ns + 20'000'000));
  }
}

bool Observer::wait_for_step(StepIndex step) {
  return wait_until([&] { return step_ >= step; });
}

bool Observer::wait_for_healths(Role role, std::uint64_t count) {
  const std::uint64_t target = healths(role) + count;
  return wait_until([&] { return healths(role) >= target; });
}

bool Observer::wait_for_process(pid_t pid) {
  const std::string known = "pid " + std::to_string(pid) + ",";
  return wait_until([&] {
    const std::vector<std::string> writers = transport_->discovered_writers(Topic::node_status);
    return std::any_of(writers.begin(), writers.end(),
                       [&](const std::string& writer) { return writer.find(known) != std::string::npos; });
  });
}

void Observer::take(const transport::Received& message) {
  ++messages_;
  switch (message.topic) {
    case Topic::session: {
      wire::SessionDescription description;
      if (transport::decode(message.bytes, description)) descriptions_[description.header.session] = description;
      return;
    }
    case Topic::node_status: {
      wire::NodeStatus status;
      if (!transport::decode(message.bytes, status)) return;
      status_[static_cast<std::size_t>(status.header.role)] = status;
      return;
    }
    case Topic::tick: {
      if (!transport::decode(message.bytes, tick_)) return;
      if (tick_.header.phase == wire::Phase::join) return;
      ++ticks_;
      if (tick_.header.epoch > epoch_) step_ = -1;
      epoch_ = tick_.header.epoch;
      step_ = std::max(step_, tick_.header.step);
      return;
    }
    case Topic::health: {
      wire::Health health;
      if (!transport::decode(message.bytes, health)) return;
      const auto role = static_cast<std::size_t>(health.header.role);
      if (role >= wire::kRoles) return;
      ++healths_[role];
      if (health.state >= wire::NodeState::ended) ++healths_after_end_[role];
      return;
    }
    case Topic::control_reply: {
      wire::ControlReply reply;
      if (transport::decode(message.bytes, reply)) replies_[reply.request] = reply;
      return;
    }
    case Topic::controller_lease: {
      wire::ControllerLease lease;
      if (transport::decode(message.bytes, lease)) leases_.push_back(lease);
      return;
    }
    case Topic::variable_directory: {
      wire::VariableDirectory directory;
      if (!transport::decode(message.bytes, directory)) return;
      for (std::size_t i = 0; i < directory.entries.size(); ++i) {
        places_[directory.entries[i].name] = {directory.header.role, directory.first + i};
      }
      return;
    }
    case Topic::variables: {
      wire::VariableBlock block;
      if (!transport::decode(message.bytes, block) || block.header.phase != wire::Phase::running) return;
      for (std::size_t i = 0; i < block.values.size(); ++i) {
        values_[{block.header.role, block.first + i}] = block.values[i];
      }
      return;
    }
    default:
      return;
  }
}

std::optional<double> Observer::variable(const std::string& name) const {
  const auto place = places_.find(name);
  if (place == places_.end()) return std::nullopt;
  const auto value = values_.find(place->second);
  if (value == values_.end()) return std::nullopt;
  return value->second;
}

wire::ControlReply Observer::request(wire::ControlAction action, double value, const std::string& path,
                                     std::int64_t over_ns) {
  wire::ControlRequest request;
  request.session = session_;
  request.request = next_request_++;
  request.action = action;
  request.value = value;
  request.path = path;
  request.over_ns = over_ns;
  // io may not have discovered the writer yet; an unanswered request is repeated
  for (int attempt = 0; attempt < 20; ++attempt) {
    publish(Topic::control_request, request);
    if (wait_until([&] { return replies_.count(request.request) != 0; }, kRequestIntervalNs)) {
      return replies_.at(request.request);
    }
  }
  throw std::runtime_error("io does not answer a request");
}

void Observer::send(const wire::ControllerInput& input) {
  publish(Topic::controller_input, input);
}

wire::ControllerLease Observer::acquire(const std::string& controller, const std::string& channel) {
  leases_.clear();
  for (int attempt = 0; attempt < 20; ++attempt) {
    send({session_, controller, channel, wire::ControllerAction::acquire, 0, 0, kJoinStep});
    const auto is_answer = [&](const wire::ControllerLease& lease) {
      return lease.controller == controller && lease.channel == channel;
    };
    const auto answered = [&] { return std::any_of(leases_.begin(), leases_.end(), is_answer); };
    if (wait_until(answered, kRequestIntervalNs)) return *std::find_if(leases_.begin(), leases_.end(), is_answer);
  }
  throw std::runtime_error("io does not answer a controller");
}

// ---- session --------------------------------------------------------------------------------------------------

Session::Session(std::vector<std::string> io_arguments, std::string scene)
    : io_arguments_(std::move(io_arguments)), scene_(std::move(scene)) {}

std::vector<std::string> Session::arguments(Role role) const {
  std::vector<std::string> arguments;
  if (role == Role::io) arguments.push_back(scene_);
  arguments.insert(arguments.end(), {"--session", name_, "--domain", std::to_string(domain_.number())});
  if (role == Role::io) arguments.insert(arguments.end(), io_arguments_.begin(), io_arguments_.end());
  if (role == Role::recorder) arguments.insert(arguments.end(), {"--out", runs().string()});
  return arguments;
}

Program& Session::start(Role role, const std::vector<std::string>& more, const std::string& copy) {
  std::vector<std::string> all = arguments(role);
  all.insert(all.end(), more.begin(), more.end());
  const std::string name(node::to_text(role));
  std::filesystem::path path = program_path(name + "_node");
  if (const auto around = prefixes_.find(role); around != prefixes_.end()) {
    const CommandPrefix& s = around->second;
    all.insert(all.end(), s.more.begin(), s.more.end());
    all.insert(all.begin(), path.string());
    all.insert(all.begin(), s.command.begin() + 1, s.command.end());
    path = s.command.front();
  }
  auto program = std::make_unique<Program>(path, all, folder_.path() / (name + copy));
  if (!copy.empty()) {
    copies_.push_back(std::move(program));
    return *copies_.back();
  }
  nodes_[role] = std::move(program);
  return *nodes_[role];
}

void Session::run_under(Role role, std::vector<std::string> command, std::vector<std::string> more) {
  prefixes_[role] = {std::move(command), std::move(more)};
}

void Session::start_all() {
  for (const Role role : kAllNodes) start(role);
}

std::map<Role, int> Session::wait_all(std::int64_t longest_ns) {
  const std::int64_t deadline_ns = monotonic_ns() + longest_ns;
  std::map<Role, int> codes;
  for (const auto& [role, program] : nodes_) {
    codes[role] = program->wait(std::max<std::int64_t>(0, deadline_ns - monotonic_ns())).value_or(-1000);
  }
  return codes;
}

bool Session::wait_for_recorded_step() {
  const auto has_a_step = [this] {
    try {
      return recorded().last_complete_step() > 0;
    } catch (const std::exception&) {
      return false;  // there is no recording yet
    }
  };
  const std::int64_t deadline_ns = monotonic_ns() + kSoonNs;
  bool is_there = has_a_step();
  while (!is_there && monotonic_ns() < deadline_ns && !node(Role::io).wait(50'000'000).has_value()) {
    is_there = has_a_step();
  }
  return is_there;
}

std::string Session::errors() const {
  std::string text;
  for (const auto& [role, program] : nodes_) text += std::string(node::to_text(role)) + ": " + program->err() + "\n";
  return text;
}

Observer& Session::observer() {
  if (observer_ == nullptr) observer_ = std::make_unique<Observer>(domain_.number(), name_);
  return *observer_;
}

}  // namespace slew::testing
