// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/late_samples.h"

#include <algorithm>
#include <array>

namespace slew::hydraulics_node {

using coupling::kMaxPorts;

LateSamples::LateSamples(std::size_t ports, std::size_t cross, std::size_t remembered)
    : ports_(ports), cross_(cross), past_(ports), sent_(remembered) {}

void LateSamples::clear() noexcept {
  past_.clear();
  std::fill(sent_.begin(), sent_.end(), SentSample{});
}

void LateSamples::keep_pistons(StepIndex n, const hydraulics::Circuit& circuit,
                               const hydraulics::CircuitIntegrator& integrator) noexcept {
  std::array<double, kMaxPorts> x{}, v{};
  for (std::size_t i = 0; i < ports_; ++i) {
    const int port = static_cast<int>(i);
    x[i] = integrator.state()[static_cast<std::size_t>(circuit.position(port))];
    v[i] = integrator.state()[static_cast<std::size_t>(circuit.speed(port))];
  }
  past_.keep(n, {x.data(), ports_}, {v.data(), ports_});
}

void LateSamples::keep_sent(StepIndex n, const coupling::ActuatorSample& sample) noexcept {
  SentSample& sent = sent_[static_cast<std::size_t>(n) % sent_.size()];
  sent.step = n;
  sent.sample = sample;
  sent.displacement.resize(ports_);
  for (std::size_t i = 0; i < ports_; ++i) sent.displacement[i] = sample.x_ref[i] - past_.first(n - 1, i);
}

void LateSamples::align(StepIndex step, const coupling::MechanismSample& mechanism,
                        hydraulics::CircuitIntegrator& integrator) noexcept {
  if (!past_.has(step)) return;
  std::array<double, kMaxPorts> x{}, v{};
  for (std::size_t i = 0; i < ports_; ++i) {
    const double dx = mechanism.x[i] - past_.first(step, i);
    const double dv = mechanism.v[i] - past_.second(step, i);
    past_.correct(step, i, dx, dv);
    x[i] = integrator.actuators()[i].x + dx;
    v[i] = integrator.actuators()[i].v + dv;
  }
  integrator.align({x.data(), ports_}, {v.data(), ports_});
}

bool LateSamples::own_sample(StepIndex step, const coupling::MechanismSample& mechanism, double H,
                             coupling::ActuatorSample& own) const noexcept {
  if (!past_.has(step)) return false;
  const SentSample& sent = sent_[static_cast<std::size_t>(step) % sent_.size()];
  if (sent.step != step) return false;
  own = sent.sample;
  for (std::size_t i = 0; i < ports_; ++i) {
    own.x_ref[i] = mechanism.x[i] - (mechanism.v_mean[i] * H - sent.displacement[i]);
  }
  return true;
}

}  // namespace slew::hydraulics_node
