// SPDX-License-Identifier: Apache-2.0
#include "analysis/start_check.h"

#include <fmt/format.h>

#include <cstddef>

#include "analysis/coupling_check.h"
#include "core/display.h"
#include "coupling/static_forces.h"
#include "hydraulics/circuit.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace {

std::string unheld_warning(const scene::Scene& scene, const session::DirectSession& session) {
  if (scene.ports.empty() || !scene.has_mechanics() || !scene.has_hydraulics()) return {};
  if (scene.hydraulics.start != hydraulics::StartState::equilibrium) return {};
  const coupling::MechanismSample& mechanism = session.sample(wire::Role::mechanics).mechanism;
  std::vector<double> F(scene.ports.size());
  if (!coupling::static_forces(mechanism.W.span(), mechanism.a_free.span(), F)) return {};
  const std::vector<double> missing =
      hydraulics::Circuit(scene.hydraulics).unheld_at_start(F, mechanism.W.span(), mechanism.x.span());
  std::string forces;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (missing[i] == 0) continue;
    const std::string_view unit = info(coupling::dimensions_of(scene.ports[i].unit).force).si_unit;
    forces += fmt::format("{}{} lacks {} of {}", forces.empty() ? "" : ", ", scene.ports[i].name,
                          quantity_text(missing[i], unit), quantity_text(F[i], unit));
  }
  if (forces.empty()) return {};
  return fmt::format(
      "hydraulics.start: equilibrium: no pressures of the volumes that actuators share hold all their loads: {}; they "
      "move from the start on. Change their loads or areas, or give them volumes of their own",
      forces);
}

}  // namespace

std::vector<std::string> start_warnings(const scene::Scene& scene, const session::DirectSession& session) {
  std::vector<std::string> warnings = coupling_warnings(scene, session);
  if (std::string unheld = unheld_warning(scene, session); !unheld.empty()) warnings.push_back(std::move(unheld));
  return warnings;
}

std::vector<std::string> start_warnings(const scene::Scene& scene) {
  if (scene.ports.empty()) return {};
  session::DirectSession session(scene);
  if (!session.start().is_ok()) return {};
  return start_warnings(scene, session);
}

}  // namespace slew::analysis
