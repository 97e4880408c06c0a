#include "cli/load_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/recorded.h"
#include "hydraulics/circuit.h"
#include "hydraulics/components/l90ls_valve.h"
#include "hydraulics/components/ls_pump.h"

namespace slew::cli {
namespace {

bool has_variable(const recording::Reader& reader, const std::string& name) {
  return view_recording(reader, Values::none).find(name) != nullptr;
}

// slower than this a port counts as standing: a tenth of the crane's slowest useful motion
constexpr double kStanding = 5e-4;  // m/s
constexpr double kLongEnough = 1;   // s
// of the signal that leaves the overlap
constexpr double kClearlyCommanded = 1.05;

}  // namespace

std::vector<PortLimit> port_limits(const scene::Scene& scene) {
  const hydraulics::Circuit circuit(scene.hydraulics);
  // the weakest pump bounds every valve
  double pump = HUGE_VAL;
  for (const auto& component : scene.hydraulics.components) {
    if (const auto* def = dynamic_cast<const hydraulics::LsPumpDef*>(component.get())) {
      pump = std::min(pump, def->maximum_ls_pressure + def->set_pressure);
    }
  }
  std::vector<PortLimit> limits;
  for (std::size_t i = 0; i < scene.ports.size(); ++i) {
    const hydraulics::Actuator& actuator = circuit.actuators()[i];
    for (const auto& component : scene.hydraulics.components) {
      const auto* valve = dynamic_cast<const hydraulics::L90lsValveDef*>(component.get());
      if (valve == nullptr || circuit.find_volume(valve->port_a) != actuator.port_a) continue;
      PortLimit limit;
      limit.port = scene.ports[i].name;
      limit.valve = valve->name;
      limit.area_a = actuator.area_a;
      limit.area_b = actuator.area_b;
      limit.valve_ls = valve->maximum_ls_pressure_a;
      limit.compensator = valve->compensator_pressure;
      limit.moves_above = valve->overlap * valve->nominal_control_signal;
      double tank = 1e5;
      for (const auto& volume : scene.hydraulics.volumes) {
        if (volume.name == valve->port_t) tank = volume.initial_pressure;
      }
      limit.pressure = tank + std::min(limit.valve_ls + limit.compensator, pump);
      limit.efficiency = scene.ports[i].line_force.efficiency;
      limit.seal_friction = scene.ports[i].line_force.seal_friction;
      limit.breakaway = 0;
      for (const auto& point : scene.ports[i].line_force.friction_curve) {
        limit.breakaway = std::max(limit.breakaway, point[1]);
      }
      limits.push_back(limit);
      break;
    }
  }
  return limits;
}

std::optional<std::string> explain_stall(const PortLimit& limit, const std::string& payload,
                                         const std::vector<PortLoad>& history) {
  // longest time asked to push and standing under a load that is too heavy
  double begin = 0, longest = 0;
  const PortLoad* worst = nullptr;
  bool is_stalled = false;
  for (const PortLoad& load : history) {
    const double F_limit = limit.pressure * limit.area_a - load.return_pressure * limit.area_b;
    const double friction = std::fabs(F_limit) * (1 - limit.efficiency) * limit.breakaway + limit.seal_friction;
    const bool stalls = load.control >= kClearlyCommanded * limit.moves_above && std::fabs(load.speed) < kStanding &&
                        load.static_force + friction > F_limit;
    if (stalls && !is_stalled) begin = load.time;
    is_stalled = stalls;
    if (stalls && load.time - begin >= longest) {
      longest = load.time - begin;
      worst = &load;
    }
  }
  if (worst == nullptr || longest < kLongEnough) return std::nullopt;
  const double F_limit = limit.pressure * limit.area_a - worst->return_pressure * limit.area_b;
  const double friction = std::fabs(F_limit) * (1 - limit.efficiency) * limit.breakaway + limit.seal_friction;
  const double needed = (worst->static_force + friction + worst->return_pressure * limit.area_b) / limit.area_a;
  std::string text = fmt::format(
      "{} was asked to push for {:.1f} s and did not move: the load needs {:.0f} bar with friction, {} gives at most "
      "{:.0f} bar ({:.0f} bar load-sensing limit + {:.0f} bar compensator)",
      limit.port, longest, needed / 1e5, limit.valve, limit.pressure / 1e5, limit.valve_ls / 1e5,
      limit.compensator / 1e5);
  if (worst->static_force_per_kg > 0 && worst->payload > 0) {
    const double most = worst->payload + (F_limit - friction - worst->static_force) / worst->static_force_per_kg;
    text += most > 0 ? fmt::format("; in this pose {} could weigh {:.0f} kg at most, it weighs {:.0f} kg", payload,
                                   std::floor(most / 10) * 10, worst->payload)
                     : fmt::format("; in this pose it cannot lift {} at all", payload);
  }
  return text;
}

std::vector<std::string> explain_stalls(const scene::Scene& scene, const recording::Reader& reader) {
  std::vector<std::string> notes;
  if (scene.mechanics.bodies.empty()) return notes;
  const std::string payload = scene.mechanics.bodies.back().name;
  for (const PortLimit& limit : port_limits(scene)) {
    const std::vector<std::string> names = {limit.valve + ".control_signal",     limit.port + ".speed",
                                            limit.port + ".pressure_b",          limit.port + ".static_force",
                                            limit.port + ".static_force_per_kg", payload + ".mass"};
    std::vector<plotting::Series> curves;
    for (const std::string& name : names) {
      if (!has_variable(reader, name)) break;
      const std::string one[] = {name};
      curves.push_back(read_series(reader, one, Units::si).front());
    }
    // a recording with a selection of variables may lack some: nothing can be said then
    if (curves.size() != names.size()) continue;
    std::vector<PortLoad> history;
    for (std::size_t i = 0; i < curves[0].time.size(); ++i) {
      const auto at = [&](std::size_t curve) {
        return i < curves[curve].values.size() ? curves[curve].values[i] : 0.0;
      };
      history.push_back({curves[0].time[i], at(0), at(1), at(2), at(3), at(4), at(5)});
    }
    if (std::optional<std::string> text = explain_stall(limit, payload, history)) notes.push_back(std::move(*text));
  }
  return notes;
}

}  // namespace slew::cli
