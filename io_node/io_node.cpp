#include "io_node/io_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "node/sample_exchange.h"
#include "transport/roles.h"

namespace slew::io_node {
namespace {

using node::to_text;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

constexpr Topic kOwnTopics[] = {Topic::tick, Topic::variables};

// A gate that can look for the processes behind controllers.
GateConfig seeing(GateConfig gate, transport::Transport& transport) {
  gate.see_writer = [&transport](std::uint64_t writer) {
    return transport.see_writer(Topic::controller_input, writer);
  };
  return gate;
}

}  // namespace

IoNode::IoNode(transport::Transport& transport, IoConfig config)
    : member_(Role::io, transport, kOwnTopics),
      config_(std::move(config)),
      H_(config_.session.step_duration()),
      rejoin_(duration_of_seconds(config_.session.rejoin)),
      gate_(config_.channels, seeing(config_.gate(), transport), H_),
      parameters_(config_.parameters, H_),
      is_paused_(config_.starts_paused),
      clock_(config_.session, timing()),
      shedding_(config_.session.shed, (config_.required_roles & bit(Role::flex)) != 0 ? View::flex : View::none),
      input_ns_(config_.channels.size()),
      tick_ns_(static_cast<std::size_t>(kLoopMemory)),
      script_(config_.channels.size()) {
  newest_.fill(kJoinStep);
  tick_.controls.resize(gate_.size());
  tick_.age.resize(gate_.size());
  if (config_.source) {
    const std::size_t pieces = config_.source->most_pieces(H_);
    gate_.reserve(pieces);
    for (SignalCourse& raw : script_) raw.reserve(pieces);
  }
  const SimDuration give_up_after = duration_of_seconds(config_.session.give_up_after);
  sent_.set_depth(node::sent_depth(give_up_after, H_));
  if (transport::encode(tick_, buffer_)) sent_.reserve(buffer_.size());
  description_.name = config_.session_name;
  description_.scene_name = config_.scene_name;
  description_.scene_text = config_.scene_text;
  description_.assets = config_.assets;
  description_.build = member_.identity().build;
  description_.self_test = member_.identity().self_test;
  description_.step_ns = H_.ns;
  description_.pace = config_.session.pace;
  description_.window = static_cast<std::uint32_t>(config_.session.window_steps());
  description_.required_roles = config_.required_roles;
  description_.host = member_.identity().host;
  description_.pid = member_.identity().pid;
  description_.started_ns = member_.identity().started_ns;
  description_.rejoin_ns = rejoin_.ns;
  description_.give_up_ns = give_up_after.ns;
  description_.header = member_.header(Phase::join, config_.beginning ? config_.beginning->step : kJoinStep);
  description_.header.session = node::random_session_id();
  static_cast<void>(member_.adopt(description_, 0));
  if (config_.beginning) begin_with(*config_.beginning);
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
  keep_books(now_ns);
  update_health();
  return any;
}

std::int64_t IoNode::next_deadline(std::int64_t now_ns) const {
  if (stage_ == Stage::joining) return now_ns + node::kProbeInterval.ns / 2;
  if (stage_ != Stage::ticking) return now_ns + node::kProbeInterval.ns;
  if (is_saving_now()) return std::max(now_ns, saving_->resend.due_ns());
  if (is_withheld()) return now_ns + node::kProbeInterval.ns;
  if (controllers_due_ns_ != 0) return now_ns + node::kProbeInterval.ns;
  if (controllers_wait_ns_ != 0) return std::max(now_ns, controllers_wait_ns_ + gate_.awaited(n_).ns);
  if (partners_allow(n_)) return std::max(now_ns, due_ns(n_));
  return std::max(now_ns, resend_.due_ns());
}

void IoNode::request_stop(ExitCode code) {
  if (stage_ == Stage::ending || stage_ == Stage::finished) return;
  begin_ending(code, "", 0);
}

void IoNode::update_health() noexcept {
  node::HealthState& h = health();
  h.state = static_cast<std::uint8_t>(member_.state());
  h.step = n_;
  h.epoch = member_.epoch();
  h.slip_ns = clock_.slip_ns();
  h.refused = member_.refusals().refused();
  const bool waits_for_controller = controllers_due_ns_ != 0 || controllers_wait_ns_ != 0;
  h.is_waiting = stage_ == Stage::ticking && (waits_for_controller || !partners_allow(n_));
  h.waiting_for =
      static_cast<std::uint8_t>(waits_for_controller ? Role::controller : holds_back(n_).value_or(Role::recorder));
  h.waiting_step = n_;
  h.has_session.store(stage_ != Stage::checking_name, std::memory_order_release);
}

// ---- receiving ------------------------------------------------------------------------------------------------

void IoNode::receive(const transport::Received& message, std::int64_t now_ns) {
  source_ns_ = message.source_ns;
  writer_ = message.writer;
  switch (message.topic) {
    case Topic::session:
      return receive_session(message.bytes);
    case Topic::node_status: {
      const Status refusal = member_.on_node_status(message.bytes, now_ns);
      if (!refusal.is_ok()) {
        member_.step_aside(refusal.code, refusal.text);
        stage_ = Stage::finished;
      }
      return;
    }
    case Topic::health:
      keep_health(message.bytes);
      return member_.on_health(message.bytes, now_ns);
    case Topic::mechanism:
    case Topic::actuators:
    case Topic::elastic:
    case Topic::sensors:
      return receive_sample(message.bytes, message.topic, now_ns);
    case Topic::controller_input:
      return receive_controller(message.bytes, now_ns);
    case Topic::control_request:
      return receive_control(message.bytes, now_ns);
    case Topic::resend:
      return receive_resend(message.bytes, now_ns);
    case Topic::checkpoint:
      return receive_checkpoint(message.bytes);
    case Topic::state:
      return receive_upload(message.bytes, now_ns);
    default:
      return;
  }
}

// Two sessions of one name: a description in phase JOIN claims the name, one in phase RUNNING holds it. The holder
// stays; of two that claim or hold together, because both started at one instant, the lower id stays.
void IoNode::receive_session(std::span<const std::byte> bytes) {
  wire::SessionDescription other;
  if (!transport::decode(bytes, other) || other.name != config_.session_name) return;
  if (other.header.session == description_.header.session) return;
  if (stage_ != Stage::checking_name && stage_ != Stage::joining) return;
  const bool other_holds = other.header.phase == Phase::running;
  const bool this_holds = stage_ == Stage::joining;
  if (this_holds && !other_holds) return;
  if (this_holds == other_holds && description_.header.session < other.header.session) return;
  // nodes that have followed this description look for another one
  if (this_holds) withdraw_session();
  member_.step_aside(ExitCode::bad_input,
                     "session '" + config_.session_name + "' is held by process " + std::to_string(other.pid) + " on " +
                         node::machine_of(other.host) + ", started " + node::time_text(other.started_ns) +
                         "; this second one ends; stop the first, or choose another --session name");
  stage_ = Stage::finished;
}

void IoNode::withdraw_session() {
  description_.header.phase = Phase::ended;
  description_.scene_text.clear();
  description_.assets.clear();
  member_.publish(Topic::session, description_);
}

void IoNode::receive_sample(std::span<const std::byte> bytes, Topic topic, std::int64_t now_ns) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (!member_.fits(header, topic)) return;
  member_.acknowledge(header, topic, now_ns);
  if (header.phase != Phase::running) return;
  // nobody can be further than the ticks that were sent, but a free-running node, which does not wait for them
  if (header.step >
      n_ + (config_.session.mode == scene::ExchangeMode::free_running ? config_.session.window_steps() : 0)) {
    ++member_.refusals().too_far_ahead;
    return;
  }
  StepIndex& at = newest_of(header.role);
  Replaced& replaced = replaced_[static_cast<std::size_t>(header.role)];
  if (replaced.until != kJoinStep && header.step >= replaced.until) {
    replaced.until = kJoinStep;
    if (!is_replacing()) clock_.begin_grace(n_);
  }
  // samples come in order from one writer; one that was lost and asked for again may close a gap
  if (header.step == at + 1) {
    at = header.step;
    resend_.restart(std::max(now_ns, due_ns(n_)));
  } else if (header.step > at) {
    // a later sample proves the earlier ones: its writer needed every tick up to it
    at = header.step;
  } else {
    ++member_.refusals().duplicate;
  }
}

// ---- doing ----------------------------------------------------------------------------------------------------

bool IoNode::advance(std::int64_t now_ns) {
  if (upload_.asked) advance_loading(now_ns);
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
    // of two that start together each must see the other
    if (config_.name_check.ns > 0) member_.publish(Topic::session, description_);
  }
  if (now_ns < deadline_ns_) return false;
  description_.header.phase = Phase::running;
  member_.publish(Topic::session, description_);
  member_.set_state(NodeState::joining);
  stage_ = Stage::joining;
  deadline_ns_ = now_ns + config_.join_timeout.ns;
  return true;
}

bool IoNode::advance_initialising(std::int64_t now_ns) {
  if (!member_.all_required(NodeState::ready)) {
    if (now_ns > deadline_ns_) {
      begin_ending(
          ExitCode::failed,
          "not every node became ready within " + node::seconds_text(config_.join_timeout) + ": " + not_ready_text(),
          now_ns);
    }
    return false;
  }
  publish_directory();
  member_.set_step(n_);
  show_running();
  stage_ = Stage::ticking;
  clock_.begin(n_, now_ns);
  last_tick_ns_ = now_ns - H_.ns;
  resend_.restart(now_ns);
  keep_first_states(now_ns);
  return true;
}

std::string IoNode::not_ready_text() const {
  std::string text;
  for (const Role role : wire::kNodeRoles) {
    if (role == Role::io) continue;
    const node::Peer& peer = member_.peer(role);
    if (!member_.requires_role(role) || (peer.is_known && peer.status.state >= NodeState::ready)) continue;
    text += (text.empty() ? "" : "; ") + member_.describe_peer(role) + " is " + std::string(to_text(peer.status.state));
  }
  return text;
}

bool IoNode::advance_join(std::int64_t now_ns) {
  if (member_.is_acknowledged_by_all()) {
    member_.set_state(NodeState::ready);
    stage_ = Stage::initialising;
    deadline_ns_ = now_ns + config_.join_timeout.ns;
    return true;
  }
  if (now_ns > deadline_ns_) {
    begin_ending(ExitCode::failed,
                 "JOIN did not come about within " + node::seconds_text(config_.join_timeout) + ": " +
                     member_.missing_join_text(),
                 now_ns);
    return true;
  }
  if (member_.probe_is_due(now_ns)) {
    tick_ = wire::Tick{};
    tick_.header = block_.header = member_.header(Phase::join, kJoinStep);
    member_.publish(Topic::tick, tick_);
    if (!member_.is_acknowledged_on(Topic::variables)) member_.publish(Topic::variables, block_);
  }
  return false;
}

// the last sample that a physics node must have published before tick n
StepIndex IoNode::needed_of(Role role, StepIndex n) const noexcept {
  if (!transport::traits(role).is_follower) return n - config_.session.window_steps() + 1;
  // sensors delay no tick of the wall clock
  if (role == Role::sensor && is_paced()) return kJoinStep;
  const StepIndex oldest = n - node::kFollowerWindow;
  const StepIndex every = role == Role::sensor ? config_.variables_every : config_.flexible_every;
  return oldest < 0 ? kJoinStep : oldest - oldest % every;
}

// the first role whose samples are missing for tick n
std::optional<Role> IoNode::holds_back(StepIndex n) const noexcept {
  for (const Role role : wire::kPhysicsRoles) {
    if (member_.requires_role(role) && newest_of(role) < needed_of(role, n)) return role;
  }
  return std::nullopt;
}

bool IoNode::partners_allow(StepIndex n) const noexcept {
  if (holds_back(n)) return false;
  if (!is_paced() && member_.requires_role(Role::recorder)) {
    const node::Peer& recorder = member_.peer(Role::recorder);
    if (recorder.status.header.epoch == member_.epoch() && recorder.status.recorded_step < n - kRecorderWindow) {
      return false;
    }
  }
  return true;
}

std::int64_t IoNode::due_ns(StepIndex n) const noexcept {
  if (!is_paced()) return 0;
  // catching up at no more than twice real time
  return std::max(clock_.due_ns(n), last_tick_ns_ + H_.ns / 2);
}

// What the status says of a session that ticks: it runs, it waits for somebody, or ticks are withheld on request.
void IoNode::show_running() {
  if (!vacancies_.empty()) {
    member_.hold(vacancy_text(vacancies_.front()));
  } else if (const std::optional<Role> silent = member_.silent_peer()) {
    member_.hold(member_.silence_text(*silent));
  } else if (stall_.is_named()) {
    member_.hold(stall_.text(member_, health().resends_asked));
  } else if (is_withheld()) {
    member_.hold("");
  } else if (controllers_due_ns_ != 0) {
    member_.hold("step " + std::to_string(n_) + " waits for a controller on channel " +
                 gate_.config(static_cast<std::size_t>(gate_.vacant())).name);
  } else {
    member_.set_state(NodeState::running);
  }
}

// All samples that io needs up to this step have come.
StepIndex IoNode::complete_up_to() const noexcept {
  StepIndex complete = n_;
  for (const Role role : wire::kPhysicsRoles) {
    if (member_.requires_role(role) && !transport::traits(role).is_follower) {
      complete = std::min(complete, newest_of(role));
    }
  }
  return complete;
}

bool IoNode::advance_ticks(std::int64_t now_ns) {
  bool any = false;
  if (is_paced()) {
    obey(clock_.completed(complete_up_to(), n_, now_ns), now_ns);
    if (config_.session.shed != scene::ShedLoad::none) shed_load();
  }
  while (stage_ == Stage::ticking && member_.send_failure().is_ok()) {
    if (is_saving_now()) {
      if (!advance_saving(now_ns)) return any;
      clock_.excuse(n_, now_ns);
    }
    if (is_over(n_)) {
      begin_ending(ExitCode::ok, "", now_ns);
      return true;
    }
    if (is_withheld()) {
      controllers_wait_ns_ = 0;
      waits_for_.reset();
      end_stall(now_ns);
      return any;
    }
    if (!has_its_controllers(now_ns)) return any;
    measure_wait(now_ns);
    if (!partners_allow(n_)) {
      ask_for_missing(now_ns);
      look_for_stall(now_ns);
      return any;
    }
    end_stall(now_ns);
    if (is_paced()) {
      if (is_paused_) {
        clock_.excuse(n_, now_ns);  // a single step is due when it is asked for
      } else if (const std::optional<Verdict> verdict = clock_.keep_time(n_, now_ns)) {
        obey(verdict, now_ns);
        if (verdict->what != scene::OverrunPolicy::slip) return true;
      }
      if (now_ns < due_ns(n_)) return any;
    }
    if (may_wait_for_controllers(now_ns)) return any;
    issue_tick(now_ns);
    any = true;
  }
  return any;
}

// Step 0 of a session, and again after a reset, is not done before every lockstep channel has a holder.
bool IoNode::has_its_controllers(std::int64_t now_ns) {
  const int vacant = n_ == begin_step_ ? gate_.vacant() : -1;
  if (vacant < 0) {
    if (controllers_due_ns_ == 0) return true;
    // the wait for them is no slip
    clock_.excuse(n_, now_ns);
    controllers_due_ns_ = 0;
    show_running();
    return true;
  }
  if (controllers_due_ns_ == 0) {
    controllers_due_ns_ = now_ns + config_.join_timeout.ns;
    show_running();
  } else if (now_ns > controllers_due_ns_) {
    const std::string& name = gate_.config(static_cast<std::size_t>(vacant)).name;
    controllers_due_ns_ = 0;
    begin_ending(ExitCode::failed,
                 "no controller took channel " + name + " within " + node::seconds_text(config_.join_timeout) +
                     ", and the scene has it as controller: lockstep; nothing was computed; start the controller with "
                     "the session (--join-timeout waits longer), or run with --set " +
                     name + ".controller=sampled",
                 now_ns);
  }
  return false;
}

// The tick could go out but for values of lockstep controllers, and the time for them is not over.
bool IoNode::may_wait_for_controllers(std::int64_t now_ns) noexcept {
  const SimDuration longest = gate_.awaited(n_);
  if (longest.ns == 0) return false;
  if (controllers_wait_ns_ == 0) controllers_wait_ns_ = now_ns;
  return now_ns - controllers_wait_ns_ < longest.ns;
}

// A tick that is due waits for the role whose sample is missing; io's own place counts for the values of lockstep
// controllers.
void IoNode::measure_wait(std::int64_t now_ns) noexcept {
  const std::int64_t from_ns = std::max(waits_since_ns_, due_ns(n_));
  if (waits_for_ && clock_.is_judged(n_) && now_ns > from_ns) {
    std::atomic<std::int64_t>& waited_ns = timing().waited_ns[static_cast<std::size_t>(*waits_for_)];
    waited_ns.store(waited_ns.load(std::memory_order_relaxed) + now_ns - from_ns, std::memory_order_relaxed);
  }
  waits_for_ = holds_back(n_);
  if (!waits_for_ && gate_.awaited(n_).ns > 0) waits_for_ = Role::io;
  waits_since_ns_ = now_ns;
}

void IoNode::ask_for_missing(std::int64_t now_ns) {
  if (!resend_.is_due(now_ns)) return;
  resend_.requested(now_ns);
  for (const Role role : wire::kPhysicsRoles) {
    const StepIndex needed = needed_of(role, n_);
    if (!member_.requires_role(role) || newest_of(role) >= needed) continue;
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, newest_of(role) + 1);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(transport::traits(role).sample);
    request.last_step = needed;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
  }
}

void IoNode::issue_tick(std::int64_t now_ns) {
  // inputs of this step
  const SimTime t = start_of(n_, H_);
  for (SignalCourse& raw : script_) raw.clear();
  tick_.commands.clear();
  if (config_.source != nullptr) {
    config_.source->courses(t, t + H_, script_);
    script_changes_.clear();
    config_.source->changes(t, t + H_, script_changes_);
    waiting_commands_.insert(waiting_commands_.end(), script_changes_.begin(), script_changes_.end());
  }
  const std::int64_t waited_ns = controllers_wait_ns_ == 0 ? 0 : now_ns - controllers_wait_ns_;
  const SimDuration standstill{now_ns - last_tick_ns_ - waited_ns};
  if (standstill > kStandstill) gate_.excuse(standstill, now_ns);
  controllers_wait_ns_ = 0;
  gate_.advance(n_, script_, now_ns);
  tell_notices();
  // commands of this step; what does not fit waits for the next tick
  while (!waiting_commands_.empty() && tick_.commands.size() < wire::kMaxCommandsPerTick) {
    parameters_.begin(waiting_commands_.front(), n_);
    tick_.commands.push_back(waiting_commands_.front());
    waiting_commands_.erase(waiting_commands_.begin());
  }
  parameters_.advance(n_);
  // the tick
  tick_.header = member_.header(Phase::running, n_);
  tick_.flags = shedding_.level() == scene::ShedLoad::none ? 0
                : shedding_.level() == scene::ShedLoad::view
                    ? static_cast<std::uint32_t>(wire::TickFlag::shed_view)
                    : static_cast<std::uint32_t>(wire::TickFlag::shed_view) |
                          static_cast<std::uint32_t>(wire::TickFlag::shed_variables);
  tick_.controls.resize(gate_.size());
  tick_.age.resize(gate_.size());
  for (std::size_t i = 0; i < gate_.size(); ++i) {
    tick_.controls[i] = gate_.control(i);
    tick_.age[i] = gate_.age(i);
  }
  StateHash hash;
  hash.add(n_);
  gate_.add_to(hash);
  tick_.state_hash = hash.digest();
  tick_ns_[static_cast<std::size_t>(n_ % kLoopMemory)] = now_ns;
  send_tick(n_);
  if (is_paced()) {
    clock_.ran(n_, now_ns);
    clock_.used_input(n_, oldest_unused_input());
  }
  if (n_ % config_.variables_every == 0) publish_variables(now_ns);

  ++n_;
  ++health().steps_done;
  member_.set_step(n_);
  last_tick_ns_ = now_ns;
  resend_.restart(std::max(now_ns, due_ns(n_)));
  if (is_paused_ && --single_steps_ == 0) show_running();
}

// when the oldest of the values came that this tick is the first to use; 0: it uses none
std::int64_t IoNode::oldest_unused_input() noexcept {
  std::int64_t oldest_ns = 0;
  for (std::int64_t& came_ns : input_ns_) {
    if (came_ns != 0 && (oldest_ns == 0 || came_ns < oldest_ns)) oldest_ns = came_ns;
    came_ns = 0;
  }
  return oldest_ns;
}

void IoNode::send_tick(StepIndex step) {
  const bool is_encoded = transport::encode(tick_, buffer_);
  SLEW_CHECK(is_encoded);
  sent_.keep(step, buffer_);
  member_.send(Topic::tick, buffer_);
}

void IoNode::start_epoch(std::int64_t now_ns, StepIndex from) {
  member_.set_epoch(member_.epoch() + 1);
  gate_.reset();
  parameters_.reset();
  waiting_commands_.clear();
  single_steps_ = 0;
  sent_.clear();
  n_ = begin_step_ = std::max<StepIndex>(0, from);
  controllers_due_ns_ = controllers_wait_ns_ = 0;
  std::ranges::fill(input_ns_, 0);
  newest_.fill(n_ - 1);
  for (node::KeptCheckpoints& states : states_) states.clear();
  replaced_.fill({n_, kJoinStep});
  saving_.reset();
  tick_ = wire::Tick{};
  tick_.header = member_.header(Phase::init, from);
  send_tick(kJoinStep);
  tell_notices();
  member_.set_step(kJoinStep);
  member_.set_state(NodeState::initialising);
  member_.mark_status_changed();
  stage_ = Stage::initialising;
  deadline_ns_ = now_ns + config_.join_timeout.ns;
  // for who comes late
  tell_session(from, now_ns);
}

// The session's description anew, with the step that it is at; -1: it begins with INIT.
void IoNode::tell_session(StepIndex step, std::int64_t now_ns) {
  description_.header = member_.header(Phase::running, step);
  member_.renew(description_, now_ns);
  member_.publish(Topic::session, description_);
}

// ---- ending ---------------------------------------------------------------------------------------------------

void IoNode::send_end(std::uint32_t flags) {
  tick_.commands.clear();
  tick_.header = member_.header(Phase::running, n_);
  tick_.flags = static_cast<std::uint32_t>(wire::TickFlag::end) | flags;
  send_tick(n_);
}

void IoNode::begin_ending(ExitCode code, const std::string& reason, std::int64_t now_ns) {
  if (stage_ == Stage::ending || stage_ == Stage::finished) return;
  const bool was_ticking = stage_ == Stage::ticking;
  if (now_ns != 0) keep_books(now_ns);
  const bool is_orderly = code == ExitCode::ok || code == ExitCode::interrupted || code == ExitCode::terminated;
  if (was_ticking) send_end(is_orderly ? 0 : static_cast<std::uint32_t>(wire::TickFlag::fault));
  if (is_orderly && was_ticking) {
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

void IoNode::watch(std::int64_t now_ns) {
  if (stage_ == Stage::checking_name || stage_ == Stage::finished) return;
  Role about = Role::io;
  const node::PeerEvent event = member_.watch_peers(now_ns, about);
  if (stage_ == Stage::ending) return;
  watch_vacancies(now_ns);
  // of several that went wrong in the same moment the one of the earliest step is named, then by the order of roles
  const node::Peer* first = nullptr;
  for (const Role role : wire::kNodeRoles) {
    if (role == Role::io) continue;
    const node::Peer& peer = member_.peer(role);
    if (!member_.requires_role(role) || !peer.is_known || peer.status.state < NodeState::ended) continue;
    if (vacancy(role) != nullptr) continue;
    if (first == nullptr || peer.status.header.step < first->status.header.step) first = &peer;
  }
  // the others may have told of a loss a moment before it is seen here
  const bool tells_of_loss = first != nullptr && static_cast<ExitCode>(first->status.exit_code) == ExitCode::node_lost;
  const bool sees_loss = event == node::PeerEvent::gone || event == node::PeerEvent::lost;
  if (first != nullptr && !(tells_of_loss && sees_loss)) {
    if (fault_seen_ns_ == 0) fault_seen_ns_ = now_ns;
    if (now_ns - fault_seen_ns_ < (tells_of_loss ? kLossGathering : kFaultGathering).ns) return;
    const Role role = first->status.header.role;
    return begin_ending(static_cast<ExitCode>(first->status.exit_code),
                        member_.end_text(role, member_.describe_peer(role) + ": " + first->status.reason), now_ns);
  }
  switch (event) {
    case node::PeerEvent::gone:
      if (hold_place(about, now_ns)) return;
      [[fallthrough]];
    case node::PeerEvent::lost:
      return begin_ending(
          ExitCode::node_lost,
          member_.end_text(about, member_.describe_peer(about) + " is gone; the session was held after step " +
                                      std::to_string(n_) + " and ended, what was recorded up to there is valid"),
          now_ns);
    case node::PeerEvent::silent:
      if (stage_ == Stage::ticking) member_.hold(member_.silence_text(about));
      return;
    case node::PeerEvent::back:
      if (stage_ == Stage::ticking) show_running();
      return;
    case node::PeerEvent::none:
      return;
  }
}

}  // namespace slew::io_node
