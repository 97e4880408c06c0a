// SPDX-License-Identifier: Apache-2.0
#include "analysis/coupling_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "core/display.h"
#include "coupling/indicator.h"
#include "coupling/own_past.h"
#include "scene/defs.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace {

using coupling::Level;
using wire::Role;

// damping ratio assumed for a port without leaks: seals and hoses have a little
constexpr double kLeastDamping = 0.02;
// a tenth of the machine's mass
constexpr double kLargestParasiticMass = 0.1;

constexpr std::string_view kNames[coupling::kLevels] = {"hold", "linear", "two", "tlm"};

// The ports of one level at the start: their mobilities and oil columns, each port alone.
struct Ports {
  std::vector<std::size_t> port;
  coupling::PortMatrix W, K_cross;
  coupling::PortArray K;
};

Ports ports_of(Level level, const coupling::PortLevels& levels, const coupling::MechanismSample& mechanism,
               const coupling::ActuatorSample& actuators, double H) {
  Ports ports;
  const std::size_t m = mechanism.x.size();
  for (std::size_t i = 0; i < m; ++i) {
    if (levels[i] == level) ports.port.push_back(i);
  }
  for (const std::size_t i : ports.port) {
    // a line states its impedance K H
    ports.K.push_back(level == Level::tlm ? actuators.D[i] / H : actuators.K[i]);
    for (const std::size_t j : ports.port) {
      ports.W.push_back(mechanism.W[i * m + j]);
      if (!actuators.K_cross.empty()) ports.K_cross.push_back(actuators.K_cross[i * m + j]);
    }
  }
  return ports;
}

// Index of the port whose own oil column has the highest frequency.
std::size_t fastest(const Ports& ports) {
  std::size_t found = 0;
  const std::size_t m = ports.port.size();
  const auto square = [&](std::size_t i) { return ports.W[i * m + i] * ports.K[i]; };
  for (std::size_t i = 1; i < m; ++i) {
    if (square(i) > square(found)) found = i;
  }
  return found;
}

std::string swinging(const Ports& ports, Level level, const std::string& name,
                     const coupling::ActuatorSample& actuators, double H) {
  const double omega_H = coupling::coupling_frequency(ports.W, ports.K, H, ports.K_cross);
  const double leak = actuators.lambda[ports.port[fastest(ports)]];
  const double zeta = leak > 0 && omega_H > 0 ? 0.5 * leak * H / omega_H : kLeastDamping;
  const double limit = coupling::omega_limit(level, zeta);
  if (!(omega_H > limit)) return {};
  const std::string damping = level != Level::hold ? ""
                                                   : fmt::format(" (twice the damping ratio {:.2g}{})", zeta,
                                                                 leak > 0 ? " of its leaks" : ", assumed");
  const double safe = H * limit / omega_H;
  std::string remedy = safe < scene::kMinStep ? "" : "session.step " + duration_below(safe) + " or less";
  if (level != Level::two) remedy += (remedy.empty() ? "" : ", or ") + std::string("coupling 'two'");
  return fmt::format(
      "{}: omega_H (oil-spring frequency times exchange interval {}) is {:.2g}; level "
      "'{}' is valid up to {:.2g}{}; the run may be wrong or unstable: use {}",
      name, duration_text(H), omega_H, kNames[static_cast<std::size_t>(level)], limit, damping, remedy);
}

// K H^2 against 1/W, port by port
std::string heavy_line(const Ports& ports, const scene::Scene& scene, double H) {
  const std::size_t m = ports.port.size(), i = fastest(ports);
  const double mass = ports.K[i] * H * H, share = mass * ports.W[i * m + i];
  if (!(share > kLargestParasiticMass)) return {};
  return fmt::format(
      "{}: level 'tlm' gives it a parasitic mass of {:.3g} kg, {:.0f} % of what it moves, at a step of {}; the run "
      "will "
      "be too slow and too damped: use session.step {} or less, or coupling 'two'",
      scene.ports[ports.port[i]].name, mass, 100 * share, duration_text(H),
      duration_below(H * std::sqrt(kLargestParasiticMass / share)));
}

// samples of free-running sides are a step old, or older
std::string running_late(const Ports& ports, const std::string& name, double H) {
  const double omega_H = coupling::coupling_frequency(ports.W, ports.K, H, ports.K_cross);
  if (!(omega_H > coupling::kMostLate)) return {};
  const double safe = H * coupling::kMostLate / omega_H;
  const std::string step = safe < scene::kMinStep ? "" : "session.step " + duration_below(safe) + " or less, or ";
  return fmt::format(
      "{}: free_running works with samples that are a step or more late; omega_H is {:.2g} at a step of {}, and the "
      "mode is valid up to {:.2g} over the number of late or lost steps; the run may be wrong or unstable: use "
      "{}session.mode lockstep",
      name, omega_H, duration_text(H), coupling::kMostLate, step);
}

}  // namespace

std::vector<std::string> coupling_warnings(const scene::Scene& scene, const session::DirectSession& session) {
  std::vector<std::string> warnings;
  if (scene.ports.empty() || !scene.has_mechanics() || !scene.has_hydraulics()) return warnings;
  const coupling::MechanismSample& mechanism = session.sample(Role::mechanics).mechanism;
  const coupling::ActuatorSample& actuators = session.sample(Role::hydraulics).actuators;
  const coupling::PortLevels levels = scene::port_levels(scene);
  const double every = static_cast<double>(scene.session.exchange_every);
  const double H = every * scene.session.step_duration().seconds();
  for (int k = 0; k < coupling::kLevels; ++k) {
    const auto level = static_cast<Level>(k);
    const Ports ports = ports_of(level, levels, mechanism, actuators, H);
    if (ports.port.empty()) continue;
    const std::string& name = scene.ports[ports.port[fastest(ports)]].name;
    std::string warning =
        level == Level::tlm ? heavy_line(ports, scene, H) : swinging(ports, level, name, actuators, H);
    if (!warning.empty()) warnings.push_back(std::move(warning));
    if (level == Level::tlm || scene.session.mode != scene::ExchangeMode::free_running) continue;
    std::string late = running_late(ports, name, H);
    if (!late.empty()) warnings.push_back(std::move(late));
  }
  return warnings;
}

}  // namespace slew::analysis
