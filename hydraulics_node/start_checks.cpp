// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/start_checks.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "core/display.h"
#include "coupling/indicator.h"
#include "coupling/own_past.h"
#include "scene/unsettled_start.h"

namespace slew::hydraulics_node {

Status check_pressures(const scene::Scene& scene, const hydraulics::Circuit& circuit, std::span<const double> F,
                       std::span<const double> W, std::span<const double> x) {
  const std::optional<hydraulics::StartDemand> demand = circuit.demand_beyond_limits(F, W, x);
  if (!demand) return Status::ok();
  constexpr double kBar = 1e5;
  const auto actuator = static_cast<std::size_t>(demand->actuator);
  const scene::PortDef& port = scene.ports[actuator];
  std::string limit = "no oil has a pressure below 0";
  if (demand->pressure >= 0) {
    limit = demand->valve.empty()
                ? fmt::format("a chamber without a relief valve is taken to hold {:.0f} bar", demand->limit / kBar)
                : fmt::format("{} opens fully at {:.4g} bar", demand->valve, demand->limit / kBar);
  }
  const std::string contacts = scene::deep_starts(scene);
  return Status::error(
      ExitCode::failed,
      fmt::format("hydraulics.start: equilibrium requires {:.4g} bar in {} to hold {} on {}, but {}. {}",
                  demand->pressure / kBar, circuit.volume_name(demand->volume),
                  quantity_text(F[actuator], info(coupling::dimensions_of(port.unit).force).si_unit), port.name, limit,
                  contacts.empty() ? "Lighten the load or begin in another pose, or set hydraulics.start: table13"
                                   : contacts + ". Move these bodies apart, or set hydraulics.start: table13"));
}

Status check_stability(const hydraulics::ExplicitStability& stability, std::string_view owner) {
  if (!(stability.ratio > 1)) return Status::ok();
  return Status::error(
      ExitCode::failed,
      fmt::format(
          "hydraulics.solver: rk4 with sub-steps of {:.3g} ms would be unstable: {} moves {:.2g} times too fast "
          "for it. Set hydraulics.max_substep below {:.3g} ms, or solver: rodas3",
          1e3 * stability.substep, owner, stability.ratio, 1e3 * stability.substep / stability.ratio));
}

Status check_coupling(const scene::Scene& scene, const coupling::PortMatrix& W,
                      const coupling::ActuatorSample& published, const coupling::PortLevels& levels) {
  const StepIndex exchange_every = scene.session.exchange_every;
  const bool is_free_running = scene.session.mode == scene::ExchangeMode::free_running;
  const double H = scene.session.step_duration().seconds() * static_cast<double>(exchange_every);
  coupling::PortArray K = published.K;
  coupling::PortMatrix K_cross = published.K_cross;
  const std::size_t m = K.size();
  for (std::size_t i = 0; i < m; ++i) {
    if (coupling::is_balanced(levels[i])) continue;
    K[i] = 0;
    for (std::size_t j = 0; j < m && !K_cross.empty(); ++j) K_cross[i * m + j] = K_cross[j * m + i] = 0;
  }
  const double omega_H = coupling::coupling_frequency(W, K, H, K_cross);
  const double limit = is_free_running ? coupling::kMostLate : coupling::kMostSampled;
  if (!(omega_H > limit)) return Status::ok();
  const char* const bound = is_free_running
                                ? "above the limit for samples that are a step late (session.mode: free_running)"
                                : "above the Nyquist limit of the exchange";
  return Status::error(
      ExitCode::failed,
      fmt::format(
          "session.coupling: the oil-spring oscillation has omega_H = {:.2g} at one exchange in {:.3g} ms, {}: at most "
          "{:.2g}. Nothing was run. Set {} below {:.2g} ms{}, or session.coupling_alarm: warn to run it nevertheless",
          omega_H, 1e3 * H, bound, limit, exchange_every > 1 ? "the time between two exchanges" : "session.step",
          1e3 * H * limit / omega_H, is_free_running ? ", or session.mode: lockstep" : ""));
}

}  // namespace slew::hydraulics_node
