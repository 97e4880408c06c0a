// SPDX-License-Identifier: Apache-2.0
#include "node/physics_node.h"

#include <algorithm>
#include <utility>

#include "core/check.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// the recorder alone reads variables; the partners read the samples
std::vector<Topic> topics_of(Role role) {
  std::vector<Topic> topics = SampleExchange::topics_written(role);
  topics.push_back(Topic::variables);
  return topics;
}

// State in a sample before a step has used a sample of the partner.
wire::SampleState start_state() {
  wire::SampleState state;
  state.used_step = kJoinStep;
  return state;
}

// io receives from all roles: its report of the missing one comes before that of this node
constexpr SimDuration kOwnerFirst = milliseconds(1000);

}  // namespace

PhysicsNode::PhysicsNode(Role role, transport::Transport& transport, SubsystemFactory factory, const JoinOptions& join)
    : member_(role, transport, topics_of(role), join.session),
      factory_(std::move(factory)),
      join_(join),
      samples_(role),
      published_(start_state()) {}

bool PhysicsNode::poll(std::int64_t now_ns) {
  bool any = false;
  transport::Received message;
  while (stage_ != Stage::finished && member_.transport().take(message)) {
    health().turn();
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
    case Stage::loading:
    case Stage::stepping: {
      // after a fault nothing is requested: io publishes its status by itself
      if (loop_->is_ended_by_fault()) return now_ns + kProbeInterval.ns;
      const std::int64_t due_ns = resend_.due_ns();
      return std::max(now_ns, stage_ == Stage::stepping ? loop_->next_poll_ns(n_, now_ns, due_ns) : due_ns);
    }
    default:
      return now_ns + kProbeInterval.ns;
  }
}

void PhysicsNode::request_stop(ExitCode code) {
  leave(code, "ended by a signal", 0);
}

// ---- stages ---------------------------------------------------------------------------------------------------

bool PhysicsNode::advance(std::int64_t now_ns) {
  switch (stage_) {
    case Stage::waiting_for_session:
      wait_for_session(now_ns);
      return false;
    case Stage::joining:
      return advance_join(now_ns);
    case Stage::initialising:
      return advance_init(now_ns);
    case Stage::loading:
      return advance_loading(now_ns);
    case Stage::stepping:
      return advance_stepping(now_ns);
    case Stage::leaving:
      advance_leaving(now_ns);
      return false;
    case Stage::finished:
      return false;
  }
  return false;
}

void PhysicsNode::wait_for_session(std::int64_t now_ns) {
  if (deadline_ns_ == 0) deadline_ns_ = now_ns + join_.session_timeout.ns;
  if (now_ns <= deadline_ns_) return;
  member_.fail(ExitCode::failed, "no session was found within " + seconds_text(join_.session_timeout) +
                                     "; start the io node first, and compare --session, --domain, --interface, "
                                     "--peer and --keys on both sides");
  stage_ = Stage::finished;
}

bool PhysicsNode::advance_join(std::int64_t now_ns) {
  if (deadline_ns_ == 0) deadline_ns_ = now_ns + join_.join_timeout.ns + kOwnerFirst.ns;
  if (member_.is_acknowledged_by_all()) {
    member_.set_state(NodeState::initialising);
    stage_ = member_.has_state() ? Stage::loading : Stage::initialising;
    if (member_.has_state()) n_ = member_.session().header.step;  // messages that arrive meanwhile are within the rings
    resend_.restart(member_.has_state() ? now_ns - kResendAfter.ns : now_ns);
    return true;
  }
  if (now_ns > deadline_ns_) {
    leave(ExitCode::failed, member_.join_failure_text(join_.join_timeout), now_ns);
    return true;
  }
  if (member_.probe_is_due(now_ns)) {
    samples_.probe(member_);
    variables_.probe(member_);
  }
  return false;
}

bool PhysicsNode::advance_init(std::int64_t now_ns) {
  bool any = false;
  if (!first_sample_sent_) {
    first_sample_sent_ = true;
    if (built_.subsystem->first_sample(own_) && samples_.has_partner()) publish_sample(Phase::init, kJoinStep);
    any = true;
  }
  coupling::PartnerSamples partners;
  if (!samples_.find_start(partners)) {
    request_missing(now_ns);
    return any;
  }
  const Status started = built_.subsystem->start(partners, own_);
  if (!started.is_ok()) {
    leave(started.code, started.text, now_ns);
    return true;
  }
  // the sample of a follower uses that of the same step
  if (is_follower()) published_.used_step = 0;
  variables_.publish_directory(member_);
  publish_sample(Phase::running, 0);
  publish_variables(0);
  get_ready();
  judge_after(0);
  if (is_follower()) {
    expect_next(now_ns);
  } else {
    resend_.restart(now_ns);
  }
  states_.save_if_due(member_, n_, published_);
  return true;
}

// Instead of INIT: takes over the own state at a step that the session has done, from io.
bool PhysicsNode::advance_loading(std::int64_t now_ns) {
  if (!states_.has_state()) {
    request_missing(now_ns);
    return false;
  }
  if (const Status loaded = states_.load(member_, n_, published_, own_); !loaded.is_ok()) {
    leave(loaded.code, loaded.text, now_ns);
    return true;
  }
  loop_->take_over(published_);
  judge_after(states_.caught_up_at());
  variables_.publish_directory(member_);
  publish_sample(Phase::running, n_);
  if (n_ % built_.variables_every == 0) publish_variables(n_);
  get_ready();
  // the messages that the other nodes have published since that step are missing now
  resend_.restart(now_ns - kResendAfter.ns);
  states_.save_if_due(member_, n_, published_);
  return true;
}

void PhysicsNode::get_ready() noexcept {
  member_.set_step(n_);
  member_.set_state(NodeState::ready);
  member_.mark_status_changed();
  stage_ = Stage::stepping;
}

bool PhysicsNode::advance_stepping(std::int64_t now_ns) {
  bool any = false;
  while (stage_ == Stage::stepping && member_.send_failure().is_ok() && advance_step(now_ns)) any = true;
  if (!any) request_missing(now_ns);
  return any;
}

bool PhysicsNode::advance_step(std::int64_t now_ns) {
  StepInput input;
  switch (loop_->next(n_, now_ns, input)) {
    case StepLoop::Next::wait:
      return false;
    case StepLoop::Next::step:
      do_step(input, now_ns);
      return true;
    case StepLoop::Next::end:
      leave(ExitCode::ok, "", now_ns);
      return true;
  }
  return false;
}

void PhysicsNode::advance_leaving(std::int64_t now_ns) {
  if (leave_deadline_ns_ == 0) leave_deadline_ns_ = now_ns + member_.linger().ns;
  // answers resend requests until all nodes have ended
  if (member_.all_required(NodeState::ended) || now_ns > leave_deadline_ns_) stage_ = Stage::finished;
}

// A new epoch begins at INIT, or at the step of the INIT tick, with the states that io has.
void PhysicsNode::restart(const wire::Header& init) {
  if (stage_ != Stage::initialising && stage_ != Stage::loading && stage_ != Stage::stepping) return;
  member_.set_epoch(init.epoch);
  built_.subsystem->reset();
  loop_->restart();
  samples_.clear();
  states_.restart();
  step_timing_.restart();
  n_ = std::max<StepIndex>(0, init.step);
  published_ = start_state();
  first_sample_sent_ = false;
  member_.set_step(kJoinStep);
  member_.set_state(NodeState::initialising);
  member_.mark_status_changed();
  stage_ = init.step >= 0 ? Stage::loading : Stage::initialising;
  update_health();  // INIT may follow in the same poll and take long
}

void PhysicsNode::leave(ExitCode code, const std::string& reason, std::int64_t now_ns) {
  if (stage_ == Stage::leaving || stage_ == Stage::finished) return;
  if (code == ExitCode::ok) {
    member_.end(code);
  } else {
    member_.fail(code, reason);
  }
  leave_deadline_ns_ = now_ns == 0 ? 0 : now_ns + member_.linger().ns;
  stage_ = member_.has_session() ? Stage::leaving : Stage::finished;
}

// ---- a step ---------------------------------------------------------------------------------------------------

void PhysicsNode::do_step(const StepInput& input, std::int64_t now_ns) {
  apply_commands(input.late_commands);
  apply_commands(input.commands);
  if (member_.state() != NodeState::running) member_.set_state(NodeState::running);
  step_timing_.begin(input.released_by);
  StepReport report = built_.subsystem->step(n_, input.partners, input.controls, own_);
  if (added_work_.ns > 0) burn_added_work();
  const std::int64_t spent_ns = step_timing_.computed();
  // a flag of the sample only: no clock enters the hashed state
  if (step_timing_.is_late()) report.raise(StepFlag::overrun);

  published_.used_step = input.used_step;
  published_.lost = input.lost;
  published_.quality = report.has(StepFlag::late_input) ? coupling::Quality::degraded : input.quality;
  published_.flags = report.flags;
  published_.offender = report.offender;
  published_.substeps = report.substeps;
  n_ += samples_.stride();
  publish_sample(Phase::running, n_);
  step_timing_.published();
  if (n_ % built_.variables_every == 0) publish_variables(n_);

  count_step(spent_ns);
  member_.set_step(n_);
  expect_next(now_ns);
  states_.save_if_due(member_, n_, published_);
  if (report.has_failed()) leave(ExitCode::diverged, divergence_text(report), now_ns);
}

void PhysicsNode::apply_commands(std::span<const wire::Command> commands) {
  for (const wire::Command& command : commands) {
    built_.subsystem->change_parameter(n_, {command.path, command.value, {command.over_ns}});
  }
}

void PhysicsNode::publish_sample(Phase phase, StepIndex step) {
  published_.level = built_.subsystem->level();
  // nodes do not read the hash: it is for those that record and compare
  const bool is_hashed = member_.transport().needs_bytes(transport::traits(member_.role()).sample);
  published_.state_hash = is_hashed ? built_.subsystem->state_hash() : 0;
  samples_.publish(member_, phase, step, published_, own_);
}

void PhysicsNode::publish_variables(StepIndex step) {
  if (loop_->sheds_variables()) return variables_.publish_shed(member_, step);
  variables_.publish(member_, step);
}

void PhysicsNode::count_step(std::int64_t spent_ns) noexcept {
  HealthState& h = health();
  ++h.steps_done;
  h.step_time_sum_ns += spent_ns;
  if (spent_ns > h.step_time_max_ns) h.step_time_max_ns = spent_ns;
}

void PhysicsNode::judge_after(StepIndex begin) noexcept {
  step_timing_.judge_from(begin + duration_of_seconds(built_.session.start_grace).ns / member_.session().step_ns);
}

void PhysicsNode::burn_added_work() const noexcept {
  const std::int64_t end_ns = thread_cpu_ns() + added_work_.ns;
  while (thread_cpu_ns() < end_ns) {
  }
}

std::string PhysicsNode::divergence_text(const StepReport& report) const {
  const std::string head = "diverged in step " + std::to_string(n_ - 1) + ": ";
  if (const std::string_view cause = built_.subsystem->failure_text(); !cause.empty()) return head + std::string(cause);
  return head + std::string(built_.subsystem->offender_name(report.offender)) +
         " is not finite; the last good state is kept in the recording; reduce session.step, or look at what "
         "happened just before in a plot";
}

}  // namespace slew::node
