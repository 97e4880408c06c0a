// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/coupling_alarm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace slew::hydraulics_node {
namespace {

// of (1): a swing that grows to twice its energy within a second
constexpr double kMostMade = 0.5;
constexpr double kFading = 1;         // s
constexpr double kMostAtOnce = 0.02;  // of a step: one jump of a valve may be many times what the spring holds

// By port: the force of the pressure below which errors count as errors of zero.
std::vector<double> least_forces(const scene::Scene& scene) {
  std::vector<double> forces;
  for (const auto& component : scene.hydraulics.components) {
    const std::optional<hydraulics::ActuatorDef> actuator = component->actuator();
    if (actuator) forces.push_back(scene.hydraulics.pressure_scale * std::max(actuator->area_a, actuator->area_b));
  }
  return forces;
}

}  // namespace

CouplingAlarm::CouplingAlarm(const scene::Scene& scene)
    : scene_(scene),
      ends_session_(scene.session.coupling_alarm == scene::CouplingAlarm::stop),
      indicator_(scene.ports.size(), {scene.session.step_duration().ns * scene.session.exchange_every},
                 least_forces(scene)),
      fading_(std::exp(-scene.session.step_duration().seconds() * scene.session.exchange_every / kFading)),
      least_force_(least_forces(scene)),
      made_(scene.ports.size()) {}

void CouplingAlarm::reset() noexcept {
  indicator_.reset();
  for (Made& made : made_) made = Made{};
  text_length_ = 0;
}

void CouplingAlarm::update(const coupling::MechanismSample& mechanism, const coupling::ActuatorSample& actuators,
                           const coupling::PortArray& stiffness, const coupling::PortLevels& levels,
                           bool bends) noexcept {
  indicator_.update(mechanism, actuators, stiffness, levels);
  // a light port gains more than it holds without harm to the machine
  double held = 0;
  for (std::size_t i = 0; i < made_.size(); ++i) {
    Made& made = made_[i];
    made.force = std::max(fading_ * made.force, std::fabs(actuators.F[i]));
    made.stiffness = std::max(fading_ * made.stiffness, stiffness[i]);
    made.share *= fading_;
    const double F = std::max(made.force, least_force_[i]);
    if (made.stiffness > 0) held = std::max(held, F * F / (2 * made.stiffness));
  }
  if (!bends || !(held > 0)) return;
  for (std::size_t i = 0; i < made_.size(); ++i) {
    if (!(mechanism.W[i * made_.size() + i] > 0)) continue;  // forces do not move the port
    made_[i].share += std::clamp(-indicator_.port(i).dE_star / held, -kMostAtOnce, kMostAtOnce);
  }
}

// Two sides of a balanced level foresee each other; hold creates energy on any machine that swings, and is only
// flagged. A port that ends the session comes before a flagged one.
std::optional<std::size_t> CouplingAlarm::first_alarm(const coupling::PortLevels& levels) const noexcept {
  std::optional<std::size_t> flagged;
  for (std::size_t i = 0; i < scene_.ports.size(); ++i) {
    if (coupling::is_balanced(levels[i])) {
      if (indicator_.diverges(i) || made_[i].share > kMostMade) return i;
    } else if (!flagged && indicator_.port(i).creates_energy) {
      flagged = i;
    }
  }
  return flagged;
}

void CouplingAlarm::raise_flags(const coupling::PortLevels& levels, StepReport& report) noexcept {
  const std::optional<std::size_t> port = first_alarm(levels);
  if (!port) return;
  report.raise(StepFlag::coupling_creates_energy);
  if (!ends_session_ || !coupling::is_balanced(levels[*port])) return;
  report.raise(StepFlag::ended);
  write_text(*port, levels[*port]);
}

void CouplingAlarm::write_text(std::size_t port, coupling::Level level) noexcept {
  const bool is_free_running = scene_.session.mode == scene::ExchangeMode::free_running;
  const char* const remedy = level != coupling::Level::two ? "a shorter session.step or coupling: two"
                             : is_free_running             ? "a shorter session.step or session.mode: lockstep"
                                                           : "a shorter session.step";
  if (!indicator_.diverges(port)) {
    const auto written = fmt::format_to_n(
        text_.data(), text_.size(),
        "{}: the coupling diverges: over the last second it created {:.2g} % or more of the energy that the oil "
        "springs hold, at omega_H = {:.2g} of the oil-spring oscillation, in steps within which the spring of a "
        "chamber may change; use {}, or session.coupling_alarm: warn to continue with red lamps",
        scene_.ports[port].name, 1e2 * made_[port].share, indicator_.omega_H(), remedy);
    text_length_ = std::min(written.size, text_.size());
    return;
  }
  const auto written = fmt::format_to_n(
      text_.data(), text_.size(),
      "{}: the coupling diverges: over the last second the works of both sides differed by {:.2g} % of the work "
      "done, in several exchanges, at omega_H = {:.2g} of the oil-spring oscillation; use {}, or "
      "session.coupling_alarm: warn to continue with red lamps",
      scene_.ports[port].name, 1e2 * indicator_.own_residual(port), indicator_.omega_H(), remedy);
  text_length_ = std::min(written.size, text_.size());
}

}  // namespace slew::hydraulics_node
