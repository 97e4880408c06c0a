#include "hydraulics/pump_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hydraulics/components/compensated_orifice.h"
#include "hydraulics/components/direct_relief_valve.h"
#include "hydraulics/components/four_way_valve.h"
#include "hydraulics/components/l90ls_valve.h"
#include "hydraulics/components/ls_pump.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/oil.h"

namespace slew::hydraulics {
namespace {

constexpr double kBar = 1e5;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// flow: the largest flow below the end of the oil law [m3/s]
struct Connection {
  std::string a, b;
  double flow = kUnbounded;
};

struct Network {
  std::vector<Connection> open;    // volumes that are connected at any signal
  std::set<std::string> relieved;  // volumes with a relieving valve, or held at a pressure
};

void add_restriction(const ComponentDef& component, double density, Network& network) {
  if (const auto* bleed = dynamic_cast<const BleedDef*>(&component); bleed != nullptr && bleed->nominal_flow > 0) {
    const double drops = OilCompressibility::kHighest / bleed->nominal_pressure_drop;
    network.open.push_back({bleed->port_1, bleed->port_2, bleed->nominal_flow * std::sqrt(drops)});
  } else if (const auto* orifice = dynamic_cast<const OrificeDef*>(&component);
             orifice != nullptr && orifice->opening > 0) {
    const double area = orifice->opening * std::numbers::pi / 4 * orifice->diameter * orifice->diameter;
    const double speed = orifice->discharge_coefficient * std::sqrt(2 * OilCompressibility::kHighest / density);
    network.open.push_back({orifice->port_1, orifice->port_2, area * speed});
  } else if (const auto* pipe = dynamic_cast<const LaminarRestrictionDef*>(&component)) {
    network.open.push_back({pipe->port_1, pipe->port_2});
  } else if (const auto* metering = dynamic_cast<const CompensatedOrificeDef*>(&component);
             metering != nullptr && metering->opening > 0) {
    network.open.push_back({metering->port_p, metering->port_a});
  }
}

void add_valve(const ComponentDef& component, Network& network) {
  if (const auto* relief = dynamic_cast<const ReliefValveDef*>(&component)) {
    if (relief->setting_pressure < OilCompressibility::kHighest) network.relieved.insert(relief->port_1);
  } else if (const auto* poppet = dynamic_cast<const DirectReliefValveDef*>(&component)) {
    if (poppet->crack_pressure < OilCompressibility::kHighest) network.relieved.insert(poppet->port_1);
  } else if (const auto* spool = dynamic_cast<const L90lsValveDef*>(&component)) {
    network.relieved.insert({spool->port_a, spool->port_b});
  } else if (const auto* bridge = dynamic_cast<const FourWayValveDef*>(&component);
             bridge != nullptr && bridge->opening_gain == 0) {
    if (bridge->neutral_opening > 0) {
      network.open.insert(network.open.end(), {{bridge->port_p, bridge->port_a}, {bridge->port_b, bridge->port_t}});
    }
    if (bridge->neutral_opening < 1) {
      network.open.insert(network.open.end(), {{bridge->port_p, bridge->port_b}, {bridge->port_a, bridge->port_t}});
    }
  }
}

Network network_of(const HydraulicsDef& def) {
  Network network;
  for (const VolumeDef& volume : def.volumes) {
    if (volume.fixed) network.relieved.insert(volume.name);
  }
  for (const auto& component : def.components) {
    add_restriction(*component, def.oil_density, network);
    add_valve(*component, network);
  }
  return network;
}

// through connections that pass the pump's flow
bool is_relieved(const Network& network, const std::string& outlet, double flow) {
  std::set<std::string> line = {outlet};
  std::vector<std::string> unvisited = {outlet};
  while (!unvisited.empty()) {
    const std::string volume = std::move(unvisited.back());
    unvisited.pop_back();
    if (network.relieved.contains(volume)) return true;
    for (const Connection& link : network.open) {
      const std::string* const next = link.a == volume ? &link.b : link.b == volume ? &link.a : nullptr;
      if (link.flow < flow) continue;
      if (next != nullptr && line.insert(*next).second) unvisited.push_back(*next);
    }
  }
  return false;
}

}  // namespace

void find_unrelieved_pumps(const HydraulicsDef& def, Problems& warnings) {
  const Network network = network_of(def);
  for (const auto& component : def.components) {
    const auto* const pump = dynamic_cast<const LsPumpDef*>(component.get());
    if (pump == nullptr) continue;
    const double flow = pump->speed * pump->displacement * pump->volumetric_coefficient;
    if (is_relieved(network, pump->port_a, flow)) continue;
    const double set = pump->ls_port.empty()
                           ? pump->standby_pressure
                           : std::max(pump->standby_pressure, pump->maximum_ls_pressure + pump->set_pressure);
    warnings.push_back(
        {pump->name + ".port_a",
         fmt::format("the pump's line has no relief valve: where '{}' is closed off, its pressure ends "
                     "where the pump's controller does, {:.6g} bar above tank, or beyond",
                     pump->port_a, set / kBar),
         fmt::format("a relief_valve on the line, set below {:g} bar", OilCompressibility::kHighest / kBar), ""});
  }
}

}  // namespace slew::hydraulics
