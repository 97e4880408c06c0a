#include "device_node/shown_device.h"
#include "device_node/udp_socket.h"
#include "devices/packet.h"

namespace slew::device_node {
namespace {

class UdpOut final : public ShownDevice {
 public:
  UdpOut(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, SendBytes send)
      : layout_(build(def.layout)),
        feed_(signals_of(layout_), outputs, def.every, [this](std::span<const double> values) { show(values); }),
        packet_(layout_.size),
        send_(std::move(send)) {
    if (send_) return;
    send_ = [this, to = *devices::parse_udp_address(def.send)](std::span<const std::byte> bytes) {
      return socket_->send(to, bytes);
    };
    socket_ = std::make_unique<UdpSocket>();
    add_notice("sends to " + def.send);
  }

  [[nodiscard]] SignalFeed& feed() noexcept override { return feed_; }
  [[nodiscard]] Json counts() const override {
    Json json = feed_.counts();
    json["sent"] = sent_;
    json["unsent"] = unsent_;
    json["not_finite"] = state_.counts.of(devices::PacketFault::not_finite);
    json["held"] = state_.counts.held;
    return json;
  }

 private:
  static std::vector<FedSignal> signals_of(const devices::ByteLayout& layout) {
    std::vector<FedSignal> signals;
    for (const std::size_t field : layout.values)
      signals.push_back({layout.fields[field].def.variable, layout.fields[field].def.output});
    return signals;
  }

  void show(std::span<const double> values) {
    if (encode(layout_, values, state_, packet_) != devices::PacketFault::none) return;
    ++(send_(packet_) ? sent_ : unsent_);
  }

  devices::ByteLayout layout_;
  SignalFeed feed_;
  devices::PacketState state_;
  std::vector<std::byte> packet_;
  std::unique_ptr<UdpSocket> socket_;
  SendBytes send_;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

}  // namespace

std::unique_ptr<ShownDevice> open_udp_out(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, Reach reach,
                                          SendBytes send) {
  check_reach(def.name + ".send", def.send, reach);
  return std::make_unique<UdpOut>(def, outputs, std::move(send));
}

}  // namespace slew::device_node
