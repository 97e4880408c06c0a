// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/stall.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics {
namespace {

constexpr double kStep = 10e-3;    // s, interval between two checks of the pressures
constexpr int kQuietSteps = 50;    // steps without a change: longer than the response of pumps and spools
constexpr double kUnchanged = 50;  // Pa per step
// a pressure that flows hold is back after a drain but for
constexpr double kLost = 2e-3;        // this share of it ...
constexpr double kLeastLost = 0.2e5;  // Pa ... or this, where it is more

struct Phase {
  double drain_time = std::numeric_limits<double>::infinity();  // s, T; infinite: no drain
  double longest = kLongestStall;                               // s
  double quiet_below = kUnchanged;                              // Pa per step: it ends when no pressure changes more
};
constexpr Phase kClosedPhase{};
constexpr Phase kFastDrainPhase{.drain_time = 1, .longest = 1, .quiet_below = 0};
constexpr Phase kClosedAgainPhase{.longest = 1, .quiet_below = 0};
// e^-8 of an excess is left
constexpr Phase kSlowDrainPhase{.drain_time = 10, .longest = 80, .quiet_below = 0};

class StallRun {
 public:
  StallRun(const HydraulicsDef& def, std::span<const double> x, const HeldControl& held)
      : circuit_(def), integrator_(circuit_, def), blocked_(x.size()) {
    const std::vector<double> zero(x.size());
    integrator_.start(x, zero, zero);
    if (held.control >= 0) circuit_.set_control(held.control, held.signal);
    start_ = pressures();
  }

  // Runs until the pressures are those that flows hold.
  Stall settle() {
    Stall closed = run(kClosedPhase);
    const std::vector<int> resting = resting_chambers();
    static_cast<void>(run(kFastDrainPhase));
    const Stall again = run(kClosedAgainPhase);
    const auto is_back = [&](int volume) {
      const double p = closed.pressures[at(volume)];
      return std::fabs(again.pressures[at(volume)] - p) <= std::max(kLeastLost, kLost * p);
    };
    if (std::all_of(resting.begin(), resting.end(), is_back)) return closed;
    Stall drained = run(kSlowDrainPhase);
    drained.is_steady = closed.is_steady;
    return drained;
  }

  // Whether a change of the volume's pressure goes back soon. The run then continues from where it was.
  bool restores(int volume, double change) {
    const std::vector<double> y(integrator_.state().begin(), integrator_.state().end());
    const double p = y[at(volume)];
    integrator_.mutable_state()[at(volume)] = p + change;
    bool is_back = false;
    for (double t = 0; t < kRestoredWithin && !is_back; t += kStep) {
      if (integrator_.step(kStep, blocked_).has_failed()) break;
      is_back = std::fabs(integrator_.state()[at(volume)] - p) < (1 - kRestoredShare) * std::fabs(change);
    }
    std::copy(y.begin(), y.end(), integrator_.mutable_state().begin());
    return is_back;
  }

  [[nodiscard]] double pressure(int volume) const {
    return circuit_.pressure(volume, integrator_.state().data()).value;
  }

 private:
  Stall run(const Phase& phase) {
    Stall stall;
    stall.pressures = pressures();
    last_change_.assign(stall.pressures.size(), 0);
    int quiet = 0;
    for (double t = 0; t < phase.longest && quiet < kQuietSteps; t += kStep) {
      if (std::isfinite(phase.drain_time)) drain(kStep / phase.drain_time);
      if (integrator_.step(kStep, blocked_).has_failed()) break;
      const std::vector<double> now = pressures();
      double largest = 0;
      for (std::size_t i = 0; i < now.size(); ++i) {
        last_change_[i] = std::fabs(now[i] - stall.pressures[i]);
        largest = std::max(largest, last_change_[i]);
      }
      stall.pressures = now;
      quiet = largest < phase.quiet_below ? quiet + 1 : 0;
    }
    stall.is_steady = quiet >= kQuietSteps;
    stall.forces.resize(at(circuit_.actuator_count()));
    circuit_.pressure_forces(integrator_.state().data(), stall.forces.data());
    return stall;
  }

  // Volumes of actuators whose pressures did not change in the last step.
  [[nodiscard]] std::vector<int> resting_chambers() const {
    std::vector<int> resting;
    for (const Actuator& actuator : circuit_.actuators()) {
      for (const int volume : {actuator.port_a, actuator.port_b}) {
        if (last_change_[at(volume)] < kUnchanged) resting.push_back(volume);
      }
    }
    return resting;
  }

  [[nodiscard]] std::vector<double> pressures() const {
    std::vector<double> now;
    for (int i = 0; i < circuit_.volume_count(); ++i) now.push_back(pressure(i));
    return now;
  }

  // Takes a share of each rise out of the volumes that store oil.
  void drain(double share) {
    const std::vector<StateIndex> algebraic(integrator_.quasi_static().begin(), integrator_.quasi_static().end());
    for (int i = 0; i < circuit_.volume_count(); ++i) {
      const bool has_storage = std::find(algebraic.begin(), algebraic.end(), i) == algebraic.end();
      const double rise = pressure(i) - start_[at(i)];
      if (!circuit_.is_fixed(i) && has_storage && rise > 0) integrator_.mutable_state()[at(i)] -= share * rise;
    }
  }

  Circuit circuit_;
  CircuitIntegrator integrator_;
  HeldSpeed blocked_;
  std::vector<double> start_;        // Pa absolute, by volume
  std::vector<double> last_change_;  // Pa, by volume: size, in the last step
};

}  // namespace

Stall find_stall(const HydraulicsDef& def, std::span<const double> x, const HeldControl& held) {
  return StallRun(def, x, held).settle();
}

std::vector<int> unheld_volumes(const HydraulicsDef& def, std::span<const double> x, const HeldControl& held,
                                std::span<const int> volumes) {
  std::vector<int> unheld;
  if (volumes.empty()) return unheld;
  StallRun stall(def, x, held);
  static_cast<void>(stall.settle());
  for (const int volume : volumes) {
    const double tenth = 0.1 * stall.pressure(volume);
    if (!stall.restores(volume, -tenth) && !stall.restores(volume, tenth + 1e5)) unheld.push_back(volume);
  }
  return unheld;
}

}  // namespace slew::hydraulics
