// SPDX-License-Identifier: Apache-2.0
#include "device_node/packet_sender.h"
#include "device_node/shown_device.h"

namespace slew::device_node {
namespace {

class UdpOut final : public ShownDevice {
 public:
  UdpOut(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, SendBytes send)
      : sender_(def.layout, def.send, std::move(send)),
        feed_(signals_of(sender_.layout()), outputs, def.every,
              [this](const FedValues& fed) { sender_.send(fed.values); }) {
    if (sender_.is_on_network()) add_notice("sends to " + def.send);
  }

  [[nodiscard]] SignalFeed& feed() noexcept override { return feed_; }
  [[nodiscard]] Json counts() const override {
    Json json = feed_.counts();
    sender_.add_counts(json);
    return json;
  }

 private:
  static std::vector<FedSignal> signals_of(const devices::ByteLayout& layout) {
    std::vector<FedSignal> signals;
    for (const std::size_t field : layout.values)
      signals.push_back({layout.fields[field].def.variable, layout.fields[field].def.output});
    return signals;
  }

  PacketSender sender_;
  SignalFeed feed_;
};

}  // namespace

std::unique_ptr<ShownDevice> open_udp_out(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, Reach reach,
                                          SendBytes send) {
  check_reach(def.name + ".send", def.send, reach);
  return std::make_unique<UdpOut>(def, outputs, std::move(send));
}

}  // namespace slew::device_node
