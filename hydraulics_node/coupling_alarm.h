// SPDX-License-Identifier: Apache-2.0
// The coupling's error per port (coupling/indicator.h), and the end of a session whose coupling diverges
// (session.coupling_alarm).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "core/state_bytes.h"
#include "core/step_report.h"
#include "coupling/indicator.h"
#include "coupling/port_levels.h"
#include "coupling/samples.h"
#include "scene/scene.h"

namespace slew::hydraulics_node {

class CouplingAlarm {
 public:
  // scene outlives this. Allocates; nothing else does.
  explicit CouplingAlarm(const scene::Scene& scene);
  void reset() noexcept;

  // Both samples of the same step; stiffness of the oil columns by port [N/m], also of ports that publish none.
  void update(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators,
              const coupling::PortArray& stiffness, const coupling::PortLevels& levels) noexcept {
    indicator_.update(mechanism, actuators, stiffness, levels);
  }
  // Raises the flags of a port whose coupling creates energy, and the end of the session where it diverges.
  void raise_flags(const coupling::PortLevels& levels, StepReport& report) noexcept;

  [[nodiscard]] bool ends_session() const noexcept { return ends_session_; }
  [[nodiscard]] const coupling::Indicator& indicator() const noexcept { return indicator_; }
  // Reason of the end; empty: the coupling has not ended the session.
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), text_length_}; }

  void save_indicator(StateWriter& bytes) const { indicator_.save(bytes); }
  void load_indicator(StateReader& bytes) noexcept { indicator_.load(bytes); }
  template <typename Self, typename Bytes>
  static void visit_text(Self& self, Bytes& bytes) {
    bytes.count(self.text_length_, self.text_.size());
    bytes.numbers(std::span(self.text_).first(self.text_length_));
  }

 private:
  [[nodiscard]] std::optional<std::size_t> first_alarm(const coupling::PortLevels& levels) const noexcept;
  void write_text(std::size_t port, coupling::Level level) noexcept;

  const scene::Scene& scene_;
  bool ends_session_;
  coupling::Indicator indicator_;
  std::array<char, 512> text_{};  // no allocation in a step
  std::size_t text_length_ = 0;
};

}  // namespace slew::hydraulics_node
