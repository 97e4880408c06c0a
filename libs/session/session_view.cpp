#include "session/session_view.h"

#include <algorithm>
#include <utility>

#include "core/state_hash.h"
#include "node/tick_counter.h"
#include "transport/cdr/codec.h"
#include "transport/given_up.h"

namespace slew::session {

using wire::Role;
using wire::Topic;

namespace {

// directories of 64 messages a node, some statuses: a session publishes no more than that once
constexpr std::size_t kMostPending = 1024;

}  // namespace

NodeView* SessionView::node_of(const wire::Header& header) {
  const auto index = static_cast<std::size_t>(header.role);
  if (!session_ || header.session != session_->header.session || index >= wire::kRoles) return nullptr;
  return transport::is_given_up(*session_, header) ? nullptr : &nodes_[index];
}

template <typename Sample>
void SessionView::take_sample(std::span<const std::byte> bytes, Sample& sample) {
  if (!transport::decode(bytes, sample) || node_of(sample.header) == nullptr) return;
  flags_.take(sample.header, sample.state);
}

void SessionView::take(Topic topic, std::span<const std::byte> bytes, std::optional<double> time) {
  // topics arrive in any order; messages that are published once must wait for the session they belong to
  const bool is_published_once =
      topic == Topic::node_status || topic == Topic::variable_directory || topic == Topic::controller_lease;
  if (!session_ && is_published_once && pending_.size() < kMostPending) {
    pending_.push_back({topic, {bytes.begin(), bytes.end()}});
    return;
  }
  switch (topic) {
    case Topic::session:
      return take_session(bytes);
    case Topic::node_status:
      return take_status(bytes);
    case Topic::health:
      return take_health(bytes);
    case Topic::variable_directory:
      return take_directory(bytes);
    case Topic::variables:
      return take_block(bytes, time);
    case Topic::mechanism:
      return take_sample(bytes, mechanism_);
    case Topic::actuators:
      return take_sample(bytes, actuators_);
    case Topic::controller_lease:
      return take_lease(bytes);
    default:
      return;
  }
}

void SessionView::take_status(std::span<const std::byte> bytes) {
  wire::NodeStatus status;
  if (!transport::decode(bytes, status)) return;
  if (NodeView* node = node_of(status.header); node != nullptr) {
    node->is_known = true;
    node->status = std::move(status);
  }
}

void SessionView::take_lease(std::span<const std::byte> bytes) {
  wire::ControllerLease lease;
  if (!transport::decode(bytes, lease) || node_of(lease.header) == nullptr) return;
  leases_[{lease.controller, lease.channel}] = lease;
}

// A session that starts under the same name after this one takes its place. A session that only claims the name does
// not. A withdrawn session gives the place back.
void SessionView::take_session(std::span<const std::byte> bytes) {
  wire::SessionDescription session;
  if (!transport::decode(bytes, session) || (!name_.empty() && session.name != name_)) return;
  const auto is_it = [&](const std::optional<wire::SessionDescription>& other) {
    return other && other->header.session == session.header.session;
  };
  if (session.header.phase == wire::Phase::ended) {
    if (is_it(claimant_)) claimant_.reset();
    if (is_it(session_)) look_at(std::exchange(claimant_, std::nullopt));
    return;
  }
  if (session.header.phase != wire::Phase::running) return;
  // its owner publishes its new state
  if (is_it(session_)) {
    session_ = std::move(session);
    return;
  }
  if (session_ && session.started_ns < session_->started_ns) {
    claimant_ = std::move(session);
    return;
  }
  claimant_ = std::exchange(session_, std::nullopt);
  look_at(std::move(session));
}

void SessionView::look_at(std::optional<wire::SessionDescription> session) {
  session_ = std::move(session);
  nodes_ = {};
  variables_ = {};
  named_ = {};
  has_directory_ = {};
  index_.clear();
  leases_.clear();
  flags_ = {};
  curves_ = empty_curves_;
  variables_digest_ = 0;
  step_ = kJoinStep;
  if (!session_) return;
  name_ = session_->name;
  for (const PendingMessage& message : std::exchange(pending_, {})) take(message.topic, message.bytes);
}

void SessionView::take_health(std::span<const std::byte> bytes) {
  wire::Health health;
  if (!transport::decode(bytes, health)) return;
  NodeView* node = node_of(health.header);
  if (node == nullptr) return;
  if (health.steps_done > node->steps_seen) {
    const std::uint64_t steps = health.steps_done - node->steps_seen;
    node->times.sum += health.step_time_mean * static_cast<double>(steps);
    node->times.steps += steps;
  }
  node->times.max = std::max(node->times.max, health.step_time_max);
  node->steps_seen = health.steps_done;
  if (health.header.role == Role::io) step_ = health.header.step;
  node->health = std::move(health);
}

void SessionView::take_directory(std::span<const std::byte> bytes) {
  wire::VariableDirectory directory;
  if (!transport::decode(bytes, directory) || node_of(directory.header) == nullptr) return;
  const auto role = static_cast<std::size_t>(directory.header.role);
  std::vector<VariableView>& variables = variables_[role];
  if (curves_) curves_->take(directory);
  has_directory_[role] = true;
  if (variables.size() < directory.total) variables.resize(directory.total);
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    const std::size_t at = directory.first + i;
    if (at >= variables.size()) break;
    if (variables[at].name.empty()) ++named_[role];
    variables[at].name = directory.entries[i].name;
    variables[at].unit = directory.entries[i].unit;
    index_.insert_or_assign(variables[at].name, std::pair(role, at));
  }
}

void SessionView::take_block(std::span<const std::byte> bytes, std::optional<double> time) {
  if (!transport::decode(bytes, block_) || node_of(block_.header) == nullptr) return;
  if (block_.header.phase != wire::Phase::running) return;
  variables_digest_ += digest_of(bytes);
  if (curves_)
    curves_->take(block_,
                  time.value_or(static_cast<double>(start_of(block_.header.step, {session_->step_ns}).ns) / 1e9));
  NodeView& node = *node_of(block_.header);
  ++node.blocks;
  if (!block_.values.empty()) {
    node.left_out_since.reset();
  } else {
    ++node.blocks_left_out;
    if (!node.left_out_since) node.left_out_since = block_.header.step;
  }
  std::vector<VariableView>& variables = variables_[static_cast<std::size_t>(block_.header.role)];
  if (variables.size() < block_.first + block_.values.size()) variables.resize(block_.first + block_.values.size());
  for (std::size_t i = 0; i < block_.values.size(); ++i) {
    VariableView& variable = variables[block_.first + i];
    variable.value = block_.values[i];
    variable.min = std::min(variable.min, variable.value);
    variable.max = std::max(variable.max, variable.value);
    variable.step = block_.header.step;
  }
  step_ = std::max(step_, block_.header.step);
}

bool SessionView::is_left_out(std::string_view name) const {
  const auto found = index_.find(name);
  return found != index_.end() && nodes_[found->second.first].left_out_since;
}

bool SessionView::is_paused() const noexcept {
  return node::is_pause(node(Role::io).status);
}

bool SessionView::is_over() const noexcept {
  const NodeView& io = node(Role::io);
  return io.is_known && io.status.state >= wire::NodeState::ended;
}

std::vector<const VariableView*> SessionView::variables() const {
  std::vector<const VariableView*> all;
  for (const std::vector<VariableView>& of_role : variables_) {
    for (const VariableView& variable : of_role) {
      if (!variable.name.empty()) all.push_back(&variable);
    }
  }
  return all;
}

const VariableView* SessionView::find(std::string_view name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &variables_[found->second.first][found->second.second];
}

const wire::ControllerLease* SessionView::lease(const std::string& controller, const std::string& channel) const {
  const auto found = leases_.find({controller, channel});
  return found == leases_.end() ? nullptr : &found->second;
}

bool SessionView::has_whole_directory() const noexcept {
  if (!session_) return false;
  for (const Role role : wire::kNodeRoles) {
    const auto index = static_cast<std::size_t>(role);
    if (role == Role::recorder || (session_->required_roles & bit(role)) == 0) continue;
    if (!has_directory_[index] || named_[index] < variables_[index].size()) return false;
  }
  return true;
}

}  // namespace slew::session
