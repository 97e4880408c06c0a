// SPDX-License-Identifier: Apache-2.0
// Live error indicator of one port: defects at the exchange and the corrected power-bond residual
// (coupling study, section 9).
//
//   e_x = x - x_ref,  e_v = v - v_ref                                                              (1)
//   e_F = (F_n - K e_x) - F_used      hydraulics' force, moved to the true x, less mechanics' copy (2)
//   dE  = W_hyd - W_mech              work of F over the finished step as each side saw it         (3)
//   dE* = dE + F_n e_x - K e_x^2 / 2  after the work of the volume correction                      (4)
//   own = max(sum |W_mech|, F^2 / (2 K), v^2 / (2 W)),  net = sum dE* / own, over 1 s               (5)
//   eta = sum |dE*| / own                            level hold and tlm
//         sum |dE*| less its 3 largest 50 ms / largest own of all ports      linear and two        (5')
//   omega_H = H sqrt(largest eigenvalue of W K)                                                    (6)
// K e_x is sum_j K_ij e_x,j where ports share volumes of oil.
//
// Lamps: green below 5e-4, amber below 5e-3, red above (docs/coupling-alarm.md: what errors they stand for);
// net < -3e-3 for 0.2 s: the coupling creates energy. The scale F^2 / (2 K) uses the largest |F| of the window,
// at least 1 N; v^2 / (2 W) is the kinetic energy that the port can give back, at the last exchange: a port without
// force that begins to move has no other scale. (5') takes the largest own of all ports without it.
//
// The error of a light port is judged against the machine's energy, since its own is too small a scale.
//
// One jump of a valve is one exchange whose work the mechanics could not foresee: it may be large in eta and net for
// the whole window and does no more. A coupling that diverges fails exchange after exchange. So a port diverges when
//   sum |dE*| > 0.1 max(sum |W_mech|, F^2 / (2 K))                                                  (7)
// within half of the window's buckets or more, each with its own work and its own largest |F|: a swing that grows
// within the window does not hide the buckets before it; and at once when sum |dE*| > 4 own, more than any jump of a
// sound run leaves, if forces can move the port at all (W > 0). Both take the port's least force for a smaller |F|:
// what the partners disagree on at a port that hardly pushes is an error of a motion that others make.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/state_bytes.h"
#include "core/time.h"
#include "coupling/level.h"
#include "coupling/port_levels.h"
#include "coupling/samples.h"

namespace slew::coupling {

enum class Lamp : std::uint8_t { green, amber, red };

inline constexpr double kGreenBelow = 5e-4;
inline constexpr double kAmberBelow = 5e-3;
// docs/coupling-alarm.md, errors at eta above kGreenBelow: error of the force over its range in the mean square of any
// second, and error of the stroke over its range: half of all runs are below the first, 95 of 100 below the second.
inline constexpr double kUsualForceError = 4, kLargeForceError = 25;
inline constexpr double kUsualStrokeError = 1.3, kLargeStrokeError = 12;
inline constexpr double kNetAlarm = -3e-3;
// docs/coupling-alarm.md: sound runs reach 0.08 in half of their buckets
inline constexpr double kDivergesAbove = 0.1;
// and sum |dE*| over own reaches 1 in sound runs; runs with an error of 3 % of the force range reach 3
inline constexpr double kDivergesAtOnce = 4;
inline constexpr SimDuration kIndicatorWindow = {1'000'000'000};
inline constexpr SimDuration kNetAlarmAfter = {200'000'000};

struct PortDefects {
  double e_x = 0;      // [m]
  double e_v = 0;      // [m/s]
  double e_F = 0;      // [N]
  double dE = 0;       // [J]
  double dE_star = 0;  // [J]
  double eta = 0;      // [-]
  double net = 0;      // [-]
  bool creates_energy = false;
};

[[nodiscard]] Lamp lamp_of(const PortDefects& defects) noexcept;

// Follows all ports of a session. It never feeds back into the physics, so it is no part of a state hash.
class Indicator {
 public:
  // least_force: by port [N], below which (7) does not judge; empty: 1 N. Allocates.
  Indicator(std::size_t ports, SimDuration communication_step, std::vector<double> least_force = {});

  // Both samples of the same step n >= 0; stiffness: of the oil columns [N/m], also of ports whose sample has none
  // because their spring is not inside the step (level tlm). No allocation.
  void update(const MechanismSample& mechanism, const ActuatorSample& actuators, const PortArray& stiffness,
              const PortLevels& levels) noexcept;
  void reset() noexcept;

  // The window and the last displayed values.
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

  [[nodiscard]] const PortDefects& port(std::size_t i) const noexcept { return defects_[i]; }
  [[nodiscard]] double omega_H() const noexcept { return omega_H_; }  // of the last update [-]
  [[nodiscard]] bool creates_energy() const noexcept;
  // sum |dE*| of the window over the port's own scale [-]
  [[nodiscard]] double own_residual(std::size_t port) const noexcept;
  // (7), by the full buckets, or at once by own_residual. No allocation.
  [[nodiscard]] bool diverges(std::size_t port) const noexcept;

 private:
  // sums over one bucket of the window
  struct Bucket {
    double residual = 0, net = 0, work = 0, force = 0, stiffness = 0;
    void add(const Bucket& other) noexcept {
      residual += other.residual;
      net += other.net;
      work += other.work;
      force = force < other.force ? other.force : force;
      stiffness = stiffness < other.stiffness ? other.stiffness : stiffness;
    }
  };
  static constexpr std::size_t kBuckets = 20;  // buckets of whole steps; the oldest is dropped as a whole
  static constexpr std::size_t kDivergingBuckets = kBuckets / 2;
  // buckets left out of the sum: each may contain one jump of a valve
  static constexpr std::size_t kLeftOut = 3;

  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  [[nodiscard]] bool diverges_in(const Bucket& bucket, std::size_t port) const noexcept;
  void start_bucket() noexcept;
  void add_others(std::size_t port) noexcept;
  [[nodiscard]] Bucket window_sum(std::size_t port) const noexcept;
  [[nodiscard]] double without_largest(std::size_t port, double sum) const noexcept;
  void evaluate(std::size_t port, Level level, double machine_scale) noexcept;

  std::size_t ports_;
  double H_;
  std::int64_t steps_per_bucket_;
  std::int64_t steps_in_bucket_ = 0;
  std::size_t current_ = 0;
  std::int64_t alarm_after_steps_;
  std::vector<double> least_force_;                    // N, by port
  std::vector<std::array<Bucket, kBuckets>> window_;   // by port
  std::vector<Bucket> others_;                         // by port, sums of the window without the current bucket
  std::vector<std::array<double, kLeftOut>> largest_;  // by port, residuals of others_, falling
  std::vector<std::size_t> diverging_buckets_;         // by port, number of the buckets of others_ that diverge
  std::vector<double> kinetic_;                        // J, by port, v^2 / (2 W); infinite: no force moves it
  std::vector<std::int64_t> steps_below_alarm_;        // by port
  std::vector<PortDefects> defects_;
  double omega_H_ = 0;
};

// omega_H at two exchanges per oscillation: the samples cannot distinguish a faster oscillation from a slower one.
inline constexpr double kMostSampled = std::numbers::pi;

// Largest omega_H at which a level is used without a warning (coupling study, sections 3, 4 and 10); zeta: damping
// ratio of the port. Level tlm has no limit: its cost is a parasitic mass K H^2.
[[nodiscard]] double omega_limit(Level level, double zeta) noexcept;

// H sqrt(largest eigenvalue of W K) by powers of the similar symmetric matrix, ports <= kMaxPorts.
// K_cross: as in ActuatorSample.
[[nodiscard]] double coupling_frequency(const PortMatrix& W, const PortArray& K, double H,
                                        const PortMatrix& K_cross = {}) noexcept;

}  // namespace slew::coupling
