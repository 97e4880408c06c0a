// SPDX-License-Identifier: Apache-2.0
#include "io_node/state_keeper.h"

#include <algorithm>

#include "node/sample_exchange.h"
#include "transport/roles.h"

namespace slew::io_node {

using node::to_text;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

namespace {

// Steps that every node can resend, less those on their way. In pace `real` the session goes on while a sensor node is
// silent, until that is given up; so long mechanics keeps the poses.
StepIndex reach_of(Role role, const scene::SessionDef& session) noexcept {
  const std::size_t kept = role == Role::sensor
                               ? node::sent_depth(duration_of_seconds(session.give_up_after), session.step_duration())
                               : node::kSentDepth;
  return static_cast<StepIndex>(kept) - 2 * node::kFollowerWindow;
}

}  // namespace

StateKeeper::StateKeeper(const IoConfig& config, node::SessionMember& member, SessionInputs& inputs)
    : config_(config), member_(member), inputs_(inputs) {}

void StateKeeper::begin_epoch(StepIndex begin) {
  begin_step_ = begin;
  for (node::KeptCheckpoints& states : kept_) states.clear();
  replaced_.fill({begin, kJoinStep});
  saving_.reset();
}

Status StateKeeper::resume(const ResumeState& resume) {
  begin_epoch(resume.step);
  for (const SavedState& saved : resume.states) kept(saved.role).keep(saved.state);
  const node::Checkpoint* own = kept(Role::io).find(resume.step);
  if (own == nullptr) return Status::error(ExitCode::bad_input, "the saved session has no state of io");
  if (Status loaded = inputs_.load(*own); !loaded.is_ok()) return loaded;
  for (const wire::Command& change : resume.changes) inputs_.add_change(change);
  return Status::ok();
}

std::optional<ControlAnswer> StateKeeper::receive_checkpoint(std::span<const std::byte> bytes, StepIndex n) {
  wire::Header header;
  if (!member_.decode_header(bytes, header)) return std::nullopt;
  if (!member_.fits(header, Topic::checkpoint)) return std::nullopt;
  if (!transport::decode(bytes, part_) || part_.role != header.role) {
    ++member_.refusals().undecodable;
    return std::nullopt;
  }
  if (part_.total != 0 || !saving_) {
    kept(part_.role).take(part_);
    return std::nullopt;
  }
  const wire::ControlRequest request = saving_->request;
  saving_.reset();
  if (request.request == 0) return std::nullopt;
  return ControlAnswer{request, false,
                       "the " + std::string(to_text(part_.role)) + " node's state cannot be saved; nothing was changed",
                       n};
}

bool StateKeeper::publish_state(const wire::ResendRequest& request) {
  const HeldRole* held = find_held(request.role);
  const StepIndex step = held != nullptr ? held->from : request.header.step >= 0 ? request.header.step : begin_step_;
  const node::Checkpoint* state = kept(request.role).find(step);
  if (state == nullptr) return false;
  node::send_checkpoint(member_, Topic::state, request.role, *state);
  return true;
}

// ---- saving ---------------------------------------------------------------------------------------------------

std::string StateKeeper::obstacle() const {
  if (is_holding()) return held_text() + kRepeatLater;
  if (saving_ || is_loading())
    return "the session is being saved or loaded already; repeat the request when that is done";
  return "";
}

std::string StateKeeper::begin_saving(const wire::ControlRequest& request, StepIndex n,
                                      std::optional<StepIndex> stops_at, std::int64_t now_ns) {
  if (!config_.save_obstacle.empty()) return "the state of this session cannot be saved: " + config_.save_obstacle;
  if (std::string why = obstacle(); !why.empty()) return why;
  const StepIndex unit = config_.exchange_unit;
  const StepIndex step = (n + unit - 1) / unit * unit;
  if (stops_at && step > *stops_at) {
    return "the session is paused at step " + std::to_string(n) + ", and all nodes exchange at every " +
           std::to_string(unit) + "th step only; go on to step " + std::to_string(step) +
           " first ('slewring control step " + std::to_string(step - n) + "')";
  }
  if (config_.session.duration > 0 && step > config_.session.steps())
    return "the session ends before the next step at which it could be saved";
  saving_ = Saving{request, step, 0, {}, true};
  // nodes save when they reach the step; a node that has reached it saves at once
  saving_->resend.restart(now_ns - node::kResendAfter.ns);
  return "";
}

void StateKeeper::begin_collecting(StepIndex n, std::int64_t now_ns) {
  saving_ = Saving{{}, n, 0, {}, false};
  saving_->resend.restart(now_ns);
}

// first role whose state has not been received
std::optional<Role> StateKeeper::unsaved() const noexcept {
  for (const Role role : transport::physics_roles()) {
    if (member_.requires_role(role) && kept(role).find(saving_->step) == nullptr) return role;
  }
  return std::nullopt;
}

StateKeeper::Progress StateKeeper::advance_saving(StepIndex n, std::int64_t now_ns) {
  const auto end = [this](bool is_saved, const std::string& reason, StepIndex step) {
    const wire::ControlRequest request = saving_->request;
    saving_.reset();
    if (request.request == 0) return Progress{true, std::nullopt};
    return Progress{true, ControlAnswer{request, is_saved, reason, step}};
  };
  const std::optional<Role> missing = unsaved();
  if (!missing && n >= saving_->step) {
    if (saving_->is_published) publish_saved();
    return end(true, "", saving_->step);
  }
  if (saving_->deadline_ns == 0 && n >= saving_->step) saving_->deadline_ns = now_ns + kSaveTimeout.ns;
  if (saving_->deadline_ns != 0 && now_ns > saving_->deadline_ns) {
    const std::string missed = member_.describe_peer(missing.value_or(Role::io)) + " has not given its state of step " +
                               std::to_string(saving_->step) + " within " + seconds_text(kSaveTimeout);
    if (!saving_->is_published) {
      member_.warn(missed + ", or one above " + std::to_string(wire::kMaxStateBytes >> 20) +
                   " MiB; the session goes on, but until a state of it has come no other process can take its place");
    }
    return end(false, missed + "; nothing was saved, the session goes on", n);
  }
  if (!saving_->resend.is_due(now_ns)) return {};
  saving_->resend.requested(now_ns);
  for (const Role role : transport::physics_roles()) {
    if (!member_.requires_role(role) || kept(role).find(saving_->step) != nullptr) continue;
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, saving_->step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(Topic::checkpoint);
    request.last_step = saving_->step;
    member_.publish(Topic::resend, request);
  }
  return {};
}

void StateKeeper::publish_saved() {
  const std::uint64_t request = saving_->request.request;
  node::Checkpoint own;
  inputs_.save(saving_->step, own);
  node::send_checkpoint(member_, Topic::state, Role::io, own, request);
  for (const Role role : transport::physics_roles()) {
    if (!member_.requires_role(role)) continue;
    node::send_checkpoint(member_, Topic::state, role, *kept(role).find(saving_->step), request);
  }
  kept(Role::io).keep(own);
}

// ---- loading --------------------------------------------------------------------------------------------------

void StateKeeper::receive_upload(std::span<const std::byte> bytes) {
  if (!member_.decode(bytes, part_)) return;
  const bool is_for_this = part_.header.session == member_.session().header.session && part_.request != 0;
  const bool has_state =
      part_.role == Role::io || (transport::is_physics(part_.role) && member_.requires_role(part_.role));
  if (!is_for_this || part_.header.role != Role::observer || !has_state) return;
  if (upload_.request != part_.request) {
    if (is_loading()) return;  // one at a time
    upload_ = {};
    upload_.request = part_.request;
  }
  upload_.parts[static_cast<std::size_t>(part_.role)].take(part_);
}

std::string StateKeeper::begin_loading(const wire::ControlRequest& request, std::int64_t now_ns) {
  std::string why =
      config_.save_obstacle.empty() ? obstacle() : "this session takes no saved state: " + config_.save_obstacle;
  if (!why.empty()) {
    if (!is_loading()) upload_ = {};
    return why;
  }
  if (upload_.request != request.request) {
    upload_ = {};
    upload_.request = request.request;
  }
  upload_.load_request = request;
  upload_.deadline_ns = now_ns + kUploadTimeout.ns;
  return "";
}

std::optional<ControlAnswer> StateKeeper::advance_loading(bool is_running, StepIndex n, std::int64_t now_ns) {
  const wire::ControlRequest request = *upload_.load_request;
  const auto refuse = [&](const std::string& why) {
    upload_ = {};
    return ControlAnswer{request, false, why, n};
  };
  if (!is_running) return refuse("the session is not running any more");
  if (is_holding()) return refuse(held_text() + kRepeatLater);
  const node::Checkpoint& own = upload_.parts[static_cast<std::size_t>(Role::io)].checkpoint();
  for (const Role role : transport::state_roles()) {
    const node::CheckpointParts& parts = upload_.parts[static_cast<std::size_t>(role)];
    if (!member_.requires_role(role)) continue;
    if (!parts.is_whole()) {
      if (now_ns <= upload_.deadline_ns) return std::nullopt;
      return refuse("the state of " + std::string(to_text(role)) +
                    " did not arrive whole; nothing was changed; try again");
    }
    if (parts.checkpoint().step != own.step) return refuse("the states are of different steps; nothing was changed");
  }
  const StepIndex step = own.step;
  const bool is_over = config_.session.duration > 0 && step >= config_.session.steps();
  if (is_over || step % config_.exchange_unit != 0) {
    return refuse("this session cannot go on at step " + std::to_string(step) + ": " +
                  (is_over ? "it ends at step " + std::to_string(config_.session.steps())
                           : "nodes exchange at every " + std::to_string(config_.exchange_unit) + "th step"));
  }
  if (const Status checked = inputs_.check(own); !checked.is_ok()) return refuse(checked.text);
  return ControlAnswer{request, true, "", step};
}

void StateKeeper::load(const Upload& upload) {
  static_cast<void>(inputs_.load(upload.parts[static_cast<std::size_t>(Role::io)].checkpoint()));
  for (std::size_t role = 0; role < wire::kRoles; ++role) {
    if (upload.parts[role].is_whole()) kept_[role].keep(upload.parts[role].checkpoint());
  }
}

// ---- held roles -----------------------------------------------------------------------------------------------

const StateKeeper::HeldRole* StateKeeper::find_held(Role role) const noexcept {
  const auto found = std::ranges::find(held_, role, &HeldRole::role);
  return found == held_.end() ? nullptr : &*found;
}

bool StateKeeper::is_replacing() const noexcept {
  const auto catches_up = [](const Replaced& replaced) { return replaced.until != kJoinStep; };
  return is_holding() || std::ranges::any_of(replaced_, catches_up);
}

std::string StateKeeper::text_of(const HeldRole& held) const {
  return held.lost + " is gone at step " + std::to_string(held.lost_at) + "; its place is held for " +
         seconds_text(duration_of_seconds(config_.session.rejoin)) + ", a replacement gets the state of step " +
         std::to_string(held.from);
}

// The role is held, and no replacement has joined yet.
bool StateKeeper::has_no_process(Role role) const noexcept {
  return is_held(role) && !member_.peer(role).is_known;
}

// The begin of one role decides about the other: they exchange samples, or both exchange with a mechanics node that
// begins with them.
bool StateKeeper::are_bound(Role role, Role other) const noexcept {
  return role == Role::mechanics || other == Role::mechanics || has_no_process(Role::mechanics);
}

// A process of the role that begins at this step can receive, and resend, every sample that it and the others may lack.
// Samples on their way are lost with their writer. Two nodes that exchange must meet: each waits for the other's sample
// of the step that it has reached, and can send its own samples from the step on at which it began.
bool StateKeeper::is_suitable(Role role, StepIndex step, StepIndex n, const SampleProgress& samples) const noexcept {
  if (step % config_.exchange_unit != 0) return false;
  for (const Role other : transport::physics_roles()) {
    if (other == role || !member_.requires_role(other) || !are_bound(role, other)) continue;
    // two replacements begin at the same step
    if (has_no_process(other)) {
      if (kept(other).find(step) == nullptr) return false;
      continue;
    }
    // a follower reads the samples of mechanics, also where no node waits for its own
    const auto is_waited_for = [&](Role follower) {
      return follower != Role::sensor && (follower != Role::flex || config_.flexible_every == 1);
    };
    const bool reads_other = is_waited_for(other);
    const bool is_read = is_waited_for(role) || has_no_process(Role::mechanics);
    // a replacement that is ready has reached the step at which it began, whatever samples io has received since
    const Replaced& begun = replaced(other);
    const StepIndex reached = begun.until == kJoinStep ? std::max(samples.newest(other), begun.from) : begun.from;
    if (reads_other && step < begun.from) return false;
    if (is_read && step > reached) return false;
  }
  return step <= n && n - step <= reach_of(role, config_.session);
}

// The newest suitable state from which the recorder, too, misses no sample: it has all up to its published step.
const node::Checkpoint* StateKeeper::state_for(Role role, StepIndex n, const SampleProgress& samples) const noexcept {
  const auto suits = [&](StepIndex step) { return is_suitable(role, step, n, samples); };
  if (!member_.requires_role(Role::recorder)) return kept(role).newest(suits);
  const node::Peer& recorder = member_.peer(Role::recorder);
  const StepIndex recorded = recorder.status.header.epoch == member_.epoch() ? recorder.status.recorded_step + 1 : 0;
  const auto is_recorded = [&](StepIndex step) { return step <= recorded && suits(step); };
  if (const node::Checkpoint* found = kept(role).newest(is_recorded)) return found;
  // from a newer state the recorder misses some samples
  return kept(role).oldest(suits);
}

bool StateKeeper::hold_role(Role role, StepIndex n, const SampleProgress& samples, std::int64_t now_ns) {
  const node::Checkpoint* state = state_for(role, n, samples);
  if (state == nullptr || member_.session().given_up.size() == wire::kMaxGivenUp) return false;
  HeldRole held{role, member_.describe_peer(role), n, state->step,
                now_ns + duration_of_seconds(config_.session.rejoin).ns};
  // roles that still wait for a replacement begin at the same step
  for (HeldRole& other : held_) {
    if (other.role == role || !are_bound(role, other.role) || !has_no_process(other.role)) continue;
    other.from = replaced(other.role).from = state->step;
  }
  replaced(role) = {state->step, n};
  std::erase_if(held_, [role](const HeldRole& former) { return former.role == role; });
  held_.push_back(std::move(held));
  member_.warn(text_of(held_.back()));
  return true;
}

bool StateKeeper::catches_up(Role role, StepIndex step) noexcept {
  Replaced& begun = replaced(role);
  if (begun.until == kJoinStep || step < begun.until) return false;
  begun.until = kJoinStep;
  return true;
}

std::vector<StateKeeper::HeldChange> StateKeeper::watch_held(StepIndex n, std::int64_t now_ns) {
  std::vector<HeldChange> changes;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const HeldRole& held = held_[i];
    const Role role = held.role;
    const node::Peer& peer = member_.peer(role);
    if (peer.is_known && peer.status.state >= NodeState::ended) {
      // a replacement that could not continue leaves the role to the next one
      if (member_.session().given_up.size() + changes.size() >= wire::kMaxGivenUp) continue;
      member_.warn(member_.describe_peer(role) + " came for the place of " + held.lost +
                   " and ended: " + peer.status.reason);
      changes.push_back({HeldChange::Kind::rejected, role, ""});
    } else if (peer.is_known && peer.status.state >= NodeState::ready) {
      member_.warn(member_.describe_peer(role) + " goes on in the place of " + held.lost + " from step " +
                   std::to_string(held.from));
      changes.push_back({HeldChange::Kind::filled, role, ""});
      held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(i--));
      continue;
    }
    if (now_ns > held.deadline_ns) {
      changes.push_back({HeldChange::Kind::expired, role,
                         held.lost + " is gone, and no other process took its place within " +
                             seconds_text(duration_of_seconds(config_.session.rejoin)) +
                             "; the session was held after step " + std::to_string(n) +
                             " and ended, what was recorded up to there is valid"});
      break;
    }
  }
  return changes;
}

}  // namespace slew::io_node
