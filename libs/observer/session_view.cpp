// SPDX-License-Identifier: Apache-2.0
#include "observer/session_view.h"

#include <algorithm>

#include "core/status.h"
#include "transport/cdr/codec.h"
#include "transport/message_object.h"
#include "transport/roles.h"
#include "transport/session_state.h"

namespace slew::observer {

using wire::Role;
using wire::Topic;

namespace {

// directories of 64 messages a node, some statuses, and the last blocks of variables that writers keep for a controller
constexpr std::size_t kMostPending = 4096;

}  // namespace

NodeView* SessionView::node_of(const wire::Header& header) {
  const auto index = static_cast<std::size_t>(header.role);
  if (!session_ || header.session != session_->header.session || index >= wire::kRoles) return nullptr;
  return transport::is_given_up(*session_, header) ? nullptr : &nodes_[index];
}

void SessionView::take(Topic topic, Bytes bytes, std::optional<double> time, Receiver* receiver) {
  // topics arrive in any order; messages that are not repeated wait for the session they belong to
  const bool is_repeated =
      topic == Topic::health || topic == Topic::mechanism || topic == Topic::actuators || topic == Topic::sensors;
  if (!session_ && topic != Topic::session && !is_repeated) {
    if (pending_.size() < kMostPending) pending_.push_back({topic, {bytes.begin(), bytes.end()}, time});
    return;
  }
  if (topic == Topic::session) take_session(bytes, receiver);
  if (receiver != nullptr) pass_on(topic, bytes, time, *receiver);
  switch (topic) {
    case Topic::node_status:
      return take_status(bytes);
    case Topic::health:
      return take_health(bytes);
    case Topic::variable_directory:
      return take_directory(bytes, receiver);
    case Topic::variables:
      return take_block(bytes, time, receiver);
    case Topic::mechanism:
      return take_sample<wire::MechanismMessage>(bytes, receiver);
    case Topic::actuators:
      return take_sample<wire::ActuatorMessage>(bytes, receiver);
    case Topic::sensors:
      return take_sample<wire::SensorMessage>(bytes, receiver);
    case Topic::controller_lease:
      return take_lease(bytes, receiver);
    case Topic::state:
      return take_state(bytes, receiver);
    default:
      return;
  }
}

void SessionView::take_object(const transport::Received& sample, Receiver* receiver) {
  if (receiver == nullptr || node_of(*sample.header) == nullptr) return;
  const auto pass = [&](const auto& object) {
    if (object != nullptr) receiver->take_sample(object->header, object->state);
  };
  pass(transport::object_in<wire::MechanismMessage>(sample));
  pass(transport::object_in<wire::ActuatorMessage>(sample));
  pass(transport::object_in<wire::SensorMessage>(sample));
}

void SessionView::pass_on(Topic topic, Bytes bytes, std::optional<double> time, Receiver& receiver) {
  wire::Header header;
  const bool has_header = topic != Topic::controller_input && topic != Topic::control_request;
  if (has_header && (!transport::decode_header(bytes, header) || node_of(header) == nullptr)) return;
  if (!has_header && !time) return;  // a live one may be of another session
  const StepIndex step = std::max<StepIndex>(header.step, 0);
  receiver.take_wire(topic, bytes, time ? *time : static_cast<double>(start_of(step, {session_->step_ns}).ns) / 1e9);
}

void SessionView::take_status(Bytes bytes) {
  wire::NodeStatus status;
  if (!transport::decode(bytes, status)) return;
  if (NodeView* node = node_of(status.header); node != nullptr) {
    note_end(status);
    node->is_known = true;
    node->status = std::move(status);
  }
}

// io reports the end and its cause. If io itself is lost, the other nodes' status counts. Where lost nodes are
// replaced, a node that ends for another reason than the loss of a node is replaced too, or io reports the end.
void SessionView::note_end(const wire::NodeStatus& status) {
  const Role role = status.header.role;
  if (status.state < wire::NodeState::ended || role == Role::recorder) return;
  const bool has_lost_node = status.exit_code == static_cast<std::int32_t>(ExitCode::node_lost);
  if (role != Role::io && session_->rejoin_ns > 0 && !has_lost_node) return;
  if (!end_ || end_->empty()) end_ = status.reason;
}

void SessionView::take_lease(Bytes bytes, Receiver* receiver) {
  wire::ControllerLease lease;
  if (!transport::decode(bytes, lease) || node_of(lease.header) == nullptr) return;
  if (receiver != nullptr) receiver->take_lease(lease);
  leases_[{lease.controller, lease.channel}] = std::move(lease);
}

void SessionView::take_state(Bytes bytes, Receiver* receiver) {
  wire::StatePart part;
  if (receiver == nullptr || !transport::decode(bytes, part) || node_of(part.header) == nullptr) return;
  receiver->take_state(part);
}

template <typename Sample>
void SessionView::take_sample(Bytes bytes, Receiver* receiver) {
  Sample sample;
  if (receiver == nullptr || !transport::decode(bytes, sample) || node_of(sample.header) == nullptr) return;
  receiver->take_sample(sample.header, sample.state);
}

// A session that starts under the same name after this one takes its place, where the newest is viewed. A session that
// only claims the name does not. A withdrawn session gives the place back.
void SessionView::take_session(Bytes bytes, Receiver* receiver) {
  wire::SessionDescription session;
  if (!transport::decode(bytes, session) || (!name_.empty() && session.name != name_)) return;
  const auto is_it = [&](const std::optional<wire::SessionDescription>& other) {
    return other && other->header.session == session.header.session;
  };
  if (session.header.phase == wire::Phase::ended) {
    if (is_it(claimant_)) claimant_.reset();
    if (!is_it(session_)) return;
    if (choice_ == Choice::newest) return look_at(std::exchange(claimant_, std::nullopt), receiver);
    if (!end_) end_.emplace();
    return;
  }
  if (session.header.phase != wire::Phase::running) return;
  // its owner publishes its new state
  if (is_it(session_)) {
    session_ = std::move(session);
    return;
  }
  if (session_ && choice_ == Choice::first) return;
  if (session_ && session.started_ns < session_->started_ns) {
    claimant_ = std::move(session);
    return;
  }
  claimant_ = std::exchange(session_, std::nullopt);
  look_at(std::move(session), receiver);
}

void SessionView::look_at(std::optional<wire::SessionDescription> session, Receiver* receiver) {
  session_ = std::move(session);
  nodes_ = {};
  variables_ = {};
  named_ = {};
  has_directory_ = {};
  places_.clear();
  index_.clear();
  leases_.clear();
  step_ = kJoinStep;
  end_.reset();
  if (receiver != nullptr) receiver->begin_session();
  if (!session_) return;
  name_ = session_->name;
  for (const PendingMessage& message : std::exchange(pending_, {}))
    take(message.topic, message.bytes, message.time, receiver);
}

void SessionView::take_health(Bytes bytes) {
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
  ++node->healths;
  if (health.header.role == Role::io) step_ = health.header.step;
  node->health = std::move(health);
}

void SessionView::take_directory(Bytes bytes, Receiver* receiver) {
  wire::VariableDirectory directory;
  if (!transport::decode(bytes, directory) || node_of(directory.header) == nullptr) return;
  const auto role = static_cast<std::size_t>(directory.header.role);
  std::deque<VariableView>& variables = variables_[role];
  if (receiver != nullptr) receiver->take_directory(directory);
  has_directory_[role] = true;
  if (variables.size() < directory.total) variables.resize(directory.total);
  for (std::size_t i = 0; i < directory.entries.size(); ++i) {
    const VariablePlace place{directory.header.role, directory.first + static_cast<std::uint32_t>(i)};
    if (place.index >= variables.size()) break;
    VariableView& variable = variables[place.index];
    if (variable.name.empty()) {
      ++named_[role];
      places_.push_back(place);
    }
    variable.name = directory.entries[i].name;
    variable.unit = directory.entries[i].unit;
    index_.insert_or_assign(variable.name, place);
  }
}

void SessionView::take_block(Bytes bytes, std::optional<double> time, Receiver* receiver) {
  if (!transport::decode(bytes, block_) || node_of(block_.header) == nullptr) return;
  if (block_.header.phase != wire::Phase::running) return;
  const auto start = static_cast<double>(start_of(block_.header.step, {session_->step_ns}).ns) / 1e9;
  if (receiver != nullptr) receiver->take_block(block_, bytes, time.value_or(start));
  NodeView& node = *node_of(block_.header);
  ++node.blocks;
  if (!block_.values.empty()) {
    node.left_out_since.reset();
  } else {
    ++node.blocks_left_out;
    if (!node.left_out_since) node.left_out_since = block_.header.step;
  }
  std::deque<VariableView>& variables = variables_[static_cast<std::size_t>(block_.header.role)];
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
  const VariablePlace* place = find_place(name);
  return place != nullptr && node(place->role).left_out_since;
}

bool SessionView::is_paused() const noexcept {
  return transport::is_pause(node(Role::io).status);
}

bool SessionView::is_over() const noexcept {
  const NodeView& io = node(Role::io);
  return io.is_known && io.status.state >= wire::NodeState::ended;
}

std::vector<const VariableView*> SessionView::variables() const {
  std::vector<const VariableView*> all;
  for (const std::deque<VariableView>& of_role : variables_) {
    for (const VariableView& variable : of_role) {
      if (!variable.name.empty()) all.push_back(&variable);
    }
  }
  return all;
}

const VariablePlace* SessionView::find_place(std::string_view name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &found->second;
}

const VariableView* SessionView::find(std::string_view name) const {
  const VariablePlace* place = find_place(name);
  return place == nullptr ? nullptr : &variable(*place);
}

const wire::ControllerLease* SessionView::lease(const std::string& controller, const std::string& channel) const {
  const auto found = leases_.find({controller, channel});
  return found == leases_.end() ? nullptr : &found->second;
}

bool SessionView::has_whole_directory() const noexcept {
  if (!session_) return false;
  for (const Role role : transport::node_roles()) {
    const auto index = static_cast<std::size_t>(role);
    if (role == Role::recorder || (session_->required_roles & bit(role)) == 0) continue;
    if (!has_directory_[index] || named_[index] < variables_[index].size()) return false;
  }
  return true;
}

}  // namespace slew::observer
