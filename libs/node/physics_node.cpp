#include "node/physics_node.h"

#include <algorithm>

#include "core/check.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// ticks come up to the window (64 at most) ahead, samples one step ahead
constexpr std::size_t kRingDepth = 128;

// variables are read by the recorder only; the sample topic is what the partner needs
constexpr Topic kMechanicsTopics[] = {Topic::mechanism, Topic::variables};
constexpr Topic kHydraulicsTopics[] = {Topic::actuators, Topic::variables};

std::span<const Topic> topics_of(Role role) {
  return role == Role::mechanics ? std::span<const Topic>(kMechanicsTopics) : std::span<const Topic>(kHydraulicsTopics);
}

// io knows all roles: it is given the time to say which one is missing
constexpr SimDuration kOwnerFirst = milliseconds(1000);

Topic sample_topic(Role role) {
  return role == Role::mechanics ? Topic::mechanism : Topic::actuators;
}

}  // namespace

PhysicsNode::PhysicsNode(Role role, transport::Transport& transport, SubsystemFactory factory, const JoinOptions& join)
    : member_(role, transport, topics_of(role), join.session),
      factory_(std::move(factory)),
      session_timeout_(join.session_timeout),
      join_timeout_(join.join_timeout),
      ticks_(kRingDepth),
      mechanisms_(kRingDepth),
      actuators_(kRingDepth) {
  SLEW_CHECK(role == Role::mechanics || role == Role::hydraulics);
}

Role PhysicsNode::partner() const noexcept {
  return member_.role() == Role::mechanics ? Role::hydraulics : Role::mechanics;
}

bool PhysicsNode::has_partner() const noexcept {
  return member_.requires_role(partner());
}

bool PhysicsNode::poll(std::int64_t now_ns) {
  bool any = false;
  transport::Received message;
  while (stage_ != Stage::finished && member_.transport().take(message)) {
    receive(message, now_ns);
    any = true;
  }
  any |= advance(now_ns);
  if (const Status& failure = member_.send_failure(); !failure.is_ok()) leave(failure.code, failure.text, now_ns);
  if (stage_ != Stage::finished && stage_ != Stage::waiting_for_session) watch(now_ns);
  member_.publish_status_if_changed();
  update_health();
  return any;
}

std::int64_t PhysicsNode::next_deadline(std::int64_t now_ns) const {
  switch (stage_) {
    case Stage::joining:
      return now_ns + kProbeInterval.ns / 2;
    case Stage::initialising:
    case Stage::stepping:
      // after a fault's END nothing is asked for: io's status comes by itself
      return is_ended_by_fault_ ? now_ns + kProbeInterval.ns : std::max(now_ns, resend_.due_ns());
    default:
      return now_ns + kProbeInterval.ns;
  }
}

void PhysicsNode::request_stop(ExitCode code) {
  leave(code, "ended by a signal", 0);
}

void PhysicsNode::update_health() noexcept {
  HealthState& h = health();
  h.state = static_cast<std::uint8_t>(member_.state());
  h.step = n_;
  h.epoch = member_.epoch();
  h.refused = member_.refusals().refused();
  const bool waits_for_tick = ticks_.find(n_) == nullptr;
  h.is_waiting = stage_ == Stage::stepping && resend_.is_overdue();
  h.waiting_for = static_cast<std::uint8_t>(waits_for_tick ? Role::io : partner());
  h.waiting_step = n_;
  h.has_session.store(member_.has_session(), std::memory_order_release);
}

// ---- receiving ------------------------------------------------------------------------------------------------

void PhysicsNode::receive(const transport::Received& message, std::int64_t now_ns) {
  switch (message.topic) {
    case Topic::session:
      return receive_session(message.bytes, now_ns);
    case Topic::node_status: {
      const Status refusal = member_.on_node_status(message.bytes, now_ns);
      if (!refusal.is_ok()) refuse(refusal);
      return;
    }
    case Topic::health:
      return member_.on_health(message.bytes, now_ns);
    case Topic::tick:
      return receive_tick(message.bytes, now_ns);
    case Topic::mechanism:
    case Topic::actuators:
      return receive_sample(message.bytes, message.topic, now_ns);
    case Topic::resend:
      return receive_resend(message.bytes);
    default:
      return;
  }
}

// another process holds the role: this one was never part of the session
void PhysicsNode::refuse(const Status& refusal) {
  member_.step_aside(refusal.code, refusal.text);
  stage_ = Stage::finished;
}

void PhysicsNode::receive_session(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::SessionDescription session;
  if (!transport::decode(bytes, session)) {
    ++member_.refusals().undecodable;
    return;
  }
  const SessionNews news = member_.news(session);
  if (news == SessionNews::withdrawn) {
    member_.withdraw();
    stage_ = Stage::finished;
  }
  if (news != SessionNews::begins) return;
  if (const Status held = member_.adopt(session, now_ns); !held.is_ok()) return refuse(held);
  if (const Status protocol = member_.problem_of_protocol(); !protocol.is_ok()) {
    member_.fail(protocol.code, protocol.text);
  } else if (!member_.requires_role(member_.role())) {
    const std::string why = "scene '" + session.scene_name + "' needs no " + std::string(to_text(member_.role())) +
                            " node; nothing to do here";
    return refuse(Status::error(ExitCode::bad_input, why));
  } else if (const Status built = factory_(session, built_); !built.is_ok()) {
    member_.fail(built.code, built.text);
  } else if (built_.published_variables.size() > wire::kMaxVariables) {
    member_.fail(ExitCode::bad_input,
                 "scene '" + session.scene_name + "' publishes " + std::to_string(built_.published_variables.size()) +
                     " variables of this node, at most " + std::to_string(wire::kMaxVariables) +
                     " can be told apart; this node does not take part; name fewer in recording.variables");
  }
  if (member_.state() == NodeState::fault) {
    member_.publish_status_if_changed();
    stage_ = Stage::finished;
    return;
  }
  variable_values_.resize(built_.subsystem->variables().size());
  member_.set_state(NodeState::joining);
  stage_ = Stage::joining;
}

void PhysicsNode::receive_tick(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  // a new epoch starts with an INIT tick
  if (member_.begins_next_epoch(header)) return restart(header.epoch);
  if (!member_.fits(header, Topic::tick)) return;
  member_.heard(header, Topic::tick, now_ns);
  if (header.phase == Phase::running) keep(bytes, header.step, ticks_);
}

void PhysicsNode::receive_sample(std::span<const std::byte> bytes, Topic topic, std::int64_t now_ns) {
  if (topic == sample_topic(member_.role())) return;
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (!member_.fits(header, topic)) return;
  member_.heard(header, topic, now_ns);
  if (header.phase == Phase::init && topic == Topic::mechanism) {
    has_mechanism_init_ = transport::decode(bytes, mechanism_init_);
    if (!has_mechanism_init_) ++member_.refusals().undecodable;
  } else if (header.phase == Phase::running && topic == Topic::mechanism) {
    keep(bytes, header.step, mechanisms_);
  } else if (header.phase == Phase::running) {
    keep(bytes, header.step, actuators_);
  }
}

// puts a message of a step that is still to be done into its ring, once
template <typename Message>
void PhysicsNode::keep(std::span<const std::byte> bytes, StepIndex step, StepRing<Message>& ring) {
  if (step >= n_ + static_cast<StepIndex>(kRingDepth)) {
    ++member_.refusals().too_far_ahead;
  } else if (step < n_ || ring.find(step) != nullptr) {
    ++member_.refusals().duplicate;
  } else if (!transport::decode(bytes, ring.put(step))) {
    ring.remove(step);
    ++member_.refusals().undecodable;
  }
}

void PhysicsNode::receive_resend(std::span<const std::byte> bytes) {
  wire::ResendRequest request;
  if (!transport::decode(bytes, request)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (request.role != member_.role() || !member_.fits(request.header, Topic::resend)) return;
  if (request.topic != static_cast<std::uint8_t>(sample_topic(member_.role()))) return;
  const StepIndex last = std::min(request.last_step, request.header.step + static_cast<StepIndex>(sent_.depth()));
  for (StepIndex step = request.header.step; step <= last; ++step) {
    const std::span<const std::byte> sent = sent_.find(step);
    if (sent.empty()) continue;
    member_.send(sample_topic(member_.role()), sent);
    ++health().resends_answered;
  }
}

// ---- doing ----------------------------------------------------------------------------------------------------

bool PhysicsNode::advance(std::int64_t now_ns) {
  switch (stage_) {
    case Stage::waiting_for_session:
      if (session_deadline_ns_ == 0) session_deadline_ns_ = now_ns + session_timeout_.ns;
      if (now_ns > session_deadline_ns_) {
        member_.fail(ExitCode::failed, "no session was found within " + seconds_text(session_timeout_) +
                                           "; start the io node first, and compare --session, --domain, --interface "
                                           "and --peer on both sides");
        stage_ = Stage::finished;
      }
      return false;
    case Stage::joining:
      return advance_join(now_ns);
    case Stage::initialising:
      return advance_init(now_ns);
    case Stage::stepping: {
      bool any = false;
      while (stage_ == Stage::stepping && member_.send_failure().is_ok() && advance_step(now_ns)) any = true;
      if (!any) ask_for_missing(now_ns);
      return any;
    }
    case Stage::leaving:
      return advance_leaving(now_ns);
    case Stage::finished:
      return false;
  }
  return false;
}

bool PhysicsNode::advance_join(std::int64_t now_ns) {
  if (join_deadline_ns_ == 0) join_deadline_ns_ = now_ns + join_timeout_.ns + kOwnerFirst.ns;
  if (member_.is_heard_by_all()) {
    member_.set_state(NodeState::initialising);
    stage_ = Stage::initialising;
    resend_.restart(now_ns);
    return true;
  }
  if (now_ns > join_deadline_ns_) {
    leave(ExitCode::failed,
          "JOIN did not come about within " + seconds_text(join_timeout_) + ": " + member_.missing_join_text(), now_ns);
    return true;
  }
  if (member_.probe_is_due(now_ns)) {
    // step -1 on every topic of this role that somebody has not heard yet
    mechanism_out_.header = actuators_out_.header = block_.header = member_.header(Phase::join, kJoinStep);
    if (member_.role() == Role::mechanics) {
      member_.publish(Topic::mechanism, mechanism_out_);
    } else {
      member_.publish(Topic::actuators, actuators_out_);
    }
    if (!member_.is_heard_on(Topic::variables)) member_.publish(Topic::variables, block_);
  }
  return false;
}

bool PhysicsNode::advance_init(std::int64_t now_ns) {
  coupling::Subsystem& subsystem = *built_.subsystem;
  bool any = false;
  if (!first_sample_sent_) {
    first_sample_sent_ = true;
    if (subsystem.first_sample(own_) && has_partner()) publish_sample(Phase::init, kJoinStep, StepReport{});
    any = true;
  }
  // hydraulics starts from the mechanics' INIT, mechanics from the hydraulics' sample 0
  coupling::PartnerSamples partners;
  if (has_partner()) {
    if (member_.role() == Role::mechanics) {
      const wire::ActuatorMessage* sample = actuators_.find(0);
      partners.actuators = sample != nullptr ? &sample->sample : nullptr;
    } else if (has_mechanism_init_) {
      partners.mechanism = &mechanism_init_.sample;
    }
    if (partners.actuators == nullptr && partners.mechanism == nullptr) {
      ask_for_missing(now_ns);
      return any;
    }
  }
  const Status started = subsystem.start(partners, own_);
  if (!started.is_ok()) {
    leave(started.code, started.text, now_ns);
    return true;
  }
  publish_directory();
  publish_sample(Phase::running, 0, StepReport{});
  publish_variables(0);
  member_.set_step(0);
  member_.set_state(NodeState::ready);
  member_.mark_status_changed();
  stage_ = Stage::stepping;
  resend_.restart(now_ns);
  return true;
}

coupling::PartnerSamples PhysicsNode::partners_at(StepIndex step) const noexcept {
  coupling::PartnerSamples partners;
  if (member_.role() == Role::mechanics) {
    const wire::ActuatorMessage* message = actuators_.find(step);
    partners.actuators = message != nullptr ? &message->sample : nullptr;
  } else {
    const wire::MechanismMessage* message = mechanisms_.find(step);
    partners.mechanism = message != nullptr ? &message->sample : nullptr;
  }
  return partners;
}

void PhysicsNode::apply_commands(const wire::Tick& tick) {
  for (const wire::Command& command : tick.commands) {
    built_.subsystem->change_parameter(tick.header.step, {command.path, command.value, {command.over_ns}});
  }
}

bool PhysicsNode::advance_step(std::int64_t now_ns) {
  const wire::Tick* tick = ticks_.find(n_);
  if (tick == nullptr) return false;
  if ((tick->flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0) {
    // after a fault io's status says why, see watch()
    is_ended_by_fault_ = (tick->flags & static_cast<std::uint32_t>(wire::TickFlag::fault)) != 0;
    if (!is_ended_by_fault_) leave(ExitCode::ok, "", now_ns);
    return !is_ended_by_fault_;
  }
  const coupling::PartnerSamples partners = partners_at(n_);
  if (has_partner() && partners.mechanism == nullptr && partners.actuators == nullptr) return false;
  if (member_.state() != NodeState::running) member_.set_state(NodeState::running);

  apply_commands(*tick);
  const std::int64_t begin_ns = monotonic_ns();
  const StepReport report = built_.subsystem->step(n_, partners, tick->controls.span(), own_);
  const std::int64_t spent_ns = monotonic_ns() - begin_ns;
  ++n_;
  publish_sample(Phase::running, n_, report);
  if (n_ % built_.variables_every == 0) publish_variables(n_);

  HealthState& h = health();
  ++h.steps_done;
  h.step_time_sum_ns += spent_ns;
  if (spent_ns > h.step_time_max_ns) h.step_time_max_ns = spent_ns;
  member_.set_step(n_);
  // in `real` pace the next tick is due a step later
  resend_.restart(member_.session().pace == wire::Pace::real ? now_ns + member_.session().step_ns : now_ns);
  if (report.has_failed()) {
    leave(ExitCode::diverged,
          "diverged in step " + std::to_string(n_ - 1) + ": " +
              std::string(built_.subsystem->offender_name(report.offender)) +
              " is not finite; the last good state is kept in the recording; reduce session.step, or look at what "
              "happened just before in a plot",
          now_ns);
  }
  return true;
}

bool PhysicsNode::advance_leaving(std::int64_t now_ns) {
  if (leave_deadline_ns_ == 0) leave_deadline_ns_ = now_ns + kLinger.ns;
  // stays to answer resends until everybody is through
  if (member_.all_required(NodeState::ended) || now_ns > leave_deadline_ns_) stage_ = Stage::finished;
  return false;
}

void PhysicsNode::restart(std::uint32_t epoch) {
  if (stage_ != Stage::initialising && stage_ != Stage::stepping) return;
  member_.set_epoch(epoch);
  built_.subsystem->reset();
  ticks_.clear();
  mechanisms_.clear();
  actuators_.clear();
  sent_.clear();
  n_ = 0;
  first_sample_sent_ = false;
  has_mechanism_init_ = false;
  member_.set_step(kJoinStep);
  member_.set_state(NodeState::initialising);
  member_.mark_status_changed();
  stage_ = Stage::initialising;
}

void PhysicsNode::leave(ExitCode code, const std::string& reason, std::int64_t now_ns) {
  if (stage_ == Stage::leaving || stage_ == Stage::finished) return;
  if (code == ExitCode::ok) {
    member_.end(code);
  } else {
    member_.fail(code, reason);
  }
  leave_deadline_ns_ = now_ns == 0 ? 0 : now_ns + kLinger.ns;
  stage_ = member_.has_session() ? Stage::leaving : Stage::finished;
}

// ---- publishing -----------------------------------------------------------------------------------------------

void PhysicsNode::publish_sample(Phase phase, StepIndex step, const StepReport& report) {
  wire::SampleState state;
  state.level = built_.subsystem->level();
  state.used_step = step - 1;
  state.state_hash = built_.subsystem->state_hash();
  state.flags = report.flags;
  state.offender = report.offender;
  state.substeps = report.substeps;
  bool is_encoded = false;
  if (member_.role() == Role::mechanics) {
    mechanism_out_.header = member_.header(phase, step);
    mechanism_out_.state = state;
    mechanism_out_.sample = own_.mechanism;
    is_encoded = transport::encode(mechanism_out_, buffer_);
  } else {
    actuators_out_.header = member_.header(phase, step);
    actuators_out_.state = state;
    actuators_out_.sample = own_.actuators;
    is_encoded = transport::encode(actuators_out_, buffer_);
  }
  SLEW_CHECK(is_encoded);
  sent_.keep(step, buffer_);
  member_.send(sample_topic(member_.role()), buffer_);
}

void PhysicsNode::publish_variables(StepIndex step) {
  if (built_.published_variables.empty()) return;
  built_.subsystem->read_variables(variable_values_);
  const std::size_t total = built_.published_variables.size();
  for (std::size_t first = 0; first < total; first += wire::kMaxVariablesPerBlock) {
    const std::size_t count = std::min(wire::kMaxVariablesPerBlock, total - first);
    block_.header = member_.header(Phase::running, step);
    block_.first = static_cast<std::uint32_t>(first);
    block_.values.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      block_.values[i] = variable_values_[built_.published_variables[first + i]];
    }
    member_.publish(Topic::variables, block_);
  }
}

void PhysicsNode::publish_directory() {
  const std::span<const ElementVariable> variables = built_.subsystem->variables();
  const std::size_t total = built_.published_variables.size();
  for (std::size_t first = 0; first < total; first += wire::kMaxVariablesPerBlock) {
    wire::VariableDirectory directory;
    directory.header = member_.header(Phase::running, 0);
    directory.total = static_cast<std::uint32_t>(total);
    directory.first = static_cast<std::uint32_t>(first);
    const std::size_t count = std::min(wire::kMaxVariablesPerBlock, total - first);
    for (std::size_t i = 0; i < count; ++i) {
      const ElementVariable& variable = variables[built_.published_variables[first + i]];
      directory.entries.push_back({variable.name, std::string(info(variable.dimension).si_unit)});
    }
    member_.publish(Topic::variable_directory, directory);
  }
}

// ---- waiting --------------------------------------------------------------------------------------------------

// io has not sent the next tick yet: the session does not tick, or it is paused
bool PhysicsNode::is_tick_withheld() const noexcept {
  const wire::NodeStatus& io = member_.peer(Role::io).status;
  if (io.header.epoch != member_.epoch()) return false;
  const bool is_paused = io.state == NodeState::holding && io.reason.empty() && io.header.step <= n_;
  return io.state < NodeState::running || is_paused;
}

void PhysicsNode::ask_for_missing(std::int64_t now_ns) {
  if (is_ended_by_fault_ || !resend_.is_due(now_ns)) return;
  const auto ask = [&](Role role, Topic topic, StepIndex step) {
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(topic);
    request.last_step = step;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
  };
  resend_.asked(now_ns);
  if (stage_ == Stage::initialising) {
    if (member_.role() == Role::hydraulics) ask(Role::mechanics, Topic::mechanism, kJoinStep);
    if (member_.role() == Role::mechanics) ask(Role::hydraulics, Topic::actuators, 0);
    return;
  }
  if (ticks_.find(n_) == nullptr && !is_tick_withheld()) ask(Role::io, Topic::tick, n_);
  const coupling::PartnerSamples partners = partners_at(n_);
  if (has_partner() && partners.mechanism == nullptr && partners.actuators == nullptr) {
    ask(partner(), sample_topic(partner()), n_);
  }
}

void PhysicsNode::watch(std::int64_t now_ns) {
  Role about = Role::io;
  const PeerEvent event = member_.watch_peers(now_ns, about);
  if (stage_ == Stage::leaving) return;
  const Peer& io = member_.peer(Role::io);
  if (io.status.state == NodeState::fault) {
    const auto code = static_cast<ExitCode>(io.status.exit_code);
    const bool by_signal = code == ExitCode::interrupted || code == ExitCode::terminated;
    return leave(code, by_signal ? "" : "io ended the session: " + io.status.reason, now_ns);
  }
  // the END tick normally comes first, and io answers for a while if it was lost
  if (io.status.state == NodeState::ended) {
    if (io_ended_ns_ == 0) io_ended_ns_ = now_ns;
    if (now_ns - io_ended_ns_ > kSilentAfter.ns) leave(ExitCode::ok, "", now_ns);
    return;
  }
  switch (event) {
    case PeerEvent::lost:
      return leave(ExitCode::node_lost,
                   member_.describe_peer(about) + " is gone; this node stopped after step " + std::to_string(n_),
                   now_ns);
    case PeerEvent::silent:
      if (stage_ == Stage::stepping) member_.hold(member_.silence_text(about));
      return;
    case PeerEvent::back:
      if (member_.state() != NodeState::holding) return;
      if (const std::optional<Role> silent = member_.silent_peer()) {
        member_.hold(member_.silence_text(*silent));
      } else {
        member_.set_state(n_ > 0 ? NodeState::running : NodeState::ready);
      }
      return;
    case PeerEvent::none:
      return;
  }
}

}  // namespace slew::node
