// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/stall.h"

#include <algorithm>
#include <cmath>

#include "hydraulics/circuit.h"
#include "hydraulics/circuit_integrator.h"

namespace slew::hydraulics {
namespace {

constexpr double kStep = 10e-3;    // s, interval between two checks of the pressures
constexpr int kQuietSteps = 50;    // steps without a change: longer than the response of pumps and spools
constexpr double kUnchanged = 50;  // Pa per step

}  // namespace

Stall find_stall(const HydraulicsDef& def, std::span<const double> x, const HeldControl& held) {
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const auto volumes = static_cast<std::size_t>(circuit.volume_count());
  const std::size_t m = x.size();
  const std::vector<double> zero(m);
  integrator.start(x, zero, zero);
  if (held.control >= 0) circuit.set_control(held.control, held.signal);
  const HeldSpeed blocked(m);
  Stall stall;
  const auto pressure = [&](std::size_t i) {
    return circuit.pressure(static_cast<int>(i), integrator.state().data()).value;
  };
  for (std::size_t i = 0; i < volumes; ++i) stall.pressures.push_back(pressure(i));
  int quiet = 0;
  for (double t = 0; t < kLongestStall && quiet < kQuietSteps; t += kStep) {
    if (integrator.step(kStep, blocked).has_failed()) break;
    double change = 0;
    for (std::size_t i = 0; i < volumes; ++i) {
      change = std::max(change, std::fabs(pressure(i) - stall.pressures[i]));
      stall.pressures[i] = pressure(i);
    }
    quiet = change < kUnchanged ? quiet + 1 : 0;
  }
  stall.is_steady = quiet >= kQuietSteps;
  stall.forces.resize(m);
  circuit.pressure_forces(integrator.state().data(), stall.forces.data());
  return stall;
}

}  // namespace slew::hydraulics
