// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/time.h"
#include "device_node/bus_protocol.h"
#include "device_node/can_messages.h"
#include "device_node/shown_device.h"

namespace slew::device_node {
namespace {

constexpr std::int64_t kLookForInterfaceNs = 500'000'000;
constexpr std::int64_t kSyncRoundNs = 1'000'000;
constexpr int kMostTakenAtOnce = 4096;  // beyond them the session comes first

class CanOut final : public ShownDevice {
 public:
  CanOut(const scene::CanOutDef& def, const scene::OutputsDef& outputs, OpenCan open)
      : def_(def),
        messages_(read_messages(def.bus, scene::CanFlow::sent)),
        protocol_(def.bus, BusPart::takes_part),
        feed_(signals_of(def.bus), outputs, def.every, [this](const FedValues& fed) { show(fed.values); }),
        open_(std::move(open)),
        frames_(messages_.size()) {
    for (const scene::CanSignalDef& signal : def.bus.signals) places_.push_back(place_of(messages_, signal.signal));
    for (const devices::CanMessage& message : messages_) {
      std::vector<double>& values = values_.emplace_back();
      for (const devices::CanSignal& signal : message.signals) values.push_back(value_without_source(signal));
    }
    for (const devices::PdoDef& pdo : def.bus.pdos) has_synchronous_ = has_synchronous_ || pdo.is_synchronous;
    look_after(monotonic_ns());
    if (bus_ == nullptr) add_notice("waiting for " + missing_);
  }

  [[nodiscard]] SignalFeed& feed() noexcept override { return feed_; }

  void look_after(std::int64_t now_ns) override {
    looked_ns_ = now_ns;
    CanFrame frame;
    for (int i = 0; bus_ != nullptr && i < kMostTakenAtOnce; ++i) {
      const CanBus::Taken taken = bus_->take(now_ns, frame);
      if (taken == CanBus::Taken::nothing) break;
      if (taken == CanBus::Taken::frame) {
        protocol_.take(frame, now_ns);
        continue;
      }
      bus_.reset();
      next_look_ns_ = now_ns + kLookForInterfaceNs;
      add_notice("the interface has left; waiting for it");
    }
    if (bus_ == nullptr && now_ns >= next_look_ns_) look(now_ns);
    protocol_.advance(now_ns);
    for (const CanFrame& one : protocol_.take_frames()) count(send(one));
    for (std::string& notice : protocol_.take_notices()) add_notice(std::move(notice));
    // what a node missed before it was operational
    for (const BusProtocol::NodeChange& change : protocol_.take_changes()) {
      if (change.is_operational && !is_synchronous(change.message)) send_message(change.message);
    }
    send_synchronous();
  }

  [[nodiscard]] std::int64_t due_ns() const noexcept override {
    // SYNC of another node is looked for
    const std::int64_t look_ns = has_synchronous_ && def_.bus.canopen.sync == 0 ? looked_ns_ + kSyncRoundNs : INT64_MAX;
    return bus_ == nullptr ? INT64_MAX : std::min(protocol_.due_ns(), look_ns);
  }

  [[nodiscard]] Json counts() const override {
    Json json = feed_.counts();
    json["sent"] = sent_;
    json["unsent"] = unsent_;
    json["not_finite"] = not_finite_;
    json["held"] = held_;
    json["held_back"] = held_back_;
    protocol_.add_counts(json);
    return json;
  }

 private:
  static std::vector<FedSignal> signals_of(const scene::CanBusDef& bus) {
    std::vector<FedSignal> signals;
    for (const scene::CanSignalDef& signal : bus.signals) signals.push_back({signal.variable, signal.output});
    return signals;
  }

  // Not available with J1939 where the signal has a code for it, else a raw 0.
  [[nodiscard]] double value_without_source(const devices::CanSignal& signal) const {
    const bool has_code = signal.number == devices::CanNumber::integer && !signal.is_signed && signal.bits >= 2;
    const bool is_j1939 = def_.bus.protocol == scene::CanProtocol::j1939;
    return is_j1939 && has_code && !signal.is_selector ? std::nan("") : signal.offset;
  }

  [[nodiscard]] bool is_synchronous(std::size_t message) const {
    return message < def_.bus.pdos.size() && def_.bus.pdos[message].is_synchronous;
  }

  void look(std::int64_t now_ns) {
    next_look_ns_ = now_ns + kLookForInterfaceNs;
    bus_ = open_(def_.bus.interface, missing_);
    if (bus_ == nullptr) return;
    add_notice("sends on interface " + def_.bus.interface);
    protocol_.connect(now_ns);
  }

  void show(std::span<const double> values) {
    for (std::size_t i = 0; i < places_.size(); ++i)
      values_[places_[i].message][places_[i].signal] = values[i] * def_.bus.signals[i].gain;
    for (std::size_t i = 0; i < messages_.size(); ++i) {
      CanFrame frame;
      frame.id = messages_[i].id;
      frame.is_extended = messages_[i].is_extended;
      frame.size = messages_[i].bytes;
      const devices::EncodeResult result =
          encode(messages_[i], values_[i], codes_of(def_.bus), std::span(frame.bytes).first(frame.size));
      held_ += result.held;
      if (result.fault != devices::EncodeFault::none) {
        ++not_finite_;
        frames_[i].reset();
        continue;
      }
      frames_[i] = frame;
      if (!is_synchronous(i)) send_message(i);
    }
  }

  // Values of the newest step, after each SYNC.
  void send_synchronous() {
    if (protocol_.syncs() == synced_) return;
    synced_ = protocol_.syncs();
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (is_synchronous(i)) send_message(i);
    }
  }

  // The newest frame of a message; nothing before the first one.
  void send_message(std::size_t message) {
    if (!frames_[message]) return;
    CanFrame frame = *frames_[message];
    const auto id = protocol_.sent_id(frame.id, frame.is_extended);
    if (!id || (protocol_.is_of_own_node(message) && !protocol_.is_operational(message))) {
      ++held_back_;
      return;
    }
    frame.id = *id;
    count(send(frame));
  }

  void count(bool is_sent) { ++(is_sent ? sent_ : unsent_); }

  bool send(const CanFrame& frame) { return bus_ != nullptr && bus_->send(frame); }

  scene::CanOutDef def_;
  std::vector<devices::CanMessage> messages_;
  BusProtocol protocol_;
  SignalFeed feed_;
  OpenCan open_;
  std::vector<SignalPlace> places_;              // by signal of the definition
  std::vector<std::vector<double>> values_;      // by message, by signal
  std::vector<std::optional<CanFrame>> frames_;  // by message, with the newest values
  std::unique_ptr<CanBus> bus_;                  // null: absent
  std::string missing_;
  std::int64_t next_look_ns_ = 0, looked_ns_ = 0;
  bool has_synchronous_ = false;
  std::uint64_t sent_ = 0, unsent_ = 0, not_finite_ = 0, held_ = 0, held_back_ = 0, synced_ = 0;
};

}  // namespace

std::unique_ptr<ShownDevice> open_can_out(const scene::CanOutDef& def, const scene::OutputsDef& outputs, OpenCan open) {
  return std::make_unique<CanOut>(def, outputs, std::move(open));
}

}  // namespace slew::device_node
