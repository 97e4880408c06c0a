// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/failure.h"
#include "core/time.h"
#include "device_node/input_device.h"
#include "device_node/udp_socket.h"
#include "devices/packet.h"

namespace slew::device_node {
namespace {

constexpr int kMostPacketsAtOnce = 256;  // beyond them the session comes first
constexpr std::size_t kMostNamedStrangers = 8;

class UdpIn final : public InputDevice {
 public:
  UdpIn(const scene::UdpInDef& def, Reach reach)
      : def_(def), layout_(build(def.layout)), socket_(address_of(def, reach)), read_(layout_.values.size()) {
    for (const std::string& host : def.from) senders_.push_back(*devices::parse_host(host));
    for (std::size_t i = 0; i < layout_.values.size(); ++i) {
      const devices::LayoutFieldDef& f = layout_.fields[layout_.values[i]].def;
      if (f.name == def.enable.dead_man) dead_man_ = i;
      if (f.input.empty()) continue;
      inputs_.push_back(f.input);
      fields_.push_back(i);
    }
    values_.resize(inputs_.size());
    add_notice(fmt::format("listens on {}, {} bytes a packet", def.listen, layout_.size));
  }

  [[nodiscard]] const std::vector<std::string>& inputs() const noexcept override { return inputs_; }
  [[nodiscard]] int descriptor() const noexcept override { return socket_.descriptor(); }
  [[nodiscard]] bool is_fresh() const noexcept override { return is_fresh_; }
  [[nodiscard]] std::span<const double> values() const noexcept override { return values_; }
  [[nodiscard]] std::int64_t event_ns() const noexcept override { return used_ns_; }
  [[nodiscard]] std::optional<bool> dead_man() const noexcept override {
    if (!dead_man_ || !is_fresh_) return std::nullopt;
    return read_[*dead_man_] != 0;
  }

  bool take(std::int64_t now_ns) override {
    bool is_new = false;
    for (int i = 0; i < kMostPacketsAtOnce; ++i) {
      const auto packet = socket_.receive(buffer_);
      if (!packet) break;
      if (std::find(senders_.begin(), senders_.end(), packet->sender) == senders_.end()) {
        note_stranger(packet->sender);
      } else if (take_packet(packet->size)) {
        is_new = true;
        used_ns_ = now_ns;
      }
    }
    if (is_new) {
      for (std::size_t i = 0; i < fields_.size(); ++i) values_[i] = read_[fields_[i]];
    }
    is_fresh_ = used_ns_ != 0 && now_ns - used_ns_ <= duration_of_seconds(def_.timeout).ns;
    return is_new;
  }

  [[nodiscard]] Json counts() const override {
    Json refused = {{kStrangerCause, strangers_}};
    for (std::size_t i = 1; i < state_.counts.refused.size(); ++i) {
      const auto fault = static_cast<devices::PacketFault>(i);
      refused[std::string(text_of(fault))] = state_.counts.of(fault);
    }
    return {{"used", state_.counts.used},
            {"lost", state_.counts.lost},
            {"jumps", state_.counts.jumps},
            {"refused", refused}};
  }

  [[nodiscard]] std::string text() const override {
    std::string text = is_fresh_ ? "" : "no values; ";
    for (std::size_t i = 0; i < layout_.values.size() && is_fresh_; ++i) {
      text += fmt::format("{} {:g}  ", layout_.fields[layout_.values[i]].def.name, read_[i]);
    }
    text += fmt::format("{} used, {} lost", state_.counts.used, state_.counts.lost);
    if (state_.counts.jumps > 0)
      text += fmt::format(", and an unknown number at {} jumps of the sequence", state_.counts.jumps);
    for (std::size_t i = 1; i < state_.counts.refused.size(); ++i) {
      if (state_.counts.refused[i] > 0)
        text += fmt::format(", {} {}", state_.counts.refused[i], text_of(static_cast<devices::PacketFault>(i)));
    }
    if (strangers_ > 0) text += fmt::format(", {} of other senders", strangers_);
    return text;
  }

 private:
  static devices::UdpAddress address_of(const scene::UdpInDef& def, Reach reach) {
    check_reach(def.name + ".listen", def.listen, reach);
    return *devices::parse_udp_address(def.listen);
  }

  bool take_packet(std::size_t size) {
    // a packet longer than the buffer is longer than every layout
    const std::span<const std::byte> bytes = std::span(buffer_).first(std::min(size, buffer_.size()));
    const devices::PacketFault fault = decode(layout_, bytes, state_, read_);
    if (fault == devices::PacketFault::none) return true;
    const auto i = static_cast<std::size_t>(fault);
    // the first of its kind, with its remedy in the counts
    if (state_.counts.refused[i] == 1) {
      add_notice(fmt::format("a packet was refused: {}; it has {} bytes, the layout {}; further ones are counted",
                             text_of(fault), size, layout_.size));
    }
    return false;
  }

  void note_stranger(std::uint32_t sender) {
    ++strangers_;
    if (named_strangers_.size() == kMostNamedStrangers) return;
    if (std::find(named_strangers_.begin(), named_strangers_.end(), sender) != named_strangers_.end()) return;
    named_strangers_.push_back(sender);
    add_notice(fmt::format("packets from {} are refused; to accept them, add it to {}.from", devices::host_text(sender),
                           def_.name));
  }

  scene::UdpInDef def_;
  devices::ByteLayout layout_;
  UdpSocket socket_;
  std::vector<std::uint32_t> senders_, named_strangers_;
  std::vector<std::string> inputs_;
  std::vector<std::size_t> fields_;  // by input, among the layout's values
  std::optional<std::size_t> dead_man_;
  std::vector<double> read_, values_;  // of the layout, of the inputs
  devices::PacketState state_;
  std::array<std::byte, devices::kMaxLayoutBytes + 1> buffer_;
  std::int64_t used_ns_ = 0;  // receipt of the last used packet; 0: none
  bool is_fresh_ = false;
  std::uint64_t strangers_ = 0;
};

}  // namespace

void check_reach(const std::string& key, const std::string& address, Reach reach) {
  if (reach == Reach::network || devices::parse_udp_address(address)->is_loopback()) return;
  throw Failure(
      ExitCode::bad_input,
      fmt::format("{}: {} is beyond this machine, and UDP has no keys: any program there could read the values "
                  "or move the machine; the device was not started; use 127.0.0.1, or --insecure-devices on "
                  "a network of your own",
                  key, address));
}

std::unique_ptr<InputDevice> open_udp_in(const scene::UdpInDef& def, Reach reach) {
  return std::make_unique<UdpIn>(def, reach);
}

}  // namespace slew::device_node
