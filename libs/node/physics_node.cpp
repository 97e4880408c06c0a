#include "node/physics_node.h"

#include <algorithm>

#include "core/check.h"

namespace slew::node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// variables are read by the recorder only; the sample topics are what the partners need
std::vector<Topic> topics_of(Role role) {
  std::vector<Topic> topics = SampleExchange::topics_written(role);
  topics.push_back(Topic::variables);
  return topics;
}

bool is_end(const wire::Tick& tick) {
  return (tick.flags & static_cast<std::uint32_t>(wire::TickFlag::end)) != 0;
}

bool is_fault(const wire::Tick& tick) {
  return (tick.flags & static_cast<std::uint32_t>(wire::TickFlag::fault)) != 0;
}

// io knows all roles: it is given the time to say which one is missing
constexpr SimDuration kOwnerFirst = milliseconds(1000);

}  // namespace

PhysicsNode::PhysicsNode(Role role, transport::Transport& transport, SubsystemFactory factory, const JoinOptions& join)
    : member_(role, transport, topics_of(role), join.session),
      factory_(std::move(factory)),
      session_timeout_(join.session_timeout),
      join_timeout_(join.join_timeout),
      ticks_(kRingDepth),
      samples_(role) {}

bool PhysicsNode::poll(std::int64_t now_ns) {
  bool any = false;
  transport::Received message;
  while (stage_ != Stage::finished && member_.transport().take(message)) {
    source_ns_ = message.source_ns;
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
    case Stage::stepping:
      if (is_free_running()) return free_deadline(now_ns);
      [[fallthrough]];
    case Stage::initialising:
    case Stage::loading:
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
  Role missing = Role::io;
  if (is_follower() || ticks_.find(n_) != nullptr) {
    samples_.for_each_missing(n_, [&](Role role, Topic, StepIndex) { missing = role; });
  }
  h.is_waiting = stage_ == Stage::stepping && resend_.is_overdue();
  h.waiting_for = static_cast<std::uint8_t>(missing);
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
    case Topic::flexible:
    case Topic::elastic:
      return receive_sample(message.bytes, message.topic, now_ns);
    case Topic::resend:
      return receive_resend(message.bytes);
    case Topic::state:
      return receive_state(message.bytes);
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
  if (news == SessionNews::renewed) return renew(session, now_ns);
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
  const bool must_save = session.rejoin_ns > 0 || member_.has_state();
  if (const Status can = must_save && built_.subsystem != nullptr ? built_.subsystem->can_save() : Status::ok();
      !can.is_ok() && member_.state() != NodeState::fault) {
    member_.fail(can.code, "the state of this node cannot be taken over by another process: " + can.text +
                               "; this node does not take part; run it with session.rejoin=0, from the start");
  }
  if (member_.state() == NodeState::fault) {
    member_.publish_status_if_changed();
    stage_ = Stage::finished;
    return;
  }
  variable_values_.resize(built_.subsystem->variables().size());
  samples_.configure(member_, built_.exchange, is_free_running());
  const bool has_deadline = session.pace == wire::Pace::real;
  step_timing_.set_deadline({has_deadline ? session.step_ns * samples_.stride() : 0});
  member_.set_state(NodeState::joining);
  stage_ = Stage::joining;
}

// io says who was given up, and where the session is
void PhysicsNode::renew(const wire::SessionDescription& session, std::int64_t now_ns) {
  member_.renew(session, now_ns);
  if (!member_.is_given_up()) return;
  member_.yield();
  stage_ = Stage::finished;
}

void PhysicsNode::receive_state(std::span<const std::byte> bytes) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (stage_ != Stage::loading || !member_.fits(header, Topic::state)) return;
  if (!transport::decode(bytes, part_)) {
    ++member_.refusals().undecodable;
  } else if (part_.role == member_.role() && !taken_over_.is_whole()) {
    taken_over_.take(part_);
  }
}

void PhysicsNode::receive_tick(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  // a new epoch starts with an INIT tick
  if (member_.begins_next_epoch(header)) return restart(header);
  if (!member_.fits(header, Topic::tick)) return;
  member_.heard(header, Topic::tick, now_ns);
  if (header.phase != Phase::running) return;
  if (is_follower()) return receive_last_tick(bytes);
  if (header.step > newest_tick_) {
    newest_tick_ = header.step;
    newest_tick_ns_ = now_ns;
  }
  if (header.step >= n_ + static_cast<StepIndex>(kRingDepth)) {
    ++member_.refusals().too_far_ahead;
  } else if (header.step < n_ && is_free_running()) {
    take_late_tick(bytes);
  } else if (header.step < n_ || ticks_.find(header.step) != nullptr) {
    ++member_.refusals().duplicate;
  } else if (!transport::decode(bytes, ticks_.put(header.step))) {
    ticks_.remove(header.step);
    ++member_.refusals().undecodable;
  } else {
    measure_release(header.step);
  }
}

// A step that was done without its tick: once, for a tick that is asked for may come twice.
void PhysicsNode::take_late_tick(std::span<const std::byte> bytes) {
  wire::Tick tick;
  if (!transport::decode(bytes, tick)) {
    ++member_.refusals().undecodable;
  } else if (std::erase(missed_ticks_, tick.header.step) == 0) {
    ++member_.refusals().duplicate;
  } else {
    late_commands_.insert(late_commands_.end(), tick.commands.begin(), tick.commands.end());
    if (tick.header.step == newest_tick_) controls_.assign(tick.controls.begin(), tick.controls.end());
    if (is_end(tick)) {
      has_late_end_ = true;
      is_ended_by_fault_ = is_fault(tick);
    }
  }
}

void PhysicsNode::receive_last_tick(std::span<const std::byte> bytes) {
  if (!transport::decode(bytes, last_tick_)) {
    ++member_.refusals().undecodable;
    return;
  }
  tick_flags_ = last_tick_.flags;
  if (is_end(last_tick_)) {
    last_step_ = last_tick_.header.step;
    is_ended_by_fault_ = is_fault(last_tick_);
  }
}

void PhysicsNode::receive_sample(std::span<const std::byte> bytes, Topic topic, std::int64_t now_ns) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (!member_.fits(header, topic)) return;
  member_.heard(header, topic, now_ns);
  samples_.for_each_missing(n_, [&](Role role, Topic missing, StepIndex) {
    if (missing == topic) step_timing_.came(role, now_ns);
  });
  samples_.receive(bytes, header, topic, n_, member_.refusals());
  if (is_follower() && header.phase == Phase::running && header.step > n_) measure_release(header.step);
}

void PhysicsNode::receive_resend(std::span<const std::byte> bytes) {
  wire::ResendRequest request;
  if (!transport::decode(bytes, request)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (request.role != member_.role() || !member_.fits(request.header, Topic::resend)) return;
  if (request.topic == static_cast<std::uint8_t>(Topic::state)) return;
  if (request.topic == static_cast<std::uint8_t>(Topic::checkpoint)) {
    if (request.header.role != Role::io) return;
    save_at_ = request.header.step;
    if (stage_ == Stage::stepping && n_ == save_at_) say_state();
    return;
  }
  health().resends_answered += samples_.answer(member_, request);
}

// ---- doing ----------------------------------------------------------------------------------------------------

bool PhysicsNode::advance(std::int64_t now_ns) {
  switch (stage_) {
    case Stage::waiting_for_session:
      if (session_deadline_ns_ == 0) session_deadline_ns_ = now_ns + session_timeout_.ns;
      if (now_ns > session_deadline_ns_) {
        member_.fail(ExitCode::failed, "no session was found within " + seconds_text(session_timeout_) +
                                           "; start the io node first, and compare --session, --domain, --interface, "
                                           "--peer and --keys on both sides");
        stage_ = Stage::finished;
      }
      return false;
    case Stage::joining:
      return advance_join(now_ns);
    case Stage::initialising:
      return advance_init(now_ns);
    case Stage::loading:
      return advance_loading(now_ns);
    case Stage::stepping: {
      bool any = false;
      const auto go_on = [&] {
        if (is_follower()) return follow(now_ns);
        return is_free_running() ? advance_free(now_ns) : advance_step(now_ns);
      };
      while (stage_ == Stage::stepping && member_.send_failure().is_ok() && go_on()) any = true;
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
    stage_ = member_.has_state() ? Stage::loading : Stage::initialising;
    if (member_.has_state()) n_ = member_.session().header.step;  // so that what comes meanwhile is near
    resend_.restart(member_.has_state() ? now_ns - kResendAfter.ns : now_ns);
    return true;
  }
  if (now_ns > join_deadline_ns_) {
    leave(ExitCode::failed,
          "JOIN did not come about within " + seconds_text(join_timeout_) + ": " + member_.missing_join_text(), now_ns);
    return true;
  }
  if (member_.probe_is_due(now_ns)) {
    samples_.probe(member_);
    block_.header = member_.header(Phase::join, kJoinStep);
    if (!member_.is_heard_on(Topic::variables)) member_.publish(Topic::variables, block_);
  }
  return false;
}

bool PhysicsNode::advance_init(std::int64_t now_ns) {
  coupling::Subsystem& subsystem = *built_.subsystem;
  bool any = false;
  if (!first_sample_sent_) {
    first_sample_sent_ = true;
    if (subsystem.first_sample(own_) && samples_.has_partner()) publish_sample(Phase::init, kJoinStep, StepReport{});
    any = true;
  }
  coupling::PartnerSamples partners;
  if (!samples_.find_start(partners)) {
    ask_for_missing(now_ns);
    return any;
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
  judge_after(0);
  if (is_follower()) {
    expect_next(now_ns);
  } else {
    resend_.restart(now_ns);
  }
  save_if_due(StepReport{});
  return true;
}

// In the place of INIT: the own state at a step that the session has done, from io.
bool PhysicsNode::advance_loading(std::int64_t now_ns) {
  if (!taken_over_.is_whole()) {
    ask_for_missing(now_ns);
    return false;
  }
  wire::SampleState said;
  const Status loaded = load_node(taken_over_.checkpoint(), *built_.subsystem, said, own_);
  if (!loaded.is_ok()) {
    leave(loaded.code, loaded.text, now_ns);
    return true;
  }
  n_ = taken_over_.checkpoint().step;
  taken_over_.clear();
  go_on_from(said, now_ns);
  return true;
}

void PhysicsNode::go_on_from(const wire::SampleState& said, std::int64_t now_ns) {
  used_step_ = said.used_step;
  quality_ = said.quality;
  lost_ = said.lost;
  const wire::Header& told = member_.session().header;
  caught_up_at_ = told.epoch == member_.epoch() ? std::max(n_, told.step) : n_;
  judge_after(caught_up_at_);
  StepReport report;
  report.flags = said.flags;
  report.offender = said.offender;
  report.substeps = said.substeps;
  publish_directory();
  publish_sample(Phase::running, n_, report);
  if (n_ % built_.variables_every == 0) publish_variables(n_);
  member_.set_step(n_);
  member_.set_state(NodeState::ready);
  member_.mark_status_changed();
  stage_ = Stage::stepping;
  // what the others have said already is missing now
  resend_.restart(now_ns - kResendAfter.ns);
  save_if_due(report);
}

// A checkpoint when its step has come, and after that a part of it with every step: what a step costs is bounded.
void PhysicsNode::save_if_due(const StepReport& report) {
  if (report.has_failed()) return;
  if (n_ == save_at_) return say_state();
  const bool is_first = n_ % checkpoint_interval(built_.exchange_unit) == 0;
  const bool is_due = is_first && member_.session().rejoin_ns > 0 && n_ >= caught_up_at_;
  if (is_due && !checkpoint_.has_more()) save_node(*built_.subsystem, said_, n_, checkpoint_.next());
  if (n_ == 0) return checkpoint_.send_rest(member_);
  if (checkpoint_.has_more()) checkpoint_.send_part(member_);
}

// The whole state of this step at once, for io, which holds the ticks until it has it.
void PhysicsNode::say_state() {
  if (built_.subsystem->can_save().is_ok()) {
    save_node(*built_.subsystem, said_, n_, checkpoint_.next());
    return checkpoint_.send_rest(member_);
  }
  // no bytes: there is nothing to say
  part_ = {};
  part_.header = member_.header(Phase::running, n_);
  part_.role = member_.role();
  member_.publish(Topic::checkpoint, part_);
}

// In `real` pace the next tick is due a step later. Nobody waits for a follower: it never asks before its sample would
// be there in that pace.
void PhysicsNode::expect_next(std::int64_t now_ns) noexcept {
  const std::int64_t stride_ns = std::min(samples_.stride() * member_.session().step_ns, kResendAtMost.ns);
  const bool has_time = is_follower() || member_.session().pace == wire::Pace::real;
  resend_.restart(has_time ? now_ns + stride_ns : now_ns);
}

void PhysicsNode::apply_commands(std::span<const wire::Command> commands) {
  for (const wire::Command& command : commands) {
    built_.subsystem->change_parameter(n_, {command.path, command.value, {command.over_ns}});
  }
}

bool PhysicsNode::advance_step(std::int64_t now_ns) {
  const wire::Tick* tick = ticks_.find(n_);
  if (tick == nullptr) return false;
  if (is_end(*tick)) {
    // after a fault io's status says why, see watch()
    is_ended_by_fault_ = is_fault(*tick);
    if (!is_ended_by_fault_) leave(ExitCode::ok, "", now_ns);
    return !is_ended_by_fault_;
  }
  coupling::PartnerSamples partners;
  if (!samples_.find(n_, partners)) {
    samples_.for_each_missing(n_, [this](Role role, Topic, StepIndex) { step_timing_.waits_for(role); });
    return false;
  }
  apply_commands(tick->commands);
  tick_flags_ = tick->flags;
  used_step_ = n_ - std::max(partners.mechanism_age, partners.actuators_age);
  compute(partners, tick->controls.span(), now_ns);
  return true;
}

bool PhysicsNode::advance_free(std::int64_t now_ns) {
  const wire::Tick* tick = ticks_.find(n_);
  if (has_late_end_ || (tick != nullptr && is_end(*tick))) {
    // after a fault io's status says why, see watch()
    if (!has_late_end_) is_ended_by_fault_ = is_fault(*tick);
    if (!is_ended_by_fault_) leave(ExitCode::ok, "", now_ns);
    return !is_ended_by_fault_;
  }
  // the tick, or its time and the budget
  if (tick == nullptr && newest_tick_ < n_) {
    const bool is_far_ahead = newest_tick_ == kNoStep || n_ - newest_tick_ > member_.session().window;
    if (is_far_ahead || is_withheld(n_) || now_ns < tick_due_ns() + built_.session.wait_budget_duration().ns)
      return false;
  }
  coupling::PartnerSamples partners;
  samples_.find_newest(n_, partners);
  const StepIndex age = std::max(partners.mechanism_age, partners.actuators_age);
  // one that is behind the ticks has nothing to wait for: its partner is ahead
  if (age > 0 && newest_tick_ <= n_) {
    if (sample_due_ns_ == 0) sample_due_ns_ = now_ns + built_.session.wait_budget_duration().ns;
    if (now_ns < sample_due_ns_) return false;
  }
  sample_due_ns_ = 0;
  if (tick != nullptr) {
    controls_.assign(tick->controls.begin(), tick->controls.end());
    tick_flags_ = tick->flags;
  } else {
    if (missed_ticks_.size() == kRingDepth) missed_ticks_.erase(missed_ticks_.begin());
    missed_ticks_.push_back(n_);
  }
  apply_commands(late_commands_);
  late_commands_.clear();
  if (tick != nullptr) apply_commands(tick->commands);
  if (n_ - age > used_step_ + 1) lost_ += static_cast<std::uint32_t>(n_ - age - used_step_ - 1);
  used_step_ = std::max(used_step_, n_ - age);
  compute(partners, controls_, now_ns);
  return true;
}

// When Tick n would come if the last one had been in time.
std::int64_t PhysicsNode::tick_due_ns() const noexcept {
  return newest_tick_ns_ + (n_ - newest_tick_) * member_.session().step_ns;
}

std::int64_t PhysicsNode::free_deadline(std::int64_t now_ns) const noexcept {
  if (is_ended_by_fault_ || newest_tick_ == kNoStep) return now_ns + kProbeInterval.ns;
  const std::int64_t step =
      sample_due_ns_ > 0 ? sample_due_ns_ : tick_due_ns() + built_.session.wait_budget_duration().ns;
  return std::max(now_ns, std::min(step, missed_ticks_.empty() ? step : resend_.due_ns()));
}

// A follower's next sample is that of the step whose sample of the mechanics it needs.
bool PhysicsNode::follow(std::int64_t now_ns) {
  const StepIndex next = n_ + samples_.stride();
  if (last_step_ != kNoStep && next > last_step_) {
    // after a fault io's status says why, see watch()
    if (!is_ended_by_fault_) leave(ExitCode::ok, "", now_ns);
    return !is_ended_by_fault_;
  }
  coupling::PartnerSamples partners;
  if (!samples_.find(next, partners)) return false;
  compute(partners, {}, now_ns);
  return true;
}

void PhysicsNode::compute(const coupling::PartnerSamples& partners, std::span<const double> controls,
                          std::int64_t now_ns) {
  if (member_.state() != NodeState::running) member_.set_state(NodeState::running);
  const std::int64_t begin_ns = monotonic_ns();
  // a follower's step is released by the sample of the step that its own is of
  step_timing_.begin(is_follower() ? n_ + samples_.stride() : n_);
  StepReport report = built_.subsystem->step(n_, partners, controls, own_);
  if (added_work_.ns > 0) work_more();
  step_timing_.computed();
  const std::int64_t spent_ns = monotonic_ns() - begin_ns;
  // told beside the state, which knows no clock
  if (step_timing_.is_late()) report.raise(StepFlag::overrun);
  quality_ = report.has(StepFlag::late_input)       ? coupling::Quality::degraded
             : is_free_running() && used_step_ < n_ ? coupling::Quality::extrapolated
                                                    : coupling::Quality::ok;
  n_ += samples_.stride();
  publish_sample(Phase::running, n_, report);
  step_timing_.published();
  if (n_ % built_.variables_every == 0) publish_variables(n_);

  HealthState& h = health();
  ++h.steps_done;
  h.step_time_sum_ns += spent_ns;
  if (spent_ns > h.step_time_max_ns) h.step_time_max_ns = spent_ns;
  member_.set_step(n_);
  expect_next(now_ns);
  save_if_due(report);
  if (report.has_failed()) leave(ExitCode::diverged, divergence_text(report), now_ns);
}

void PhysicsNode::judge_after(StepIndex begin) noexcept {
  step_timing_.judge_from(begin + duration_of_seconds(built_.session.start_grace).ns / member_.session().step_ns);
}

void PhysicsNode::measure_release(StepIndex step) noexcept {
  const std::string& host = is_follower() ? member_.peer(Role::mechanics).status.host : member_.session().host;
  const bool is_local = host == member_.identity().host;
  step_timing_.release(step, sent_ns(source_ns_, is_local ? WriterClock::same : WriterClock::other));
}

void PhysicsNode::work_more() const noexcept {
  const std::int64_t end_ns = thread_cpu_ns() + added_work_.ns;
  while (thread_cpu_ns() < end_ns) {
  }
}

std::string PhysicsNode::divergence_text(const StepReport& report) const {
  const std::string head = "diverged in step " + std::to_string(n_ - 1) + ": ";
  if (const std::string_view told = built_.subsystem->failure_text(); !told.empty()) return head + std::string(told);
  return head + std::string(built_.subsystem->offender_name(report.offender)) +
         " is not finite; the last good state is kept in the recording; reduce session.step, or look at what "
         "happened just before in a plot";
}

bool PhysicsNode::advance_leaving(std::int64_t now_ns) {
  if (leave_deadline_ns_ == 0) leave_deadline_ns_ = now_ns + member_.linger().ns;
  // stays to answer resends until everybody is through
  if (member_.all_required(NodeState::ended) || now_ns > leave_deadline_ns_) stage_ = Stage::finished;
  return false;
}

// A new epoch begins at INIT, or at the step that the tick says, with the states that io has.
void PhysicsNode::restart(const wire::Header& init) {
  if (stage_ != Stage::initialising && stage_ != Stage::loading && stage_ != Stage::stepping) return;
  member_.set_epoch(init.epoch);
  built_.subsystem->reset();
  ticks_.clear();
  samples_.clear();
  n_ = std::max<StepIndex>(0, init.step);
  last_step_ = newest_tick_ = kNoStep;
  used_step_ = kJoinStep;
  lost_ = 0;
  sample_due_ns_ = 0;
  missed_ticks_.clear();
  late_commands_.clear();
  controls_.clear();
  quality_ = coupling::Quality::ok;
  has_late_end_ = false;
  first_sample_sent_ = false;
  save_at_ = kNoStep;
  caught_up_at_ = 0;
  checkpoint_.next().bytes.clear();
  taken_over_.clear();
  step_timing_.restart();
  tick_flags_ = 0;
  member_.set_step(kJoinStep);
  member_.set_state(NodeState::initialising);
  member_.mark_status_changed();
  stage_ = init.step >= 0 ? Stage::loading : Stage::initialising;
  update_health();  // INIT may come in the same poll, and takes its time
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

// ---- publishing -----------------------------------------------------------------------------------------------

void PhysicsNode::publish_sample(Phase phase, StepIndex step, const StepReport& report) {
  wire::SampleState state;
  state.level = built_.subsystem->level();
  state.used_step = is_follower() ? step : used_step_;
  state.quality = quality_;
  state.lost = lost_;
  state.state_hash = built_.subsystem->state_hash();
  state.flags = report.flags;
  state.offender = report.offender;
  state.substeps = report.substeps;
  samples_.publish(member_, phase, step, state, own_);
  said_ = state;
}

void PhysicsNode::publish_variables(StepIndex step) {
  if (built_.published_variables.empty()) return;
  // what the session leaves out is said by a block without values: nobody takes it for lost
  const bool has_values = !is_shed();
  if (has_values) built_.subsystem->read_variables(variable_values_);
  const std::size_t total = built_.published_variables.size();
  for (std::size_t first = 0; first < total; first += wire::kMaxVariablesPerBlock) {
    const std::size_t count = std::min(wire::kMaxVariablesPerBlock, total - first);
    block_.header = member_.header(Phase::running, step);
    block_.first = static_cast<std::uint32_t>(first);
    block_.values.resize(has_values ? count : 0);
    for (std::size_t i = 0; i < block_.values.size(); ++i) {
      block_.values[i] = variable_values_[built_.published_variables[first + i]];
    }
    member_.publish(Topic::variables, block_);
  }
}

bool PhysicsNode::is_shed() const noexcept {
  const auto view = static_cast<std::uint32_t>(wire::TickFlag::shed_view);
  const auto all = static_cast<std::uint32_t>(wire::TickFlag::shed_variables);
  return (tick_flags_ & (is_follower() ? view | all : all)) != 0;
}

void PhysicsNode::publish_directory() {
  const std::span<const ElementVariable> variables = built_.subsystem->variables();
  const std::size_t total = built_.published_variables.size();
  // that it has none is told too: who looks for a variable need not wait for this node
  for (std::size_t first = 0; first < total || first == 0; first += wire::kMaxVariablesPerBlock) {
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

}  // namespace slew::node
