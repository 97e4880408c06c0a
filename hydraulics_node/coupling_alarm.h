// SPDX-License-Identifier: Apache-2.0
// The coupling's error per port (coupling/indicator.h), and the end of a session whose coupling diverges
// (session.coupling_alarm).
//
// A port whose spring bends (foreseen_forces.h, (1)) may gain a few per cent of its swing's energy at each turn: little
// beside the work done (indicator.h, (7)), but it adds up. So the session ends too where a port that forces can move
// has
//   M > 0.5,   M = -sum dE* / E over steps that bend, each 0.02 at most (1)
// with E = max |F|^2 / (2 max K) of the port that holds most. M, |F| and K fade with exp(-t / 1 s).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

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

  // Both samples of the same step; stiffness of the oil columns by port [N/m], also of ports that publish none; bends:
  // as of foreseen_forces.h, (1).
  void update(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators,
              const coupling::PortArray& stiffness, const coupling::PortLevels& levels, bool bends) noexcept;
  // Raises the flags of a port whose coupling creates energy, and the end of the session where it diverges.
  void raise_flags(const coupling::PortLevels& levels, StepReport& report) noexcept;

  [[nodiscard]] bool ends_session() const noexcept { return ends_session_; }
  [[nodiscard]] const coupling::Indicator& indicator() const noexcept { return indicator_; }
  // Reason of the end; empty: the coupling has not ended the session.
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), text_length_}; }

  void save_indicator(StateWriter& bytes) const { indicator_.save(bytes); }
  void load_indicator(StateReader& bytes) noexcept { indicator_.load(bytes); }
  template <typename Self, typename Bytes>
  static void visit_made(Self& self, Bytes& bytes) {
    for (auto& port : self.made_) {
      for (auto* x : {&port.share, &port.force, &port.stiffness}) bytes.number(*x);
    }
  }
  template <typename Self, typename Bytes>
  static void visit_text(Self& self, Bytes& bytes) {
    bytes.count(self.text_length_, self.text_.size());
    bytes.numbers(std::span(self.text_).first(self.text_length_));
  }

 private:
  [[nodiscard]] std::optional<std::size_t> first_alarm(const coupling::PortLevels& levels) const noexcept;
  // (1)
  struct Made {
    double share = 0, force = 0, stiffness = 0;  // M; N, N/m
  };
  void write_text(std::size_t port, coupling::Level level) noexcept;

  const scene::Scene& scene_;
  bool ends_session_;
  coupling::Indicator indicator_;
  double fading_;                    // of one step
  std::vector<double> least_force_;  // N, by port
  std::vector<Made> made_;           // by port
  std::array<char, 512> text_{};     // no allocation in a step
  std::size_t text_length_ = 0;
};

}  // namespace slew::hydraulics_node
