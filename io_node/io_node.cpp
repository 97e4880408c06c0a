// SPDX-License-Identifier: Apache-2.0
#include "io_node/io_node.h"
#include "transport/roles.h"

#include <algorithm>
#include <utility>

namespace slew::io_node {
namespace {

using node::to_text;
using scene::OverrunPolicy;
using scene::ShedLoad;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

constexpr Topic kOwnTopics[] = {Topic::tick, Topic::variables};

// The end of a session with this code is no fault.
bool is_orderly(ExitCode code) noexcept {
  return code == ExitCode::ok || code == ExitCode::interrupted || code == ExitCode::terminated;
}

std::uint32_t flags_of(ShedLoad level) noexcept {
  std::uint32_t flags = 0;
  if (level >= ShedLoad::view) flags |= static_cast<std::uint32_t>(wire::TickFlag::shed_view);
  if (level >= ShedLoad::variables) flags |= static_cast<std::uint32_t>(wire::TickFlag::shed_variables);
  return flags;
}

wire::SessionDescription describe(const IoConfig& config, const node::SessionMember& member) {
  wire::SessionDescription session;
  session.name = config.session_name;
  session.scene_name = config.scene_name;
  session.scene_text = config.scene_text;
  session.assets = config.assets;
  session.build = member.identity().build;
  session.self_test = member.identity().self_test;
  session.step_ns = config.session.step_duration().ns;
  session.pace = config.session.pace;
  session.window = static_cast<std::uint32_t>(config.session.window_steps());
  session.required_roles = config.required_roles;
  session.host = member.identity().host;
  session.pid = member.identity().pid;
  session.started_ns = member.identity().started_ns;
  session.rejoin_ns = duration_of_seconds(config.session.rejoin).ns;
  session.give_up_ns = duration_of_seconds(config.session.give_up_after).ns;
  session.header = member.header(Phase::join, config.resume ? config.resume->step : kJoinStep);
  session.header.session = node::random_session_id();
  return session;
}

}  // namespace

IoNode::IoNode(transport::Transport& transport, IoConfig config)
    : member_(Role::io, transport, kOwnTopics),
      config_(std::move(config)),
      inputs_(config_, std::move(config_.sources),
              [&transport](std::uint64_t writer) { return transport.see_writer(Topic::controller_input, writer); }),
      requests_(config_, member_, inputs_),
      keeper_(config_, member_, inputs_),
      samples_(config_.session, config_.flexible_every, config_.variables_every, config_.required_roles),
      pause_(config_.starts_paused),
      clock_(config_.session, timing()),
      shedding_(config_.session.shed, (config_.required_roles & bit(Role::flex)) != 0 ? View::flex : View::none),
      times_(config_.channels.size(), config_.session.step_duration()),
      ticks_(member_, config_.channels.size(),
             node::sent_depth(duration_of_seconds(config_.session.give_up_after), config_.session.step_duration())),
      variables_(member_, inputs_.gate(), clock_, times_, timing()) {
  static_cast<void>(member_.adopt(describe(config_, member_), 0));
  if (!config_.resume) return;
  n_ = config_.resume->step;
  samples_.restart(n_);
  const Status resumed = keeper_.resume(*config_.resume);
  if (resumed.is_ok()) return;
  member_.step_aside(resumed.code, resumed.text);
  stage_ = Stage::finished;
}

bool IoNode::poll(std::int64_t now_ns) {
  bool any = false;
  transport::Received message;
  while (stage_ != Stage::finished && member_.transport().take(message)) {
    health().turn();
    receive(message, now_ns);
    any = true;
  }
  any |= advance(now_ns);
  if (const Status& failure = member_.send_failure(); !failure.is_ok())
    begin_ending(failure.code, failure.text, now_ns);
  watch(now_ns);
  if (stage_ != Stage::checking_name) member_.publish_status_if_changed();
  update_statistics(now_ns);
  update_health();
  return any;
}

std::int64_t IoNode::next_deadline(std::int64_t now_ns) const {
  if (stage_ == Stage::joining) return now_ns + node::kProbeInterval.ns / 2;
  if (stage_ != Stage::ticking) return now_ns + node::kProbeInterval.ns;
  if (keeper_.holds_tick(n_)) return std::max(now_ns, keeper_.request_due_ns());
  if (pause_.withholds_tick() || controllers_.is_for_holders()) return now_ns + node::kProbeInterval.ns;
  if (controllers_.values_since_ns() != 0) {
    return std::max(now_ns, controllers_.values_since_ns() + inputs_.gate().awaited(n_).ns);
  }
  return std::max(now_ns, partners_allow_tick() ? due_ns() : samples_.request_due_ns());
}

void IoNode::request_stop(ExitCode code) {
  begin_ending(code, "", 0);
}

void IoNode::update_health() noexcept {
  node::HealthState& h = health();
  h.state = static_cast<std::uint8_t>(member_.state());
  h.step = n_;
  h.epoch = member_.epoch();
  h.slip_ns = clock_.slip_ns();
  h.refused = member_.refusals().refused();
  const bool waits_for_controller = controllers_.is_waiting();
  h.is_waiting = stage_ == Stage::ticking && (waits_for_controller || !partners_allow_tick());
  h.waiting_for = static_cast<std::uint8_t>(waits_for_controller ? Role::controller
                                                                 : samples_.missing(n_).value_or(Role::recorder));
  h.waiting_step = n_;
  h.has_session.store(stage_ != Stage::checking_name, std::memory_order_release);
}

// ---- stages ---------------------------------------------------------------------------------------------------

bool IoNode::advance(std::int64_t now_ns) {
  if (keeper_.is_loading()) advance_loading(now_ns);
  switch (stage_) {
    case Stage::checking_name:
      return advance_name_check(now_ns);
    case Stage::joining:
      return advance_join(now_ns);
    case Stage::initialising:
      return advance_initialising(now_ns);
    case Stage::ticking:
      return advance_ticks(now_ns);
    case Stage::ending:
      return advance_ending(now_ns);
    case Stage::finished:
      return false;
  }
  return false;
}

bool IoNode::advance_name_check(std::int64_t now_ns) {
  if (deadline_ns_ == 0) {
    deadline_ns_ = now_ns + config_.name_check.ns;
    // two that start together must receive each other's claim
    if (config_.name_check.ns > 0) publish_session(Phase::join);
  }
  if (now_ns < deadline_ns_) return false;
  publish_session(Phase::running);
  member_.set_state(NodeState::joining);
  stage_ = Stage::joining;
  deadline_ns_ = now_ns + config_.join_timeout.ns;
  return true;
}

bool IoNode::advance_join(std::int64_t now_ns) {
  if (member_.is_acknowledged_by_all()) {
    member_.set_state(NodeState::ready);
    stage_ = Stage::initialising;
    deadline_ns_ = now_ns + config_.join_timeout.ns;
    return true;
  }
  if (now_ns > deadline_ns_) {
    begin_ending(ExitCode::failed, member_.join_failure_text(config_.join_timeout), now_ns);
    return true;
  }
  if (member_.probe_is_due(now_ns)) {
    wire::Tick probe;
    probe.header = member_.header(Phase::join, kJoinStep);
    member_.publish(Topic::tick, probe);
    if (!member_.is_acknowledged_on(Topic::variables)) variables_.publish_probe();
  }
  return false;
}

bool IoNode::advance_initialising(std::int64_t now_ns) {
  if (!member_.all_required(NodeState::ready)) {
    if (now_ns > deadline_ns_) {
      begin_ending(ExitCode::failed,
                   "not every node became ready within " + seconds_text(config_.join_timeout) + ": " + not_ready_text(),
                   now_ns);
    }
    return false;
  }
  variables_.publish_directory();
  member_.set_step(n_);
  show_running();
  stage_ = Stage::ticking;
  clock_.begin(n_, now_ns);
  times_.begin(now_ns);
  samples_.expect(now_ns);
  // where roles are held, no tick goes out before every node can be replaced
  if (config_.session.rejoin > 0) keeper_.begin_collecting(n_, now_ns);
  return true;
}

std::string IoNode::not_ready_text() const {
  std::string text;
  for (const Role role : transport::node_roles()) {
    if (role == Role::io) continue;
    const node::Peer& peer = member_.peer(role);
    if (!member_.requires_role(role) || (peer.is_known && peer.status.state >= NodeState::ready)) continue;
    text += (text.empty() ? "" : "; ") + member_.describe_peer(role) + " is " + std::string(to_text(peer.status.state));
  }
  return text;
}

bool IoNode::advance_ticks(std::int64_t now_ns) {
  bool any = false;
  if (is_paced()) {
    apply_overrun_action(clock_.completed(samples_.complete_up_to(n_), n_, now_ns), now_ns);
    if (config_.session.shed != ShedLoad::none) shed_load();
  }
  while (stage_ == Stage::ticking && member_.send_failure().is_ok()) {
    if (keeper_.holds_tick(n_)) {
      if (!advance_saving(now_ns)) return any;
      clock_.excuse(n_, now_ns);
    }
    if (is_over()) {
      begin_ending(ExitCode::ok, "", now_ns);
      return true;
    }
    if (pause_.withholds_tick()) {
      controllers_.end_values(now_ns);
      times_.end_wait();
      end_stall(now_ns);
      return any;
    }
    if (!has_holders(now_ns)) return any;
    count_wait(now_ns);
    if (!partners_allow_tick()) {
      health().resends_asked += samples_.request_missing(n_, now_ns, member_);
      watch_stall(now_ns);
      return any;
    }
    end_stall(now_ns);
    if (is_paced()) {
      if (!keep_time(now_ns)) return true;
      if (now_ns < due_ns()) return any;
    }
    if (controllers_.look_for_values(inputs_.gate().awaited(n_), now_ns)) return any;
    issue_tick(now_ns);
    any = true;
  }
  return any;
}

// ---- ticks ----------------------------------------------------------------------------------------------------

bool IoNode::is_over() const noexcept {
  return config_.session.duration > 0 && n_ >= config_.session.steps();
}

bool IoNode::recorder_allows_tick() const noexcept {
  if (is_paced() || !member_.requires_role(Role::recorder)) return true;
  const wire::NodeStatus& recorder = member_.peer(Role::recorder).status;
  return recorder.header.epoch != member_.epoch() || recorder.recorded_step >= n_ - kRecorderWindow;
}

// Time of the next tick; a session that is late catches up at no more than twice real time.
std::int64_t IoNode::due_ns() const noexcept {
  if (!is_paced()) return 0;
  return std::max(clock_.due_ns(n_), times_.last_tick_ns() + config_.session.step_duration().ns / 2);
}

// False: the first step of an epoch waits for a holder of each lockstep channel.
bool IoNode::has_holders(std::int64_t now_ns) {
  const int vacant = n_ == keeper_.begin_step() ? inputs_.gate().vacant() : -1;
  const ControllerWait::Event event = controllers_.look_for_holders(vacant >= 0, now_ns, config_.join_timeout);
  if (event == ControllerWait::Event::times_out) {
    const std::string& name = inputs_.gate().config(static_cast<std::size_t>(vacant)).name;
    begin_ending(ExitCode::failed,
                 "no controller took channel " + name + " within " + seconds_text(config_.join_timeout) +
                     ", and the scene has it as controller: lockstep; nothing was computed; start the controller with "
                     "the session (--join-timeout waits longer), or run with --set " +
                     name + ".controller=sampled",
                 now_ns);
    return false;
  }
  // this wait is no slip
  if (event == ControllerWait::Event::ends) clock_.excuse(n_, now_ns);
  if (event != ControllerWait::Event::none) show_running();
  return vacant < 0;
}

// False: the overrun policy holds or ends the session.
bool IoNode::keep_time(std::int64_t now_ns) {
  if (pause_.is_paused()) {
    clock_.excuse(n_, now_ns);  // a single step is due on its request
    return true;
  }
  const std::optional<OverrunAction> action = clock_.keep_time(n_, now_ns);
  apply_overrun_action(action, now_ns);
  return !action || action->what == OverrunPolicy::slip;
}

// A tick that is due waits for the role whose sample is missing; io's own place counts for the values of lockstep
// controllers.
void IoNode::count_wait(std::int64_t now_ns) noexcept {
  std::optional<Role> role = samples_.missing(n_);
  if (!role && inputs_.gate().awaited(n_).ns > 0) role = Role::io;
  times_.count_wait(role, clock_.is_judged(n_) ? due_ns() : now_ns, now_ns, timing());
}

void IoNode::issue_tick(std::int64_t now_ns) {
  // time in which the session stood still is no silence of a controller
  const std::int64_t waited_ns = controllers_.end_values(now_ns);
  const SimDuration standstill{now_ns - times_.last_tick_ns() - waited_ns};
  if (standstill > kStandstill) inputs_.gate().excuse(standstill, now_ns);
  wire::Tick& tick = ticks_.tick();
  inputs_.advance(n_, now_ns, tick.commands);
  requests_.publish_notices(n_);
  tick.header = member_.header(Phase::running, n_);
  tick.flags = flags_of(shedding_.level());
  const InputGate& gate = inputs_.gate();
  tick.controls.resize(gate.size());
  tick.age.resize(gate.size());
  for (std::size_t i = 0; i < gate.size(); ++i) {
    tick.controls[i] = gate.control(i);
    tick.age[i] = gate.age(i);
  }
  tick.state_hash = member_.transport().needs_bytes(Topic::tick) ? inputs_.state_hash(n_) : 0;
  ticks_.send(n_);
  times_.count_tick(n_, now_ns);
  if (is_paced()) {
    clock_.ran(n_, now_ns);
    clock_.used_input(n_, times_.use_values());
  }
  if (n_ % config_.variables_every == 0) variables_.publish(n_, now_ns);

  ++n_;
  ++health().steps_done;
  member_.set_step(n_);
  samples_.expect(std::max(now_ns, due_ns()));
  if (pause_.count_tick()) show_running();
}

void IoNode::send_end(std::uint32_t flags) {
  wire::Tick& tick = ticks_.tick();
  tick.commands.clear();
  tick.header = member_.header(Phase::running, n_);
  tick.flags = static_cast<std::uint32_t>(wire::TickFlag::end) | flags;
  ticks_.send(n_);
}

// ---- statistics, status ---------------------------------------------------------------------------------------

// A change by the overrun policy is an event in the recording; standard error receives a hold and the first slip.
void IoNode::apply_overrun_action(const std::optional<OverrunAction>& action, std::int64_t now_ns) {
  if (!action || action->why.empty()) return;
  const char* then = "";
  if (action->what == OverrunPolicy::hold) then = "; it is paused; 'slewring control resume' lets it go on";
  if (action->what == OverrunPolicy::stop) {
    then = "; it was ended, what was recorded is valid; take a larger session.step, --rt, or session.overrun: slip";
  }
  const std::string text = action->why + then;
  requests_.publish_event(text, n_);
  if (action->is_for_recording_alone) return;
  switch (action->what) {
    case OverrunPolicy::slip:
      if (!std::exchange(warned_.slip, true)) member_.warn(text);
      return;
    case OverrunPolicy::hold:
      member_.warn(text);
      pause_.begin();
      return show_running();
    case OverrunPolicy::stop:
      return begin_ending(ExitCode::losses, text, now_ns);
  }
}

void IoNode::shed_load() {
  const InputGate& gate = inputs_.gate();
  bool has_controllers = false;
  for (std::size_t i = 0; i < gate.size(); ++i) {
    has_controllers |= gate.is_held(i) || gate.config(i).controller == scene::ControllerMode::lockstep;
  }
  const std::string event = shedding_.look(n_, timing().response.count(), timing().overruns,
                                           has_controllers ? Steering::controllers : Steering::none);
  if (event.empty()) return;
  requests_.publish_event(event, n_);
  ++timing().transitions;
  const std::uint32_t level = 1u << static_cast<unsigned>(shedding_.level());
  if ((warned_.levels & level) == 0) member_.warn(event + "; the next time this is in the recording alone");
  warned_.levels |= level;
}

void IoNode::update_statistics(std::int64_t now_ns) noexcept {
  if (!is_paced() || stage_ >= Stage::ending) return;
  const bool is_held = pause_.is_paused() || controllers_.is_for_holders() || keeper_.holds_tick(n_) ||
                       keeper_.is_replacing() || stage_ != Stage::ticking;
  if (is_held) {
    clock_.excuse(n_, now_ns);
    times_.restart_values(now_ns);
  }
  clock_.close(n_, now_ns);
}

// Status of a session that ticks: it runs, it waits for a node or a controller, or ticks are withheld on request.
void IoNode::show_running() {
  if (keeper_.is_holding()) {
    member_.hold(keeper_.held_text());
  } else if (const std::optional<Role> silent = member_.silent_peer()) {
    member_.hold(member_.silence_text(*silent));
  } else if (stall_.is_named()) {
    member_.hold(stall_.text(member_, health().resends_asked));
  } else if (pause_.withholds_tick()) {
    member_.hold("");
  } else if (controllers_.is_for_holders()) {
    const int vacant = inputs_.gate().vacant();
    member_.hold("step " + std::to_string(n_) + " waits for a controller on channel " +
                 inputs_.gate().config(static_cast<std::size_t>(vacant)).name);
  } else {
    member_.set_state(NodeState::running);
  }
}

// ---- states ---------------------------------------------------------------------------------------------------

void IoNode::begin_saving(const wire::ControlRequest& request, std::int64_t now_ns) {
  const std::string why = keeper_.begin_saving(request, n_, pause_.stops_at(n_), now_ns);
  if (why.empty()) {
    advance_saving(now_ns);
  } else if (request.request != 0) {
    requests_.answer({request, false, why, n_});
  }
}

// False: the tick of the saved step must wait.
bool IoNode::advance_saving(std::int64_t now_ns) {
  const StateKeeper::Progress progress = keeper_.advance_saving(n_, now_ns);
  if (progress.answer) requests_.answer(*progress.answer);
  return progress.is_over;
}

void IoNode::advance_loading(std::int64_t now_ns) {
  const std::optional<ControlAnswer> answer = keeper_.advance_loading(stage_ == Stage::ticking, n_, now_ns);
  if (!answer) return;
  requests_.answer(*answer);
  if (!answer->is_accepted) return;
  const StateKeeper::Upload upload = keeper_.take_upload();
  start_epoch(now_ns, answer->step);
  keeper_.load(upload);
}

// ---- session --------------------------------------------------------------------------------------------------

// from: step whose states io has; kJoinStep: the epoch begins with INIT.
void IoNode::start_epoch(std::int64_t now_ns, StepIndex from) {
  member_.set_epoch(member_.epoch() + 1);
  n_ = std::max<StepIndex>(0, from);
  inputs_.reset();
  pause_.drop_steps();
  controllers_.reset();
  times_.drop_values();
  samples_.restart(n_);
  keeper_.begin_epoch(n_);
  ticks_.restart();
  ticks_.tick().header = member_.header(Phase::init, from);
  ticks_.send(kJoinStep);
  requests_.publish_notices(n_);
  member_.set_step(kJoinStep);
  member_.set_state(NodeState::initialising);
  member_.mark_status_changed();
  stage_ = Stage::initialising;
  deadline_ns_ = now_ns + config_.join_timeout.ns;
  // for nodes that join later
  renew_session(from, now_ns);
}

void IoNode::publish_session(Phase phase) {
  wire::SessionDescription session = member_.session();
  session.header.phase = phase;
  if (phase == Phase::ended) {
    session.scene_text.clear();
    session.assets.clear();
  }
  member_.publish(Topic::session, session);
}

// Publishes the session at this step, kJoinStep: at INIT; given_up: a role whose process is ignored from now on.
void IoNode::renew_session(StepIndex step, std::int64_t now_ns, std::optional<Role> given_up) {
  wire::SessionDescription session = member_.session();
  session.header = member_.header(Phase::running, step);
  if (given_up) session.given_up.push_back({*given_up, member_.peer(*given_up).incarnation});
  member_.renew(session, now_ns);
  member_.publish(Topic::session, session);
}

void IoNode::begin_ending(ExitCode code, const std::string& reason, std::int64_t now_ns) {
  if (stage_ == Stage::ending || stage_ == Stage::finished) return;
  const bool was_ticking = stage_ == Stage::ticking;
  if (now_ns != 0) update_statistics(now_ns);
  if (was_ticking) send_end(is_orderly(code) ? 0 : static_cast<std::uint32_t>(wire::TickFlag::fault));
  if (is_orderly(code) && was_ticking) {
    member_.end(code, reason);
  } else {
    member_.fail(code, reason.empty() ? "ended before the first step" : reason);
  }
  stage_ = Stage::ending;
  deadline_ns_ = now_ns == 0 ? 0 : now_ns + member_.linger().ns;
}

bool IoNode::advance_ending(std::int64_t now_ns) {
  if (deadline_ns_ == 0) deadline_ns_ = now_ns + member_.linger().ns;
  if (member_.all_required(NodeState::ended) || now_ns > deadline_ns_) stage_ = Stage::finished;
  return false;
}

}  // namespace slew::io_node
