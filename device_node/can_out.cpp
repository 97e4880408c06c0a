// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/time.h"
#include "device_node/can_messages.h"
#include "device_node/shown_device.h"

namespace slew::device_node {
namespace {

constexpr std::int64_t kLookForInterfaceNs = 500'000'000;

class CanOut final : public ShownDevice {
 public:
  CanOut(const scene::CanOutDef& def, const scene::OutputsDef& outputs, SendFrame send)
      : def_(def),
        messages_(read_messages(def.bus)),
        feed_(signals_of(def.bus), outputs, def.every, [this](const FedValues& fed) { show(fed.values); }),
        send_(std::move(send)) {
    for (const scene::CanSignalDef& signal : def.bus.signals) places_.push_back(place_of(messages_, signal.signal));
    for (const devices::CanMessage& message : messages_) {
      std::vector<double>& values = values_.emplace_back();
      for (const devices::CanSignal& signal : message.signals) values.push_back(value_without_source(signal));
    }
    if (send_) return;
    look_after(monotonic_ns());
    if (bus_ == nullptr) add_notice("waiting for " + missing_);
  }

  [[nodiscard]] SignalFeed& feed() noexcept override { return feed_; }

  void look_after(std::int64_t now_ns) override {
    if (send_ || now_ns < next_look_ns_) return;
    next_look_ns_ = now_ns + kLookForInterfaceNs;
    CanFrame frame;
    // frames of others are dropped; they show too when the interface has left
    while (bus_ != nullptr) {
      const CanBus::Taken taken = bus_->take(now_ns, frame);
      if (taken == CanBus::Taken::nothing) return;
      if (taken == CanBus::Taken::frame) continue;
      bus_.reset();
      add_notice("the interface has left; waiting for it");
    }
    bus_ = open_can(def_.bus.interface, missing_);
    if (bus_) add_notice("sends on interface " + def_.bus.interface);
  }

  [[nodiscard]] Json counts() const override {
    Json json = feed_.counts();
    json["sent"] = sent_;
    json["unsent"] = unsent_;
    json["not_finite"] = not_finite_;
    json["held"] = held_;
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
        continue;
      }
      ++(send(frame) ? sent_ : unsent_);
    }
  }

  bool send(const CanFrame& frame) {
    if (send_) return send_(frame);
    return bus_ != nullptr && bus_->send(frame);
  }

  scene::CanOutDef def_;
  std::vector<devices::CanMessage> messages_;
  SignalFeed feed_;
  SendFrame send_;
  std::vector<SignalPlace> places_;          // by signal of the definition
  std::vector<std::vector<double>> values_;  // by message, by signal
  std::unique_ptr<CanBus> bus_;              // null: absent
  std::string missing_;
  std::int64_t next_look_ns_ = 0;
  std::uint64_t sent_ = 0, unsent_ = 0, not_finite_ = 0, held_ = 0;
};

}  // namespace

std::unique_ptr<ShownDevice> open_can_out(const scene::CanOutDef& def, const scene::OutputsDef& outputs,
                                          SendFrame send) {
  return std::make_unique<CanOut>(def, outputs, std::move(send));
}

}  // namespace slew::device_node
