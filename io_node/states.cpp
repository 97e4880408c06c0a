// io_node's part that keeps the states of the physics nodes and gives them to who takes a role over.
#include <algorithm>
#include <utility>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "io_node/io_node.h"
#include "io_node/tick_follower.h"
#include "node/sample_exchange.h"

namespace slew::io_node {

using node::to_text;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

namespace {

// steps that everybody can say again, less those that are on their way
constexpr StepIndex kReach = static_cast<StepIndex>(node::kSentDepth) - 2 * node::kFollowerWindow;

}  // namespace

void IoNode::receive_checkpoint(std::span<const std::byte> bytes) {
  wire::Header header;
  if (!transport::decode_header(bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (!member_.fits(header, Topic::checkpoint)) return;
  if (!transport::decode(bytes, part_) || part_.role != header.role) {
    ++member_.refusals().undecodable;
    return;
  }
  if (part_.total == 0 && saving_) {
    answer_asked(saving_->request, false,
                 "the " + std::string(to_text(part_.role)) + " node's state cannot be saved; nothing was changed", n_);
    saving_.reset();
    return;
  }
  states_[static_cast<std::size_t>(part_.role)].take(part_);
}

// Of a place that is held the state that the next process gets, else the one of the step that is named, or that the
// epoch began with. A recorder that names none has come late: it gets the states of the next step.
void IoNode::answer_state(const wire::ResendRequest& request, std::int64_t now_ns) {
  if (!member_.fits(request.header, Topic::resend) || static_cast<std::size_t>(request.role) >= wire::kRoles) return;
  if (request.header.role == Role::recorder && request.header.step < 0) {
    wire::ControlRequest of_nobody;
    of_nobody.request = 0;
    if (stage_ == Stage::ticking && !saving_) begin_saving(of_nobody, now_ns);
    return;
  }
  const Vacancy* held = vacancy(request.role);
  const StepIndex step = held != nullptr ? held->from : request.header.step >= 0 ? request.header.step : begin_step_;
  const node::Checkpoint* state = states_[static_cast<std::size_t>(request.role)].find(step);
  if (state == nullptr) return;
  node::send_checkpoint(member_, Topic::state, request.role, *state);
  ++health().resends_answered;
}

// ---- io's own -------------------------------------------------------------------------------------------------

namespace {

constexpr std::uint32_t kOwnLayout = 1;

// The state belongs to these channels and parameters.
[[nodiscard]] StateFormat own_format(const IoConfig& config) {
  StateHash model;
  for (const ChannelConfig& channel : config.channels) model.add_bytes(channel.name.data(), channel.name.size());
  for (const LiveParameter& parameter : config.parameters) {
    model.add_bytes(parameter.path.data(), parameter.path.size());
  }
  return {kOwnLayout, model.digest()};
}

}  // namespace

void IoNode::save_own(StepIndex step, node::Checkpoint& checkpoint) const {
  checkpoint.step = step;
  StateHash hash;
  hash.add(step);
  gate_.add_to(hash);
  checkpoint.state_hash = hash.digest();
  checkpoint.bytes.clear();
  StateWriter bytes(checkpoint.bytes, own_format(config_));
  gate_.save(bytes);
  parameters_.save(bytes);
  // changes that did not fit into the last tick
  bytes.number(static_cast<std::uint64_t>(waiting_commands_.size()));
  for (const wire::Command& command : waiting_commands_) {
    bytes.number(command.request);
    bytes.number(command.value);
    bytes.number(command.over_ns);
    bytes.number(static_cast<std::uint64_t>(command.path.size()));
    bytes.numbers(std::span<const char>(command.path));
  }
  bytes.finish();
}

// Nothing has changed unless it is ok.
Status IoNode::load_own(const node::Checkpoint& checkpoint) {
  InputGate gate = gate_;
  // a copy has no room for further changes
  LiveParameters parameters(config_.parameters, H_);
  std::vector<wire::Command> waiting;
  StateReader bytes(checkpoint.bytes, own_format(config_));
  gate.load(bytes, checkpoint.step);
  parameters.load(bytes);
  std::uint64_t count = 0;
  bytes.number(count);
  for (std::uint64_t i = 0; i < count && bytes.is_sound(); ++i) {
    wire::Command& command = waiting.emplace_back();
    std::uint64_t length = 0;
    bytes.number(command.request);
    bytes.number(command.value);
    bytes.number(command.over_ns);
    bytes.number(length);
    if (length > wire::kMaxNameLength) bytes.refuse();
    if (!bytes.is_sound()) break;
    command.path.resize(length);
    bytes.numbers(std::span<char>(command.path));
  }
  if (Status status = bytes.finish("io"); !status.is_ok()) return status;
  gate_ = std::move(gate);
  parameters_ = std::move(parameters);
  waiting_commands_ = std::move(waiting);
  return Status::ok();
}

TickFollower::TickFollower(const IoConfig& config)
    : config_(config),
      parameters_(config.parameters, config.session.step_duration()),
      controls_(config.channels.size()),
      before_(controls_.size()) {
  static_cast<void>(begin(nullptr));
}

Status TickFollower::begin(const node::Checkpoint* own) {
  parameters_.reset();
  InputGate gate(config_.channels, config_.gate(), config_.session.step_duration());
  Status status = Status::ok();
  if (own != nullptr) {
    StateReader bytes(own->bytes, own_format(config_));
    gate.load(bytes, own->step);
    parameters_.load(bytes);
    if (!bytes.is_sound()) status = bytes.finish("io");
  }
  for (std::size_t i = 0; i < controls_.size(); ++i) controls_[i] = before_[i] = gate.control(i);
  return status;
}

void TickFollower::take(const wire::Tick& tick) {
  for (const wire::Command& command : tick.commands) parameters_.begin(command, tick.header.step);
  parameters_.advance(tick.header.step);
  std::swap(controls_, before_);
  for (std::size_t i = 0; i < controls_.size() && i < tick.controls.size(); ++i) controls_[i] = tick.controls[i];
}

node::Checkpoint TickFollower::state(StepIndex step) const {
  node::Checkpoint checkpoint;
  checkpoint.step = step;
  StateHash hash;
  hash.add(step);
  StateWriter bytes(checkpoint.bytes, own_format(config_));
  for (std::size_t i = 0; i < controls_.size(); ++i) {
    const double scale = config_.channels[i].scale, neutral = config_.channels[i].neutral;
    const double raw = scale == 0 ? neutral : controls_[i] / scale;
    const double before = scale == 0 ? neutral : before_[i] / scale;
    const double ramped = std::clamp(raw + 0.5 * (raw - before), -1.0, 1.0);
    for (const double value : {raw, ramped, controls_[i]}) {
      bytes.number(value);
      hash.add(value);
    }
  }
  parameters_.save(bytes);
  bytes.number(std::uint64_t{0});  // no changes wait
  bytes.finish();
  checkpoint.state_hash = hash.digest();
  return checkpoint;
}

void IoNode::begin_with(const Beginning& beginning) {
  n_ = begin_step_ = beginning.step;
  replaced_.fill({n_, kJoinStep});
  newest_.fill(n_ - 1);
  for (const SavedState& of_role : beginning.states) {
    states_[static_cast<std::size_t>(of_role.role)].keep(of_role.state);
  }
  const node::Checkpoint* own = states_[static_cast<std::size_t>(Role::io)].find(n_);
  const Status loaded =
      own == nullptr ? Status::error(ExitCode::bad_input, "the saved session has no state of io") : load_own(*own);
  if (!loaded.is_ok()) {
    member_.step_aside(loaded.code, loaded.text);
    stage_ = Stage::finished;
    return;
  }
  waiting_commands_.insert(waiting_commands_.end(), beginning.changes.begin(), beginning.changes.end());
}

// ---- saving ---------------------------------------------------------------------------------------------------

void IoNode::begin_saving(const wire::ControlRequest& request, std::int64_t now_ns) {
  const auto refuse = [&](const std::string& why) { answer_asked(request, false, why, n_); };
  if (!config_.save_obstacle.empty())
    return refuse("the state of this session cannot be saved: " + config_.save_obstacle);
  if (!vacancies_.empty()) return refuse(vacancy_text(vacancies_.front()) + "; ask again when it has come");
  if (saving_ || upload_.asked)
    return refuse("the session is being saved or loaded already; ask again when that is done");
  const StepIndex step = (n_ + config_.exchange_unit - 1) / config_.exchange_unit * config_.exchange_unit;
  if (is_paused_ && step > n_ + single_steps_) {
    return refuse("the session is paused at step " + std::to_string(n_) + ", and all nodes exchange at every " +
                  std::to_string(config_.exchange_unit) + "th step only; go on to step " + std::to_string(step) +
                  " first ('slewring control step " + std::to_string(step - n_) + "')");
  }
  if (is_over(step - 1)) return refuse("the session ends before the next step at which it could be saved");
  saving_ = Saving{request, step, 0, {}, true};
  // nodes save when they get there; who is there saves at once
  saving_->resend.restart(now_ns - node::kResendAfter.ns);
  static_cast<void>(advance_saving(now_ns));
}

// Where places are held no tick goes out before every node can be replaced.
void IoNode::keep_first_states(std::int64_t now_ns) {
  if (rejoin_.ns == 0) return;
  saving_ = Saving{{}, n_, 0, {}, false};
  saving_->resend.restart(now_ns);
}

// A late recorder has asked for nothing that could be answered.
void IoNode::answer_asked(const wire::ControlRequest& request, bool accepted, const std::string& reason,
                          StepIndex step) {
  if (request.request != 0) answer(request, accepted, reason, step);
}

std::optional<Role> IoNode::has_not_saved() const noexcept {
  for (const Role role : wire::kPhysicsRoles) {
    const node::KeptCheckpoints& kept = states_[static_cast<std::size_t>(role)];
    if (member_.requires_role(role) && kept.find(saving_->step) == nullptr) return role;
  }
  return std::nullopt;
}

// False: the tick of the step must wait.
bool IoNode::advance_saving(std::int64_t now_ns) {
  const std::optional<Role> missing = has_not_saved();
  if (!missing && n_ >= saving_->step) {
    give_saved();
    return true;
  }
  if (saving_->deadline_ns == 0 && n_ >= saving_->step) saving_->deadline_ns = now_ns + kSaveTimeout.ns;
  if (saving_->deadline_ns != 0 && now_ns > saving_->deadline_ns) {
    const std::string missed = member_.describe_peer(missing.value_or(Role::io)) + " has not given its state of step " +
                               std::to_string(saving_->step) + " within " + node::seconds_text(kSaveTimeout);
    if (saving_->is_given) {
      answer_asked(saving_->request, false, missed + "; nothing was saved, the session goes on", n_);
    } else {
      member_.warn(missed + ", or one above " + std::to_string(node::kMaxStateBytes >> 20) +
                   " MiB; the session goes on, but until a state of it has come no other process can take its place");
    }
    saving_.reset();
    return true;
  }
  if (!saving_->resend.is_due(now_ns)) return false;
  saving_->resend.requested(now_ns);
  for (const Role role : wire::kPhysicsRoles) {
    if (!member_.requires_role(role)) continue;
    if (states_[static_cast<std::size_t>(role)].find(saving_->step) != nullptr) continue;
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, saving_->step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(Topic::checkpoint);
    request.last_step = saving_->step;
    member_.publish(Topic::resend, request);
  }
  return false;
}

void IoNode::give_saved() {
  const wire::ControlRequest request = saving_->request;
  const StepIndex step = saving_->step;
  const bool is_given = saving_->is_given;
  saving_.reset();
  if (!is_given) return;
  node::Checkpoint own;
  save_own(step, own);
  node::send_checkpoint(member_, Topic::state, Role::io, own, request.request);
  for (const Role role : wire::kPhysicsRoles) {
    if (!member_.requires_role(role)) continue;
    node::send_checkpoint(member_, Topic::state, role, *states_[static_cast<std::size_t>(role)].find(step),
                          request.request);
  }
  states_[static_cast<std::size_t>(Role::io)].keep(own);
  answer_asked(request, true, "", step);
}

// ---- loading --------------------------------------------------------------------------------------------------

// From an observer, which has no part in the session's membership: the number of its request is the bond.
void IoNode::receive_upload(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (!transport::decode(bytes, part_)) {
    ++member_.refusals().undecodable;
    return;
  }
  const bool is_for_this = part_.header.session == description_.header.session && part_.request != 0;
  const bool has_state = part_.role == Role::io ||
                         (std::find(std::begin(wire::kPhysicsRoles), std::end(wire::kPhysicsRoles), part_.role) !=
                              std::end(wire::kPhysicsRoles) &&
                          member_.requires_role(part_.role));
  if (!is_for_this || part_.header.role != Role::observer || !has_state) return;
  if (upload_.request != part_.request) {
    if (upload_.asked) return;  // one at a time
    upload_ = {};
    upload_.request = part_.request;
  }
  upload_.parts[static_cast<std::size_t>(part_.role)].take(part_);
  if (upload_.asked) advance_loading(now_ns);
}

void IoNode::begin_loading(const wire::ControlRequest& request, std::int64_t now_ns) {
  const auto refuse = [&](const std::string& why) {
    if (!upload_.asked) upload_ = {};
    answer(request, false, why, n_);
  };
  if (!config_.save_obstacle.empty()) return refuse("this session takes no saved state: " + config_.save_obstacle);
  if (!vacancies_.empty()) return refuse(vacancy_text(vacancies_.front()) + "; ask again when it has come");
  if (upload_.asked || saving_)
    return refuse("the session is being saved or loaded already; ask again when that is done");
  if (upload_.request != request.request) {
    upload_ = {};
    upload_.request = request.request;
  }
  upload_.asked = request;
  upload_.deadline_ns = now_ns + kUploadTimeout.ns;
  advance_loading(now_ns);
}

void IoNode::advance_loading(std::int64_t now_ns) {
  const wire::ControlRequest request = *upload_.asked;
  const auto refuse = [&](const std::string& why) {
    upload_ = {};
    answer(request, false, why, n_);
  };
  if (stage_ != Stage::ticking) return refuse("the session is not running any more");
  if (!vacancies_.empty()) return refuse(vacancy_text(vacancies_.front()) + "; ask again when it has come");
  const node::CheckpointParts& own = upload_.parts[static_cast<std::size_t>(Role::io)];
  for (const Role role : wire::kStateRoles) {
    const node::CheckpointParts& parts = upload_.parts[static_cast<std::size_t>(role)];
    if (!member_.requires_role(role)) continue;
    if (!parts.is_whole()) {
      if (now_ns <= upload_.deadline_ns) return;
      return refuse("the state of " + std::string(to_text(role)) +
                    " did not arrive whole; nothing was changed; try again");
    }
    if (parts.checkpoint().step != own.checkpoint().step) {
      return refuse("the states are of different steps; nothing was changed");
    }
  }
  const StepIndex step = own.checkpoint().step;
  if (step % config_.exchange_unit != 0 || is_over(step)) {
    return refuse("this session cannot go on at step " + std::to_string(step) + ": it ends at step " +
                  std::to_string(config_.session.steps()) + ", and nodes exchange at every " +
                  std::to_string(config_.exchange_unit) + "th step");
  }
  // on copies first, so that a refusal changes nothing
  if (const Status loaded = load_own(own.checkpoint()); !loaded.is_ok()) return refuse(loaded.text);
  answer(request, true, "", step);
  start_epoch_from_upload(now_ns);
}

void IoNode::start_epoch_from_upload(std::int64_t now_ns) {
  const Upload upload = std::exchange(upload_, {});
  const node::Checkpoint& own = upload.parts[static_cast<std::size_t>(Role::io)].checkpoint();
  start_epoch(now_ns, own.step);
  static_cast<void>(load_own(own));
  for (std::size_t role = 0; role < wire::kRoles; ++role) {
    if (upload.parts[role].is_whole()) states_[role].keep(upload.parts[role].checkpoint());
  }
}

// ---- places that are held -------------------------------------------------------------------------------------

// Nobody has come yet for the place of this role.
bool IoNode::begins_anew(Role role) const noexcept {
  return vacancy(role) != nullptr && !member_.peer(role).is_known;
}

// The step at which one of the two begins decides about the other: they exchange, or both do with a mechanics node that
// begins with them.
bool IoNode::are_bound(Role role, Role other) const noexcept {
  return role == Role::mechanics || other == Role::mechanics || begins_anew(Role::mechanics);
}

// Whether a process of the role that begins at this step finds, and says again, all that it and the others may lack.
// What was on its way when its writer died is lost with it. Two that exchange must meet: each waits for the other's
// sample of the step that it has reached, and can say its own from the step on that it began with.
bool IoNode::suits(Role role, StepIndex step) const noexcept {
  if (step % config_.exchange_unit != 0) return false;
  for (const Role other : wire::kPhysicsRoles) {
    if (other == role || !member_.requires_role(other) || !are_bound(role, other)) continue;
    // both begin anew, at the same step
    if (begins_anew(other)) {
      if (states_[static_cast<std::size_t>(other)].find(step) == nullptr) return false;
      continue;
    }
    // a follower for whose samples no node waits reads those of the mechanics all the same
    const auto is_followed = [&](Role follower) {
      return follower == Role::sensor || (follower == Role::flex && config_.flexible_every > 1);
    };
    const bool reads_other = !is_followed(other);
    const bool is_read = !is_followed(role) || begins_anew(Role::mechanics);
    const Replaced& replaced = replaced_[static_cast<std::size_t>(other)];
    // who is ready has come to the step that it began with, whatever io has heard of it since
    const StepIndex reached = replaced.until == kJoinStep ? std::max(newest_of(other), replaced.from) : replaced.from;
    if (reads_other && step < replaced.from) return false;
    if (is_read && step > reached) return false;
  }
  return step <= n_ && n_ - step <= kReach;
}

// The newest such state, from which the recorder too misses nothing: it has everything up to the step that it told
// last.
const node::Checkpoint* IoNode::state_for(Role role) const noexcept {
  const node::KeptCheckpoints& kept = states_[static_cast<std::size_t>(role)];
  const auto is_good = [&](StepIndex step) { return suits(role, step); };
  if (!member_.requires_role(Role::recorder)) return kept.newest(is_good);
  const node::Peer& recorder = member_.peer(Role::recorder);
  const StepIndex recorded = recorder.status.header.epoch == member_.epoch() ? recorder.status.recorded_step + 1 : 0;
  const auto is_recorded = [&](StepIndex step) { return step <= recorded && suits(role, step); };
  if (const node::Checkpoint* found = kept.newest(is_recorded)) return found;
  // one that is not quite old enough for the recorder costs it some samples
  return kept.oldest(is_good);
}

const IoNode::Vacancy* IoNode::vacancy(Role role) const noexcept {
  const auto found =
      std::find_if(vacancies_.begin(), vacancies_.end(), [role](const Vacancy& v) { return v.role == role; });
  return found == vacancies_.end() ? nullptr : &*found;
}

bool IoNode::is_replacing() const noexcept {
  const auto computes_again = [](const Replaced& replaced) { return replaced.until != kJoinStep; };
  return !vacancies_.empty() || std::any_of(replaced_.begin(), replaced_.end(), computes_again);
}

std::string IoNode::vacancy_text(const Vacancy& vacancy) const {
  return vacancy.who + " is gone at step " + std::to_string(vacancy.lost_at) + "; its place is held for " +
         node::seconds_text(rejoin_) + ", who takes it gets the state of step " + std::to_string(vacancy.from);
}

// The role's process is gone. False: it cannot be replaced, and the session ends as without session.rejoin.
bool IoNode::hold_place(Role role, std::int64_t now_ns) {
  const node::Checkpoint* state = stage_ == Stage::ticking ? state_for(role) : nullptr;
  if (state == nullptr || description_.given_up.size() == wire::kMaxGivenUp) return false;
  Vacancy held{role, member_.describe_peer(role), n_, state->step, now_ns + rejoin_.ns};
  // who has not come yet begins where this one does
  for (Vacancy& other : vacancies_) {
    if (other.role == role || !are_bound(role, other.role) || !begins_anew(other.role)) continue;
    other.from = state->step;
    replaced_[static_cast<std::size_t>(other.role)].from = state->step;
  }
  replaced_[static_cast<std::size_t>(role)] = {state->step, n_};
  std::erase_if(vacancies_, [role](const Vacancy& former) { return former.role == role; });
  vacancies_.push_back(std::move(held));
  clock_.forget_under_way();
  member_.warn(vacancy_text(vacancies_.back()));
  give_up(role, now_ns);
  show_running();
  return true;
}

void IoNode::give_up(Role role, std::int64_t now_ns) {
  description_.given_up.push_back({role, member_.peer(role).incarnation});
  tell_session(n_, now_ns);
}

void IoNode::watch_vacancies(std::int64_t now_ns) {
  for (std::size_t i = 0; i < vacancies_.size(); ++i) {
    const Vacancy& held = vacancies_[i];
    const Role role = held.role;
    const node::Peer& peer = member_.peer(role);
    if (peer.is_known && peer.status.state >= NodeState::ended) {
      // one that came and could not go on leaves the place to the next
      if (description_.given_up.size() == wire::kMaxGivenUp) continue;
      member_.warn(member_.describe_peer(role) + " came for the place of " + held.who +
                   " and ended: " + peer.status.reason);
      give_up(role, now_ns);
    } else if (peer.is_known && peer.status.state >= NodeState::ready) {
      member_.warn(member_.describe_peer(role) + " goes on in the place of " + held.who + " from step " +
                   std::to_string(held.from));
      vacancies_.erase(vacancies_.begin() + static_cast<std::ptrdiff_t>(i--));
      show_running();
      continue;
    }
    if (now_ns > held.deadline_ns) {
      const std::string text = held.who + " is gone, and no other process took its place within " +
                               node::seconds_text(rejoin_) + "; the session was held after step " + std::to_string(n_) +
                               " and ended, what was recorded up to there is valid";
      return begin_ending(ExitCode::node_lost, text, now_ns);
    }
  }
}

}  // namespace slew::io_node
