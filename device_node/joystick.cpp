// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/time.h"
#include "device_node/event_source.h"
#include "device_node/input_device.h"
#include "scene/defs.h"
#include "scene/recorded_files.h"

namespace slew::device_node {
namespace {

constexpr std::int64_t kLookAgainNs = 500'000'000;

// The stick with the dead-man button among its buttons, as the last one unless it is there already.
devices::StickDef with_dead_man(const scene::JoystickDef& def) {
  devices::StickDef stick = def.stick;
  const std::string& code = def.enable.dead_man;
  const auto has_code = [&](const devices::ButtonDef& button) { return button.code == code; };
  if (code.empty() || std::any_of(stick.buttons.begin(), stick.buttons.end(), has_code)) return stick;
  // a channel of its own that no input has: it is not among the driven ones
  std::int64_t channel = 63;
  const auto is_taken = [&] {
    return std::any_of(stick.axes.begin(), stick.axes.end(),
                       [&](const auto& axis) { return axis.channel == channel; }) ||
           std::any_of(stick.buttons.begin(), stick.buttons.end(),
                       [&](const auto& button) { return button.channel == channel; });
  };
  while (is_taken()) --channel;
  stick.buttons.push_back({.code = code, .channel = channel});
  return stick;
}

class Joystick final : public InputDevice {
 public:
  Joystick(const scene::JoystickDef& def, std::span<const scene::InputDef> inputs)
      : def_(def), stick_(build_stick(with_dead_man(def))), state_(initial_state(stick_)) {
    for (const devices::AxisDef& axis : def.stick.axes) add_input(inputs, scene::InputType::analog, axis.channel);
    for (const devices::ButtonDef& button : def.stick.buttons)
      add_input(inputs, scene::InputType::digital, button.channel);
    values_.resize(inputs_.size());
    const auto& buttons = stick_.def.buttons;
    const auto found = std::find_if(buttons.begin(), buttons.end(),
                                    [&](const devices::ButtonDef& b) { return b.code == def.enable.dead_man; });
    dead_man_ = static_cast<std::size_t>(found - buttons.begin());
    look(monotonic_ns());
    if (source_ != nullptr) return;
    // only a device can come later
    if (def.match.empty() && !scene::is_device_file(def.path)) {
      throw Failure(ExitCode::bad_input,
                    missing_ +
                        "; the device was not started; copy the recorded events there, or name their folder with "
                        "--assets");
    }
    add_notice(fmt::format("waiting for {}", missing_));
  }

  [[nodiscard]] const std::vector<std::string>& inputs() const noexcept override { return inputs_; }
  [[nodiscard]] int descriptor() const noexcept override { return source_ ? source_->descriptor() : -1; }
  [[nodiscard]] bool is_fresh() const noexcept override { return state_.phase == devices::StickPhase::valid; }
  [[nodiscard]] std::span<const double> values() const noexcept override { return values_; }
  [[nodiscard]] std::int64_t event_ns() const noexcept override { return state_.report_time_us * 1000; }

  [[nodiscard]] std::optional<bool> dead_man() const noexcept override {
    if (dead_man_ >= stick_.def.buttons.size()) return std::nullopt;
    return button_value(stick_, state_, dead_man_);
  }

  bool take(std::int64_t now_ns) override {
    if (source_ == nullptr) {
      if (has_ended_ || now_ns < next_look_ns_) return false;
      look(now_ns);
      return source_ != nullptr;
    }
    events_.clear();
    const bool is_there = source_->take(now_ns, events_);
    bool is_new = take_events(stick_, state_, events_);
    // events were lost: the state is read again
    if (is_there && state_.phase == devices::StickPhase::awaiting_state) {
      if (source_->read_state(stick_, state_)) is_new = true;
    }
    if (is_new) fill_values();
    if (!is_there) leave(now_ns);
    return is_new;
  }

  [[nodiscard]] Json counts() const override {
    return {{"reports", state_.reports}, {"dropped", state_.dropped}, {"beyond_calibration", state_.held}};
  }

  [[nodiscard]] std::string text() const override {
    if (!is_fresh()) return "no values";
    std::string text;
    for (std::size_t i = 0; i < stick_.def.axes.size(); ++i) {
      text += fmt::format("{} {:+.3f} ({})  ", stick_.def.axes[i].code, *axis_value(stick_, state_, i), state_.axes[i]);
    }
    for (std::size_t i = 0; i < stick_.def.buttons.size(); ++i) {
      text += fmt::format("{} {}  ", stick_.def.buttons[i].code, *button_value(stick_, state_, i) ? 1 : 0);
    }
    text.resize(text.find_last_not_of(' ') + 1);
    return text;
  }

 private:
  void add_input(std::span<const scene::InputDef> inputs, scene::InputType type, std::int64_t channel) {
    const auto found = std::find_if(inputs.begin(), inputs.end(), [&](const scene::InputDef& input) {
      return input.block == def_.block && input.channel == channel && input.type == type;
    });
    // the scene was checked
    if (found == inputs.end())
      throw Failure(ExitCode::bad_input, fmt::format("{}: no input for channel {}", def_.name, channel));
    inputs_.push_back(found->name);
  }

  void look(std::int64_t now_ns) {
    next_look_ns_ = now_ns + kLookAgainNs;
    const std::string path = def_.path.empty() ? find_input_device(def_.match) : def_.path;
    if (path.empty()) {
      missing_ = fmt::format("a device named '{}' in /dev/input", def_.match);
      return;
    }
    source_ = open_events(path, missing_);
    if (source_ == nullptr) return;
    connect(state_);
    if (!source_->read_state(stick_, state_)) return leave(now_ns);
    state_.report_time_us = now_ns / 1000;
    fill_values();
    add_notice("reads " + path);
  }

  void leave(std::int64_t now_ns) {
    const bool is_recording = source_->descriptor() < 0;
    has_ended_ = is_recording;
    source_.reset();
    disconnect(state_);
    next_look_ns_ = now_ns + kLookAgainNs;
    add_notice(is_recording ? "the recorded events are over" : "the device has left; waiting for it");
  }

  void fill_values() {
    if (!is_fresh()) return;
    std::size_t at = 0;
    for (std::size_t i = 0; i < def_.stick.axes.size(); ++i) values_[at++] = *axis_value(stick_, state_, i);
    for (std::size_t i = 0; i < def_.stick.buttons.size(); ++i)
      values_[at++] = *button_value(stick_, state_, i) ? 1.0 : 0.0;
  }

  scene::JoystickDef def_;
  devices::Stick stick_;
  devices::StickState state_;
  std::size_t dead_man_ = 0;  // among the stick's buttons
  std::vector<std::string> inputs_;
  std::vector<double> values_;
  std::unique_ptr<EventSource> source_;  // null: absent
  std::vector<devices::InputEvent> events_;
  std::string missing_;
  std::int64_t next_look_ns_ = 0;
  bool has_ended_ = false;  // a recording was played to its end
};

}  // namespace

std::unique_ptr<InputDevice> open_joystick(const scene::JoystickDef& def, std::span<const scene::InputDef> inputs) {
  return std::make_unique<Joystick>(def, inputs);
}

}  // namespace slew::device_node
