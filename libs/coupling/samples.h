// SPDX-License-Identifier: Apache-2.0
// Samples that mechanics, hydraulics and flexible bodies exchange once per communication step (coupling study, sections
// 5, 8 and 10).
//
// A port is one actuator: x is its stroke [m] (piston position), F the pressure force that pushes the stroke open [N].
// Sample n holds at t_n = n H; it is published after step n-1 and used for step n. Arrays are in port order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/static_vector.h"

namespace slew::coupling {

inline constexpr std::size_t kMaxPorts = 16;

using PortArray = StaticVector<double, kMaxPorts>;
using PortMatrix = StaticVector<double, kMaxPorts * kMaxPorts>;  // m x m, row-major, without gaps

enum class MobilityKind : std::uint8_t {
  instant,  // W = J M^-1 J^T
  step      // rows with stiff laws behind the ports (joint friction, limits) condensed implicitly over H
};

// Sample from mechanics to hydraulics.
struct MechanismSample {
  PortArray x;       // stroke [m]
  PortArray v;       // speed [m/s]
  PortArray a;       // acceleration with the line forces [m/s2]
  PortArray a_free;  // acceleration without the line forces, J M^-1 h + Jdot u [m/s2]
  PortMatrix W;      // interface mobility [1/kg]
  MobilityKind W_kind = MobilityKind::instant;
  PortArray F_used;   // mechanics' copy of the pressure force at t_n [N]
  PortArray F_line;   // pressure force less friction plus end stop at t_n [N]
  PortArray work;     // integral of F v dt since the last exchange [J]
  PortArray impulse;  // integral of F dt since the last exchange [N s]
  PortArray v_mean;   // mean speed of the finished step [m/s]
  bool operator==(const MechanismSample&) const = default;
};

// Sample from hydraulics to mechanics. F holds at (x_ref, v_ref), the hydraulics' own piston position and speed at t_n;
// near it
//   F' = F_dot - K (v - v_ref) - lambda (F - F_n),  line contribution -D (v - v_ref).
// Where ports share volumes of oil, F_i' has -sum_j K_cross_ij (v_j - v_ref_j) too.
struct ActuatorSample {
  PortArray F;  // pressure force pA AA - pB AB [N]; where the step was foreseen (foreseen_forces.h) its line's begin
  PortArray F_dot;           // under the signals expected for the next tick [N/s]
  PortArray K;               // oil-column stiffness, >= 0 [N/m]
  PortArray lambda;          // leakage of the spring, >= 0 [1/s]
  PortArray D;               // feed-through damping, >= 0 [N s/m]
  PortArray x_ref;           // [m]
  PortArray v_ref;           // [m/s]
  PortArray friction_scale;  // |F| (1 - eta) [N]
  PortArray work;            // integral of F v dt since the last exchange [J]
  PortArray impulse;         // integral of F dt since the last exchange [N s]
  PortArray p_A, p_B;        // chamber pressures, absolute [Pa]
  PortArray Q_A, Q_B;        // flows into the A and B volumes from the circuit [m3/s]
  std::uint32_t flags = 0;   // StepFlag bits of the finished step
  PortMatrix K_cross;        // stiffness between ports, zero on the diagonal; empty: none share a volume [N/m]
  bool operator==(const ActuatorSample&) const = default;
};

inline constexpr std::size_t kMaxFlexibleBodies = 32;  // limit of bodies with modes
inline constexpr std::size_t kMaxModes = 128;          // limit of the modes of all bodies together
inline constexpr std::size_t kMaxModePairs = 2048;     // sum of the squares of their modes

using BodyArray = StaticVector<double, kMaxFlexibleBodies>;
using FrameArray = StaticVector<double, kMaxFlexibleBodies * 13>;
using ModeArray = StaticVector<double, kMaxModes>;      // body after body, in the scene's order
using ModePairs = StaticVector<double, kMaxModePairs>;  // body after body, m x m, row-major

// Sample from mechanics to flexible bodies: scheme A1 of the study, in which the mechanics owns the modal coordinates.
struct FlexibleSample {
  ModeArray q;  // modal coordinates [m sqrt(kg)]
  ModeArray u;  // their rates
  FrameArray
      frame;  // by body: position [m], quaternion (w, x, y, z), velocity [m/s], angular velocity [rad/s] in Ground
  bool operator==(const FlexibleSample&) const = default;
};

// Sample from flexible bodies to mechanics: the elastic force of the modes, damping included, near the point (q_ref,
// u_ref):
//   Q - K (q - q_ref) - D (u - u_ref)
// For bodies that keep their states, condensed over the step (scheme B): the point is their own state, K = D = 0, and
//   M = M_modes + H/2 D + H^2/4 K,   Q = -K (q_ref + H/2 u_ref) - D u_ref
struct ElasticSample {
  ModeArray Q;      // [m sqrt(kg)/s2]
  ModePairs K;      // stiffness, symmetric, positive definite [1/s2]
  ModePairs D;      // damping [1/s]
  ModePairs M;      // condensed mass of the modes [1]; empty: not condensed
  ModeArray q_ref;  // [m sqrt(kg)]
  ModeArray u_ref;
  BodyArray strain_energy;   // at the mechanics' coordinates [J]
  bool is_constant = false;  // K, D and the point hold for the whole session
  bool operator==(const ElasticSample&) const = default;
};

inline constexpr std::size_t kMaxSensedBodies = 256;  // limit of bodies with shapes that sensors look at
inline constexpr std::size_t kPoseNumbers = 13;       // of a body
inline constexpr std::size_t kMaxSensorEvents = 256;  // of one sample

// Sample from mechanics to sensors.
struct PoseSample {
  // by body: position [m], quaternion (w, x, y, z), velocity [m/s], angular velocity [rad/s] in Ground
  StaticVector<double, kMaxSensedBodies * kPoseNumbers> frame;
  bool operator==(const PoseSample&) const = default;
};

// An event of a sensor, docs/models/sensors.md.
struct SensorEvent {
  std::uint16_t sensor = 0;       // in the scene's order
  std::uint16_t watched = 0;      // zone: in the order of `watch`
  std::uint8_t kind = 0;          // sensors::EventKind
  double value = 0;               // m, s or m/s, by kind
  std::array<double, 3> place{};  // m, of a hit
  double before = 0;              // s, by which a hit was before the sample
  bool operator==(const SensorEvent&) const = default;
};

// Sample from sensors, for observers and the recording.
struct SensorSample {
  std::vector<SensorEvent> events;  // at most kMaxSensorEvents
  bool operator==(const SensorSample&) const = default;
};

// Scheme of a session's flexible bodies.
enum class ElasticExchange : int {
  once,        // linear elastic forces, published at the start; no node waits for later samples
  every_step,  // published at every step, about the mechanics' coordinates of that step
  condensed    // the flexible side keeps its coordinates and publishes them condensed over each step
};

void resize(MechanismSample& sample, std::size_t ports);
void resize(ActuatorSample& sample, std::size_t ports);

// Force change of a port by the oil springs when all ports have moved by dx [m]: sum_j K_ij dx_j [N].
[[nodiscard]] double spring_force(const ActuatorSample& sample, std::size_t port, std::span<const double> dx) noexcept;

}  // namespace slew::coupling
