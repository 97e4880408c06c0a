#include "io_node/input_gate.h"

#include <algorithm>
#include <cmath>

namespace slew::io {
namespace {

constexpr double kFullSwing = 2;  // of a raw value, from -1 to 1

}  // namespace

InputGate::InputGate(std::vector<ChannelConfig> channels, GateConfig config, SimDuration communication_step)
    : config_(config), H_(communication_step.seconds()) {
  for (ChannelConfig& channel : channels) {
    Channel state;
    state.config = std::move(channel);
    channels_.push_back(std::move(state));
  }
  reset();
}

void InputGate::take_lease(std::size_t index, std::string reason) {
  Channel& channel = channels_[index];
  if (channel.holder.empty()) return;
  lost_.push_back({index, std::exchange(channel.holder, {}), std::move(reason)});
}

void InputGate::reset() {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    take_lease(i, "the session was reset: channel " + channel.config.name +
                      " is at neutral and free; acquire it again to go on");
    channel.is_silent = false;
    channel.controller_raw = channel.raw = channel.config.neutral;
    channel.ramped = channel.config.neutral;
    channel.control = channel.config.scale * channel.config.neutral;
    channel.age = 0;
  }
}

int InputGate::find(std::string_view name) const noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].config.name == name) return static_cast<int>(i);
  }
  return -1;
}

LeaseAnswer InputGate::acquire(std::size_t index, const std::string& controller, std::int64_t now_ns) {
  Channel& channel = channels_[index];
  if (!channel.holder.empty() && channel.holder != controller) {
    return {false, channel.holder,
            "channel " + channel.config.name + " is held by '" + channel.holder +
                "'; wait until it releases it, or until it has been silent for " +
                std::to_string(config_.release_after.ns / 1'000'000) + " ms"};
  }
  // asking again is a sign of life and moves nothing: the answer to the first time may still be on its way
  if (channel.holder != controller) channel.controller_raw = channel.config.neutral;
  channel.holder = controller;
  channel.written_ns = now_ns;
  channel.is_silent = false;
  return {true, controller, ""};
}

LeaseAnswer InputGate::release(std::size_t index, const std::string& controller) {
  Channel& channel = channels_[index];
  if (channel.holder != controller) {
    return {false, channel.holder, "'" + controller + "' does not hold channel " + channel.config.name};
  }
  channel.holder.clear();
  return {true, "", ""};
}

double InputGate::accepted(Channel& channel, double raw) noexcept {
  const double low = channel.config.is_digital ? 0.0 : -1.0;
  const double bounded = std::clamp(raw, low, 1.0);
  if (bounded != raw) ++clamped_;
  return channel.config.is_digital ? (bounded >= 0.5 ? 1.0 : 0.0) : bounded;
}

bool InputGate::write(std::size_t index, const std::string& controller, double raw, StepIndex now_step,
                      std::int64_t now_ns) {
  Channel& channel = channels_[index];
  if (channel.holder != controller || controller.empty()) {
    ++rejected_no_lease_;
    return false;
  }
  // even a wrong value is a sign of life, but it moves nothing
  channel.written_ns = now_ns;
  if (!std::isfinite(raw)) {
    ++rejected_not_finite_;
    return false;
  }
  channel.controller_raw = accepted(channel, raw);
  channel.written_step = now_step;
  channel.is_silent = false;
  return true;
}

void InputGate::advance(StepIndex n, std::span<const double> script_raw, std::int64_t now_ns) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& channel = channels_[i];
    // a silent holder first goes to neutral, then loses the channel
    const std::int64_t silent_ns = channel.holder.empty() ? 0 : now_ns - channel.written_ns;
    if (silent_ns > config_.release_after.ns) {
      take_lease(i, "no value came for " + std::to_string(config_.release_after.ns / 1'000'000) + " ms: channel " +
                        channel.config.name + " is free; acquire it again to go on");
    }
    if (!channel.holder.empty() && silent_ns > config_.neutral_after.ns && !channel.is_silent) {
      channel.is_silent = true;
      channel.controller_raw = channel.config.neutral;
      ++went_neutral_;
    }
    // source
    double raw = channel.config.neutral;
    if (!channel.holder.empty()) {
      raw = channel.controller_raw;
      channel.age = static_cast<std::uint32_t>(std::max<StepIndex>(0, n - channel.written_step));
    } else if (i < script_raw.size()) {
      channel.age = 0;
      if (std::isfinite(script_raw[i])) {
        raw = accepted(channel, script_raw[i]);
      } else {
        ++rejected_not_finite_;
      }
    }
    channel.raw = raw;
    // dead zone cuts, ramp limits the rate, scale makes it a control value
    const double wanted = std::fabs(raw) < channel.config.dead_zone ? 0.0 : raw;
    double most = channel.config.ramp > 0 ? H_ / channel.config.ramp : kFullSwing;
    if (channel.config.rate_limit > 0) most = std::min(most, H_ * channel.config.rate_limit);
    channel.ramped += std::clamp(wanted - channel.ramped, -most, most);
    channel.control = channel.config.scale * channel.ramped;
  }
}

void InputGate::add_to(StateHash& hash) const noexcept {
  for (const Channel& channel : channels_) {
    hash.add(channel.raw);
    hash.add(channel.ramped);
    hash.add(channel.control);
  }
}

}  // namespace slew::io
