// Sends packets of one layout with variables of a session and outputs of its scene.
//
// A packet holds the values of one step: it is made when all its variables of that step have arrived, at the earliest
// `every` of the session's time after the one before. A session that stands still sends nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/json.h"
#include "devices/packet.h"
#include "observer/session_view.h"
#include "observer/step_values.h"
#include "scene/devices.h"

namespace slew::device_node {

class PacketSender {
 public:
  // False: the system did not take it.
  using Send = std::function<bool(std::span<const std::byte>)>;

  PacketSender(const scene::UdpOutDef& def, const scene::OutputsDef& outputs, Send send);

  // Names of the variables that it needs.
  [[nodiscard]] const std::vector<std::string>& variables() const noexcept { return variables_; }

  void take(const wire::VariableDirectory& directory);
  // time: of the block in the session [s].
  void take(const wire::VariableBlock& block, double time);

  [[nodiscard]] Json counts() const;

 private:
  // Source of one value of the layout.
  struct Source {
    enum class Kind : std::uint8_t { none, variable, switched, analog } kind = Kind::none;
    std::size_t index = 0;  // among variables_, switched_ or analog_
  };
  struct Switched {
    scene::SwitchedDef def;
    std::size_t variable = 0;  // among variables_
    devices::SwitchedOutputState state{};
  };
  struct Analog {
    scene::AnalogDef def;
    std::size_t variable = 0;
    devices::AnalogOutputState state{};
  };

  [[nodiscard]] std::size_t need(const std::string& variable);
  [[nodiscard]] Source source_of(const devices::LayoutFieldDef& f, const scene::OutputsDef& outputs);
  void begin_epoch(std::uint32_t epoch);
  void step_outputs(const std::vector<double>& values, double dt);
  void send_packet(const std::vector<double>& values);

  devices::ByteLayout layout_;
  double every_;
  Send send_;
  std::vector<std::string> variables_;
  std::vector<Source> sources_;  // by value of the layout
  std::vector<Switched> switched_;
  std::vector<Analog> analog_;
  observer::StepValues values_{0};
  devices::PacketState state_;
  std::vector<double> packet_values_;
  std::vector<std::byte> packet_;
  std::uint32_t epoch_ = 0;
  double last_time_ = 0;  // of the last whole step [s]
  double next_time_ = 0;  // earliest of the next packet [s]
  bool has_time_ = false;
  std::uint64_t sent_ = 0, unsent_ = 0;
};

}  // namespace slew::device_node
