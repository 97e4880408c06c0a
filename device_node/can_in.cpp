// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/failure.h"
#include "core/time.h"
#include "device_node/bus_protocol.h"
#include "device_node/can_bus.h"
#include "device_node/can_messages.h"
#include "device_node/input_device.h"

namespace slew::device_node {
namespace {

constexpr std::int64_t kLookForBusNs = 500'000'000;
constexpr int kMostFramesAtOnce = 256;  // beyond them the session comes first

class CanIn final : public InputDevice {
 public:
  CanIn(const scene::CanInDef& def, BusPart part, OpenCan open)
      : def_(def),
        part_(def.bus.interface.empty() ? BusPart::listens : part),
        open_(std::move(open)),
        messages_(read_messages(def.bus, scene::CanFlow::received)),
        protocol_(def.bus, part_),
        rows_(def.bus.signals.size()) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const scene::CanSignalDef& signal = def.bus.signals[i];
      rows_[i].place = place_of(messages_, signal.signal);
      if (signal.signal == def.enable.dead_man) dead_man_ = i;
      if (signal.input.empty()) continue;
      inputs_.push_back(signal.input);
      driven_.push_back(i);
    }
    values_.resize(inputs_.size());
    if (def.bus.interface.empty()) {
      bus_ = open_can_log(def.path);
      add_notice("plays " + def.path);
    } else {
      look(monotonic_ns());
      if (bus_ == nullptr) add_notice("waiting for " + missing_);
    }
  }

  [[nodiscard]] const std::vector<std::string>& inputs() const noexcept override { return inputs_; }
  [[nodiscard]] int descriptor() const noexcept override { return bus_ ? bus_->descriptor() : -1; }
  [[nodiscard]] bool is_fresh() const noexcept override { return is_fresh_; }
  [[nodiscard]] std::span<const double> values() const noexcept override { return values_; }
  [[nodiscard]] std::int64_t event_ns() const noexcept override { return event_ns_; }
  [[nodiscard]] std::optional<bool> dead_man() const noexcept override {
    if (!dead_man_ || !is_fresh_ || !is_valid(rows_[*dead_man_], event_ns_)) return std::nullopt;
    return rows_[*dead_man_].value != 0;
  }

  bool take(std::int64_t now_ns) override {
    if (bus_ == nullptr && !has_ended_ && now_ns >= next_look_ns_) look(now_ns);
    bool is_new = false;
    CanFrame frame;
    // frame by frame of a recording: none is passed over where this process was late
    const int most = descriptor() < 0 ? 1 : kMostFramesAtOnce;
    for (int i = 0; bus_ != nullptr && i < most; ++i) {
      const CanBus::Taken taken = bus_->take(now_ns, frame);
      if (taken == CanBus::Taken::nothing) break;
      if (taken == CanBus::Taken::gone) {
        leave(now_ns);
        break;
      }
      protocol_.take(frame, now_ns);
      forget_values();
      if (take_frame(frame, now_ns)) is_new = true;
    }
    look_after_protocol(now_ns);
    is_fresh_ = std::all_of(driven_.begin(), driven_.end(), [&](std::size_t i) { return is_valid(rows_[i], now_ns); });
    if (dead_man_ && !is_valid(rows_[*dead_man_], now_ns)) is_fresh_ = false;
    if (!is_new) return false;
    event_ns_ = now_ns;
    for (std::size_t i = 0; i < driven_.size(); ++i)
      values_[i] = rows_[driven_[i]].value * def_.bus.signals[driven_[i]].gain;
    return is_fresh_;
  }

  [[nodiscard]] Json counts() const override {
    Json without_value = Json::object();
    for (const auto& [state, number] : without_value_) without_value[std::string(text_of(state))] = number;
    Json json = {
        {"used", used_}, {"too_short", too_short_}, {"other_identifiers", others_}, {"without_value", without_value}};
    protocol_.add_counts(json);
    if (unsent_ > 0) json["unsent"] = unsent_;
    return json;
  }

  [[nodiscard]] std::string text() const override {
    std::string text = protocol_.text();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      text += fmt::format("{}{} ", i > 0 ? "  " : "", def_.bus.signals[i].signal);
      text += row.seen_ns == 0                           ? "-"
              : row.state == devices::SignalState::valid ? fmt::format("{:g}", row.value)
                                                         : std::string(text_of(row.state));
    }
    return text + fmt::format("  {} used, {} of other identifiers", used_, others_);
  }

 private:
  struct Row {
    SignalPlace place;
    double value = 0;
    devices::SignalState state = devices::SignalState::not_available;
    std::int64_t seen_ns = 0;  // of the last frame that had it; 0: none
  };

  [[nodiscard]] bool is_valid(const Row& row, std::int64_t now_ns) const noexcept {
    return row.seen_ns != 0 && row.state == devices::SignalState::valid &&
           protocol_.is_operational(row.place.message) && now_ns - row.seen_ns <= duration_of_seconds(def_.timeout).ns;
  }

  void look(std::int64_t now_ns) {
    next_look_ns_ = now_ns + kLookForBusNs;
    bus_ = open_(def_.bus.interface, missing_);
    if (bus_ == nullptr) return;
    add_notice("reads interface " + def_.bus.interface);
    protocol_.connect(now_ns);
  }

  void leave(std::int64_t now_ns) {
    has_ended_ = def_.bus.interface.empty();
    bus_.reset();
    next_look_ns_ = now_ns + kLookForBusNs;
    add_notice(has_ended_ ? "the recorded frames are over" : "the interface has left; waiting for it");
  }

  // Values from before a restart of their node, or from before it was missing, never move an input.
  void forget_values() {
    for (const BusProtocol::NodeChange& change : protocol_.take_changes()) {
      if (change.is_operational) continue;
      for (Row& row : rows_) {
        if (row.place.message == change.message) row.seen_ns = 0;
      }
    }
  }

  void look_after_protocol(std::int64_t now_ns) {
    protocol_.advance(now_ns);
    forget_values();
    for (const CanFrame& frame : protocol_.take_frames()) {
      if (bus_ == nullptr || !bus_->send(frame)) ++unsent_;
    }
    for (std::string& notice : protocol_.take_notices()) add_notice(std::move(notice));
  }

  // True if a signal of ours has a new value, or has lost it.
  bool take_frame(const CanFrame& frame, std::int64_t now_ns) {
    const std::optional<std::size_t> message = find_frame(messages_, def_.bus, frame);
    if (!message || !protocol_.is_for_us(frame)) {
      ++others_;
      return false;
    }
    const devices::CanMessage& layout = messages_[*message];
    decoded_.resize(layout.signals.size());
    if (!decode(layout, frame.data(), codes_of(def_.bus), decoded_)) {
      ++too_short_;
      return false;
    }
    ++used_;
    for (Row& row : rows_) {
      if (row.place.message != *message) continue;
      const devices::SignalValue value = value_at(row.place);
      // another choice of the multiplexer: the signal is not in this frame
      if (value.state == devices::SignalState::not_selected) continue;
      row.state = value.state;
      row.seen_ns = now_ns;
      if (value.state == devices::SignalState::valid) {
        row.value = value.value;
      } else {
        ++without_value_[value.state];
      }
    }
    return true;
  }

  // An axis that does not fit together is out of its range.
  [[nodiscard]] devices::SignalValue value_at(const SignalPlace& place) const {
    devices::SignalValue value = decoded_[place.signal];
    if (!place.axis || value.state != devices::SignalState::valid) return value;
    const std::optional<double> axis = joystick_axis(*place.axis, decoded_);
    value.value = axis.value_or(std::nan(""));
    if (!axis) value.state = devices::SignalState::out_of_range;
    return value;
  }

  scene::CanInDef def_;
  BusPart part_;
  OpenCan open_;
  std::vector<devices::CanMessage> messages_;
  BusProtocol protocol_;
  std::vector<Row> rows_;            // by signal of the definition
  std::vector<std::size_t> driven_;  // rows that move inputs_
  std::vector<std::string> inputs_;
  std::vector<double> values_;
  std::optional<std::size_t> dead_man_;
  std::unique_ptr<CanBus> bus_;  // null: absent
  std::vector<devices::SignalValue> decoded_;
  std::string missing_;
  std::int64_t next_look_ns_ = 0, event_ns_ = 0;
  bool has_ended_ = false, is_fresh_ = false;
  std::uint64_t used_ = 0, too_short_ = 0, others_ = 0, unsent_ = 0;
  std::map<devices::SignalState, std::uint64_t> without_value_;
};

}  // namespace

std::unique_ptr<InputDevice> open_can_in(const scene::CanInDef& def, BusPart part, OpenCan open) {
  return std::make_unique<CanIn>(def, part, std::move(open));
}

}  // namespace slew::device_node
