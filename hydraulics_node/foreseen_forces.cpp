// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/foreseen_forces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "math/relaxing_spring.h"

namespace slew::hydraulics_node {
namespace {

using coupling::kMaxPorts;

// of (1)
constexpr double kBends = 0.01;
constexpr double kSoftens = 0.8;  // of the stiffer spring
constexpr double kMostSwing = 2;  // of omega_H squared
constexpr double kClosed = 0.1;

constexpr double kBentFor = 0.2;  // s, half a swing of 2.5 Hz

// of lambda H: of a spring that relaxes faster the line of (2) and (3) would be steep at the begin alone
constexpr double kFastest = 2;
// of a lambda that (4) chooses: one in a micro-step of the mechanics, more within short steps
constexpr double kEarliest = 4000;      // 1/s
constexpr double kEarliestInStep = 20;  // of lambda H
constexpr double kResolved = 0.01;
constexpr double kFarBeyond = 0.03;  // share of the change of force

// Farthest change of a state with these derivatives within H.
double farthest_change(double rate, double bend, double H) noexcept {
  const double end = H * (rate + 0.5 * bend * H);
  const double turn = bend != 0 ? -rate / bend : 0;
  const double at_turn = turn > 0 && turn < H ? 0.5 * rate * turn : 0;
  return std::fabs(at_turn) > std::fabs(end) ? at_turn : end;
}

}  // namespace

ForeseenForces::ForeseenForces(const hydraulics::Circuit& circuit, bool is_free_running)
    : is_free_running_(is_free_running), ahead_(at(circuit.actuator_count())), y_(at(circuit.state_count())) {}

// (1)
bool ForeseenForces::is_bent(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                             const ReducedMechanics& mechanics, const coupling::PortLevels& levels, double H) noexcept {
  if (!mechanics.has_sample()) return false;
  const auto actuators = integrator.actuators();
  const std::span<const double> C = integrator.capacities(), f = integrator.rates();
  const std::size_t m = actuators.size();
  std::array<double, kMaxPorts> F{}, x{}, v{}, a{};
  for (std::size_t i = 0; i < m; ++i) F[i] = actuators[i].F, x[i] = actuators[i].x, v[i] = actuators[i].v;
  mechanics.free_accelerations(F.data(), x.data(), v.data(), a.data());
  std::copy(integrator.state().begin(), integrator.state().end(), y_.begin());
  for (std::size_t i = 0; i < m; ++i) {
    if (!coupling::is_balanced(levels[i])) continue;
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t c = at(circuit.actuators()[i].volume(side));
      if (!(C[c] > 0) || actuators[i].springs[side].lambda * H > kClosed) continue;
      const double s = circuit.actuators()[i].signed_area(side, y_.data()), u = y_[c];
      y_[c] = u + farthest_change(f[c], -s * a[i] / C[c], H);
      const double ahead = circuit.capacity_at(c, y_.data());
      y_[c] = u;
      const double change = std::fabs(1 / ahead - 1 / C[c]), stiffer = std::max(1 / ahead, 1 / C[c]);
      const double per_capacity = mechanics.W(i, i) * H * H * s * s;
      if (change > kSoftens * stiffer && per_capacity * change > kBends) return true;
    }
  }
  return false;
}

bool ForeseenForces::is_fast(const hydraulics::CircuitIntegrator& integrator, const ReducedMechanics& mechanics,
                             double H) noexcept {
  if (!mechanics.has_sample()) return false;
  const auto actuators = integrator.actuators();
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    if (mechanics.W(i, i) * H * H * actuators[i].stiffness > kMostSwing) return true;
  }
  return false;
}

void ForeseenForces::follow(const hydraulics::CircuitIntegrator& integrator, const hydraulics::Circuit& circuit,
                            const ReducedMechanics& mechanics, const coupling::PortLevels& levels, double H) noexcept {
  bent_for_ = is_bent(integrator, circuit, mechanics, levels, H) ? kBentFor : std::max(0.0, bent_for_ - H);
  fast_for_ = is_fast(integrator, mechanics, H) ? kBentFor : std::max(0.0, fast_for_ - H);
}

bool ForeseenForces::foresee(hydraulics::CircuitIntegrator& integrator, const ReducedMechanics& mechanics,
                             const coupling::PortLevels& levels, double H,
                             std::span<hydraulics::ActuatorSprings> springs) noexcept {
  if (!bends() || fast_for_ > 0 || is_free_running_) return false;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    if (levels[i] != coupling::Level::two) return false;
  }
  if (!integrator.foresee(H, mechanics, ahead_)) return false;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    for (const std::size_t side : {0u, 1u}) {
      math::RelaxingSpring& spring = springs[i][side];
      const double at_instant = integrator.actuators()[i].springs[side].K, mean = ahead_.actuators[i].K[side];
      spring.K = at_instant > 0 ? spring.K * (mean / at_instant) : mean;
    }
  }
  return true;
}

// (2), (3)
ForeseenForces::Line ForeseenForces::line(std::size_t port, double lambda, double H,
                                          const coupling::ActuatorSample& sample) const noexcept {
  const std::size_t m = ahead_.actuators.size();
  std::array<double, kMaxPorts> r{}, way{}, moment{};
  for (std::size_t j = 0; j < m; ++j) {
    if (j != port && sample.K_cross.empty()) continue;
    const hydraulics::SpringWay of_j = ahead_.way(j, lambda);
    r[j] = of_j.r, way[j] = of_j.way, moment[j] = of_j.moment;
  }
  const auto by_springs = [&](const std::array<double, kMaxPorts>& s) {
    return coupling::spring_force(sample, port, {s.data(), m});
  };
  const math::DecayedIntegrals phi = math::decayed_integrals(lambda * H);
  const double mean = (ahead_.actuators[port].impulse + by_springs(way)) / H;
  const double early = 2 * (ahead_.actuators[port].moment + by_springs(moment)) / (H * H);
  Line line;
  line.F_dot = (mean - early) / (H * (phi.phi_2 - 2 * phi.phi_3));
  line.F = mean - line.F_dot * H * phi.phi_2;
  line.beyond = line.F + line.F_dot * H * phi.phi_1 - by_springs(r) - ahead_.actuators[port].end;
  return line;
}

void ForeseenForces::set_forces(double H, coupling::ActuatorSample& sample) const noexcept {
  const std::size_t m = ahead_.actuators.size();
  for (std::size_t i = 0; i < m; ++i) {
    double slow = sample.lambda[i] * H;
    if (slow > kFastest) {
      // with the integral of its answer
      const double share = math::decayed_integrals(slow).phi_2 / math::decayed_integrals(kFastest).phi_2;
      sample.K[i] *= share;
      for (std::size_t j = 0; j < m && !sample.K_cross.empty(); ++j) sample.K_cross[i * m + j] *= share;
      slow = kFastest;
    }
    const Line slowest = line(i, slow / H, H, sample);
    Line chosen = slowest;
    // matrices of shared volumes have their lambda already
    const double change =
        std::max(std::fabs(ahead_.actuators[i].end - sample.F[i]), std::fabs(slowest.F - sample.F[i]));
    if (sample.K_cross.empty() && std::fabs(slowest.beyond) > kFarBeyond * change) {
      double fast = std::max(kEarliest * H, kEarliestInStep);
      if (fast > slow && line(i, fast / H, H, sample).beyond * slowest.beyond < 0) {
        while (fast - slow > kResolved * fast) {
          const double middle = 0.5 * (slow + fast);
          chosen = line(i, middle / H, H, sample);
          (chosen.beyond * slowest.beyond > 0 ? slow : fast) = middle;
        }
        slow = 0.5 * (slow + fast);
        chosen = line(i, slow / H, H, sample);
      }
    }
    sample.lambda[i] = slow / H;
    sample.F[i] = chosen.F;
    sample.F_dot[i] = chosen.F_dot;
  }
}

}  // namespace slew::hydraulics_node
