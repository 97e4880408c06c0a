// SPDX-License-Identifier: Apache-2.0
#include "io_node/input_gate.h"

#include <algorithm>
#include <cmath>

#include "io_node/input_shape.h"

namespace slew::io_node {
namespace {

std::string milliseconds_text(SimDuration time) {
  return std::to_string(time.ns / 1'000'000) + " ms";
}

}  // namespace

InputGate::InputGate(std::vector<ChannelConfig> channels, GateConfig config, SimDuration communication_step)
    : config_(std::move(config)), H_(communication_step.seconds()) {
  for (ChannelConfig& channel : channels) {
    Channel state;
    state.config = std::move(channel);
    // the steps of (1) from the awaited one to the present one
    if (state.config.controller == scene::ControllerMode::lockstep) {
      state.pending.resize(static_cast<std::size_t>(state.config.delay / config_.variables_every + 2));
    }
    channels_.push_back(std::move(state));
  }
  reserve(1);
  reset();
}

void InputGate::take_lease(std::size_t index, std::string reason) {
  Channel& channel = channels_[index];
  if (channel.holder.empty()) return;
  static_cast<void>(note_refusal(index, channel.holder, channel.writer, latest_ns_));
  notices_.push_back({index, std::exchange(channel.holder, {}), false, std::move(reason)});
}

void InputGate::reset() {
  begin_step_ = next_step_ = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    take_lease(i, "the session was reset: channel " + channel.config.name +
                      " is at neutral and free; acquire it again to go on");
    channel.is_silent = false;
    channel.controller_raw = channel.raw = channel.config.neutral;
    channel.ramped = channel.config.neutral;
    channel.control = channel.config.scale * channel.config.neutral;
    channel.age = 0;
    channel.based_on = kJoinStep;
  }
}

void InputGate::save(StateWriter& bytes) const {
  for (const Channel& channel : channels_) {
    bytes.number(channel.raw);
    bytes.number(channel.ramped);
    bytes.number(channel.control);
  }
}

void InputGate::load(StateReader& bytes, StepIndex next_step) {
  reset();
  begin_step_ = next_step_ = next_step;
  for (Channel& channel : channels_) {
    for (double* value : {&channel.raw, &channel.ramped, &channel.control}) {
      bytes.number(*value);
      if (!std::isfinite(*value)) bytes.refuse();
    }
  }
}

int InputGate::find(std::string_view name) const noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].config.name == name) return static_cast<int>(i);
  }
  return -1;
}

// ---- leases ---------------------------------------------------------------------------------------------------

bool InputGate::is_holder(const Channel& channel, const std::string& controller, std::uint64_t writer) const noexcept {
  const bool is_its_process = writer == 0 || channel.writer == 0 || writer == channel.writer;
  return !controller.empty() && channel.holder == controller && is_its_process;
}

transport::WriterSight InputGate::see_holder(const Channel& channel) const {
  return config_.see_writer ? config_.see_writer(channel.writer) : transport::WriterSight{};
}

// Refusal of a controller that does not hold the channel.
std::string InputGate::held_text(const Channel& channel, const std::string& controller) const {
  const std::string& name = channel.config.name;
  if (channel.holder.empty()) {
    return "'" + controller + "' does not hold channel " + name + ": it is free; acquire it again to go on";
  }
  if (channel.holder == controller) {
    const std::string process = see_holder(channel).process;
    return "channel " + name + " is held by another process named '" + controller + "'" +
           (process.empty() ? "" : " (" + process + ")") + "; give one of the two another name, or stop one";
  }
  return "channel " + name + " is held by '" + channel.holder +
         "'; wait until it releases it, or until it has been silent for " + milliseconds_text(config_.release_after);
}

// False: it was refused within kRefusalInterval, or so many others were that this one must wait.
bool InputGate::note_refusal(std::size_t channel, const std::string& controller, std::uint64_t writer,
                             std::int64_t now_ns) {
  Refusal* place = nullptr;
  for (Refusal& former : refusals_) {
    if (former.channel == channel && former.writer == writer && former.controller == controller) {
      place = &former;
      break;
    }
    if (place == nullptr || former.at_ns < place->at_ns) place = &former;
  }
  if (now_ns - place->at_ns < kRefusalInterval.ns) return false;
  *place = {channel, controller, writer, now_ns};
  return true;
}

std::optional<LeaseAnswer> InputGate::answer_to_write(std::size_t index, const std::string& controller,
                                                      std::int64_t now_ns, std::uint64_t writer) {
  const Channel& channel = channels_[index];
  if (controller.empty() || is_holder(channel, controller, writer)) return std::nullopt;
  if (!note_refusal(index, controller, writer, now_ns)) return std::nullopt;
  return LeaseAnswer{false, channel.holder, held_text(channel, controller)};
}

// Its holder has ended; during a run a notice reports that no tick waits for the channel.
void InputGate::set_free(std::size_t index, StepIndex n) {
  Channel& channel = channels_[index];
  const std::string holder = std::exchange(channel.holder, {});
  channel.last_value = kJoinStep;
  if (channel.config.controller == scene::ControllerMode::sampled || n <= begin_step_) return;
  notices_.push_back({index, "", false,
                      "'" + holder + "' has released channel " + channel.config.name +
                          " (controller: lockstep): it is free from tick " + std::to_string(n) +
                          " on, and no tick waits for a controller until one is in step with it"});
}

// A lockstep channel is in step from the first tick on, or once its controller has caught up.
void InputGate::set_holder(Channel& channel, const std::string& controller, std::int64_t now_ns, std::uint64_t writer) {
  channel.holder = controller;
  channel.writer = writer;
  channel.based_on = channel.last_sent = channel.last_value = kJoinStep;
  std::fill(channel.pending.begin(), channel.pending.end(), PendingValue{});
  channel.state = next_step_ == begin_step_ ? LockstepState::in_step : LockstepState::neutral;
  channel.out_since = next_step_;
  channel.out_since_ns = now_ns;
}

LeaseAnswer InputGate::acquire(std::size_t index, const std::string& controller, std::int64_t now_ns,
                               std::uint64_t writer) {
  Channel& channel = channels_[index];
  bool is_again = is_holder(channel, controller, writer);
  // a process that was started again does not wait for the silence of the dead one
  const bool has_left = !is_again && channel.holder == controller && see_holder(channel).has_left;
  if (!is_again && !channel.holder.empty() && !has_left) {
    static_cast<void>(note_refusal(index, controller, writer, now_ns));
    return {false, channel.holder, held_text(channel, controller)};
  }
  // a repeated request is a sign of life and changes nothing: the answer to the first may be on its way
  if (!is_again) {
    channel.controller_raw = channel.config.neutral;
    set_holder(channel, controller, now_ns, writer);
  }
  if (writer != 0) channel.writer = writer;
  channel.written_ns = now_ns;
  channel.is_silent = false;
  channel.last_value = kJoinStep;
  return {true, controller, ""};
}

LeaseAnswer InputGate::take_over(std::size_t index, const std::string& controller, std::int64_t now_ns,
                                 std::uint64_t writer) {
  Channel& channel = channels_[index];
  if (channel.holder.empty() || channel.holder == controller) return acquire(index, controller, now_ns, writer);
  const std::string& name = channel.config.name;
  if (channel.config.supervisor != controller) {
    const std::string rule =
        channel.config.supervisor.empty()
            ? "it has no supervisor: name a controller in " + name + ".supervisor of the scene"
            : "only '" + channel.config.supervisor + "' may take it over (" + name + ".supervisor)";
    return {false, channel.holder, "channel " + name + " is held by '" + channel.holder + "', and " + rule};
  }
  latest_ns_ = now_ns;
  take_lease(index, "'" + controller + "' has taken over channel " + name);
  // the value stays until the new holder writes
  set_holder(channel, controller, now_ns, writer);
  if (channel.state == LockstepState::neutral) channel.state = LockstepState::holding;
  channel.written_ns = now_ns;
  channel.is_silent = false;
  return {true, controller, ""};
}

LeaseAnswer InputGate::release(std::size_t index, const std::string& controller, StepIndex based_on,
                               std::uint64_t writer) {
  Channel& channel = channels_[index];
  if (!is_holder(channel, controller, writer)) {
    const bool is_namesake = !controller.empty() && channel.holder == controller;
    return {false, channel.holder,
            is_namesake ? held_text(channel, controller)
                        : "'" + controller + "' does not hold channel " + channel.config.name};
  }
  const bool is_in_step =
      channel.config.controller == scene::ControllerMode::lockstep && channel.state == LockstepState::in_step;
  if (is_in_step && based_on >= 0) {
    channel.last_value = based_on;
  } else {
    set_free(index, next_step_);
  }
  return {true, "", ""};
}

double InputGate::accepted(Channel& channel, double raw) noexcept {
  const double low = channel.config.is_digital ? 0.0 : -1.0;
  const double bounded = std::clamp(raw, low, 1.0);
  if (bounded != raw) ++clamped_;
  return channel.config.is_digital ? (bounded >= 0.5 ? 1.0 : 0.0) : bounded;
}

bool InputGate::write(std::size_t index, const std::string& controller, double raw, StepIndex now_step,
                      std::int64_t now_ns, StepIndex based_on, std::uint64_t writer) {
  Channel& channel = channels_[index];
  if (!is_holder(channel, controller, writer) || channel.last_value >= 0) {
    ++rejected_no_lease_;
    return false;
  }
  // a wrong value is a sign of life, without effect
  channel.written_ns = now_ns;
  if (!std::isfinite(raw)) ++rejected_not_finite_;
  if (channel.config.controller == scene::ControllerMode::lockstep)
    return keep_pending(channel, raw, now_step, based_on);
  if (!std::isfinite(raw)) return false;
  channel.controller_raw = accepted(channel, raw);
  channel.written_step = now_step;
  channel.based_on = based_on <= now_step ? based_on : kJoinStep;
  channel.is_silent = false;
  return true;
}

// ---- lockstep -------------------------------------------------------------------------------------------------

// (1); -1: a step before the begin
StepIndex InputGate::needed(const Channel& channel, StepIndex n) const noexcept {
  const StepIndex m = n - channel.config.delay;
  const StepIndex block = m < 0 ? kJoinStep : m - m % config_.variables_every;
  return block < begin_step_ ? kJoinStep : block;
}

// A value for a later tick. The first one for a step counts, so that the choice does not depend on the clock.
bool InputGate::keep_pending(Channel& channel, double raw, StepIndex now_step, StepIndex based_on) {
  channel.last_sent = std::max(channel.last_sent, based_on);
  const StepIndex need = needed(channel, now_step);
  if (based_on < 0 || based_on < need || based_on > now_step || based_on % config_.variables_every != 0) {
    ++rejected_late_;
    return false;
  }
  const bool is_finite = std::isfinite(raw);
  PendingValue* place = nullptr;
  for (PendingValue& pending : channel.pending) {
    if (pending.based_on == based_on) return is_finite;
    if (pending.based_on < need || pending.based_on < 0) place = &pending;
  }
  if (place == nullptr) return false;  // cannot be: every step that passed the check has a place
  *place = {based_on, is_finite ? accepted(channel, raw) : 0.0, is_finite};
  return is_finite;
}

// tick n is behind the last value of its controller
bool InputGate::has_ended(const Channel& channel, StepIndex n) const noexcept {
  return channel.last_value >= 0 && needed(channel, n) > channel.last_value;
}

int InputGate::vacant() const noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].config.controller == scene::ControllerMode::lockstep && channels_[i].holder.empty())
      return static_cast<int>(i);
  }
  return -1;
}

SimDuration InputGate::awaited(StepIndex n) const noexcept {
  SimDuration longest{};
  for (const Channel& channel : channels_) {
    if (channel.config.controller == scene::ControllerMode::sampled || channel.holder.empty()) continue;
    const StepIndex need = needed(channel, n);
    if (channel.state != LockstepState::in_step || need < 0 || has_ended(channel, n)) continue;
    const bool is_there = std::any_of(channel.pending.begin(), channel.pending.end(),
                                      [need](const PendingValue& pending) { return pending.based_on == need; });
    if (!is_there) longest.ns = std::max(longest.ns, channel.config.wait.ns);
  }
  return longest;
}

void InputGate::fall_out_of_step(std::size_t index, StepIndex n, std::int64_t now_ns) {
  Channel& channel = channels_[index];
  channel.state = LockstepState::holding;
  channel.out_since = n;
  channel.out_since_ns = now_ns;
  ++fell_out_of_step_;
  const std::string last = channel.last_sent < 0 ? "none with its step has come yet"
                                                 : "its last one is from step " + std::to_string(channel.last_sent);
  notices_.push_back({index, channel.holder, true,
                      "tick " + std::to_string(n) + " waited " + milliseconds_text(channel.config.wait) +
                          " for the value of '" + channel.holder + "' from step " + std::to_string(needed(channel, n)) +
                          ", " + last + "; channel " + channel.config.name +
                          " holds its value until it is in step again, for " +
                          milliseconds_text(config_.neutral_after)});
}

void InputGate::advance_lockstep(std::size_t index, StepIndex n, std::int64_t now_ns) {
  Channel& channel = channels_[index];
  const StepIndex need = needed(channel, n);
  if (need < 0) return;
  const auto pending = std::find_if(channel.pending.begin(), channel.pending.end(),
                                    [need](const PendingValue& value) { return value.based_on == need; });
  if (pending != channel.pending.end()) {
    if (channel.state != LockstepState::in_step) {
      channel.state = LockstepState::in_step;
      notices_.push_back({index, channel.holder, true,
                          "'" + channel.holder + "' is in step from tick " + std::to_string(n) + " on; channel " +
                              channel.config.name + " had been without it since tick " +
                              std::to_string(channel.out_since)});
    }
    if (pending->is_finite) channel.controller_raw = pending->raw;
    channel.based_on = need;
    channel.age = static_cast<std::uint32_t>(n - need);
    return;
  }
  if (channel.state == LockstepState::in_step) fall_out_of_step(index, n, now_ns);
  channel.age = static_cast<std::uint32_t>(channel.based_on < 0 ? 0 : n - channel.based_on);
  if (channel.state == LockstepState::holding && now_ns - channel.out_since_ns > config_.neutral_after.ns) {
    channel.state = LockstepState::neutral;
    channel.controller_raw = channel.config.neutral;
    channel.based_on = kJoinStep;
    ++went_neutral_;
    notices_.push_back({index, channel.holder, true,
                        "'" + channel.holder + "' has been out of step for " +
                            milliseconds_text(config_.neutral_after) + ": channel " + channel.config.name +
                            " goes to neutral"});
  }
}

// ---- the tick -------------------------------------------------------------------------------------------------

void InputGate::advance_sampled(std::size_t index, StepIndex n, std::int64_t now_ns) {
  Channel& channel = channels_[index];
  if (now_ns - channel.written_ns > config_.neutral_after.ns && !channel.is_silent) {
    channel.is_silent = true;
    channel.controller_raw = channel.config.neutral;
    channel.based_on = kJoinStep;
    ++went_neutral_;
    notices_.push_back({index, channel.holder, true,
                        "no value of '" + channel.holder + "' came for " + milliseconds_text(config_.neutral_after) +
                            ": channel " + channel.config.name + " goes to neutral"});
  }
  channel.age = static_cast<std::uint32_t>(std::max<StepIndex>(0, n - channel.written_step));
}

void InputGate::advance(StepIndex n, std::span<const SignalCourse> signals, std::int64_t now_ns) {
  next_step_ = n + 1;
  latest_ns_ = now_ns;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    const bool is_lockstep = channel.config.controller == scene::ControllerMode::lockstep;
    // a controller in step has sent all values that were due, however long ago
    const std::int64_t silent_since_ns =
        is_lockstep ? std::max(channel.written_ns, channel.out_since_ns) : channel.written_ns;
    const bool may_be_silent = is_lockstep && channel.state == LockstepState::in_step;
    if (!may_be_silent && !channel.holder.empty() && now_ns - silent_since_ns > config_.release_after.ns) {
      take_lease(i, "no value came for " + milliseconds_text(config_.release_after) + ": channel " +
                        channel.config.name + " is free; acquire it again to go on");
    }
    if (!channel.holder.empty() && has_ended(channel, n)) set_free(i, n);
    // source
    raw_.clear();
    if (!channel.holder.empty()) {
      is_lockstep ? advance_lockstep(i, n, now_ns) : advance_sampled(i, n, now_ns);
      raw_.push_back({1, channel.controller_raw, channel.controller_raw});
    } else {
      channel.age = 0;
      channel.based_on = kJoinStep;
      if (i >= signals.size() || !accept_signal(channel, signals[i])) {
        raw_.assign({{1, channel.config.neutral, channel.config.neutral}});
      }
    }
    shape(channel);
  }
}

// Into raw_. False if the signal has no value, or one that is not finite, which is counted.
bool InputGate::accept_signal(Channel& channel, std::span<const SignalPiece> course) noexcept {
  for (const SignalPiece& piece : course) {
    if (std::isfinite(piece.begin) && std::isfinite(piece.end)) continue;
    ++rejected_not_finite_;
    return false;
  }
  for (const SignalPiece& piece : course) {
    const double begin = accepted(channel, piece.begin);
    if (channel.config.is_digital) {
      raw_.push_back({1, begin, begin});
      break;
    }
    raw_.push_back({piece.share, begin, piece.end == piece.begin ? begin : accepted(channel, piece.end)});
  }
  return !course.empty();
}

// dead zone cuts, ramp limits the rate, scale makes it a control value
void InputGate::shape(Channel& channel) noexcept {
  const ChannelConfig& config = channel.config;
  double most = kAnyChange;
  if (config.ramp > 0) most = H_ / config.ramp;
  if (config.rate_limit > 0) most = std::min(most, H_ * config.rate_limit);
  const ShapedStep step = shape_step(raw_, config.dead_zone, most, channel.ramped);
  channel.raw = step.raw_mean;
  channel.ramped = step.end;
  channel.control = config.scale * step.mean;
}

void InputGate::excuse(SimDuration standstill, std::int64_t now_ns) noexcept {
  for (Channel& channel : channels_) {
    channel.written_ns = std::min(now_ns, channel.written_ns + standstill.ns);
    channel.out_since_ns = std::min(now_ns, channel.out_since_ns + standstill.ns);
  }
}

void InputGate::add_to(StateHash& hash) const noexcept {
  for (const Channel& channel : channels_) {
    hash.add(channel.raw);
    hash.add(channel.ramped);
    hash.add(channel.control);
  }
}

}  // namespace slew::io_node
