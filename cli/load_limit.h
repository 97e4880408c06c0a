// Why a commanded load does not move: what its port would have to push, what valve and pump give at most, and how much
// load that would lift at this pose.
//
//   F_limit = p_limit A_A - p_B A_B,  p_limit = p_T + min(p_LS,valve + dp_compensator, p_LS,pump + margin)         (1)
//   not lifted:  F_static + F_mu > F_limit with breakaway friction F_mu = F_limit (1 - eta) f_max + F_seal         (2)
//   m_max = m + (F_limit - F_mu - F_static) / (dF_static/dm)                                                       (3)
//
// F_static [N] line force that holds the mechanism still, dF_static/dm its change per kg of the payload (the scene's
// last moving body); both are variables of the mechanics (`Cyl_Lift.static_force`, `.static_force_per_kg`).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording/reader.h"
#include "scene/scene.h"

namespace slew::cli {

// What valve and pump can give one port that pushes.
struct PortLimit {
  std::string port;  // actuator
  std::string valve;
  double area_a = 0, area_b = 0;  // m2
  double pressure = 0;            // p_limit, absolute [Pa]
  double valve_ls = 0;            // Pa above tank
  double compensator = 0;         // Pa
  double moves_above = 0;         // control signal that leaves the overlap
  double efficiency = 1, seal_friction = 0, breakaway = 1;
};

// Ports whose actuator is fed by a load-sensing valve, in port order.
[[nodiscard]] std::vector<PortLimit> port_limits(const scene::Scene& scene);

// One instant of one port.
struct PortLoad {
  double time = 0;                 // s
  double control = 0;              // of the valve, positive: A side pressurised
  double speed = 0;                // m/s
  double return_pressure = 0;      // p_B [Pa]
  double static_force = 0;         // N
  double static_force_per_kg = 0;  // N/kg
  double payload = 0;              // kg
};

// A sentence for the summary when the port was asked to push for at least a second and could not; empty otherwise.
[[nodiscard]] std::optional<std::string> explain_stall(const PortLimit& limit, const std::string& payload,
                                                       const std::vector<PortLoad>& history);

// The sentences for all ports of a recording.
[[nodiscard]] std::vector<std::string> explain_stalls(const scene::Scene& scene, const recording::Reader& reader);

}  // namespace slew::cli
