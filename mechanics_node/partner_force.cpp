// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/partner_force.h"

#include <array>

#include "coupling/indicator.h"
#include "scene/ports.h"

namespace slew::mechanics_node {

PartnerForce::PartnerForce(const scene::Scene& scene)
    : levels_(scene::port_levels(scene)),
      is_free_running_(scene.session.mode == scene::ExchangeMode::free_running),
      past_(scene.ports.size()) {}

void PartnerForce::reset() noexcept {
  levels_.reset();
  past_.clear();
  used_step_ = -1;
  age_ = 0;
}

void PartnerForce::receive(StepIndex n, StepIndex age) noexcept {
  age_ = age;
  has_new_sample_ = n - age != used_step_;
  used_step_ = n - age;
}

bool PartnerForce::is_too_old(const coupling::PortMatrix& W, const coupling::ActuatorSample& sample,
                              double H) const noexcept {
  if (!is_free_running_ || age_ == 0) return false;
  return coupling::coupling_frequency(W, sample.K, static_cast<double>(age_) * H, sample.K_cross) >
         coupling::kDegradedAbove;
}

double PartnerForce::at_exchange(std::size_t port, const coupling::ActuatorSample& sample, double copy,
                                 std::span<const double> x) noexcept {
  if (!has_new_sample_) return copy;
  if (age_ > 0 && !past_.has(used_step_)) return copy;
  double F = sample.F[port];
  if (levels_[port] != coupling::Level::hold) {
    std::array<double, coupling::kMaxPorts> dx;
    for (std::size_t i = 0; i < x.size(); ++i) {
      dx[i] = (age_ == 0 ? x[i] : past_.first(used_step_, i)) - sample.x_ref[i];
    }
    F -= coupling::spring_force(sample, port, dx);
  }
  if (age_ == 0) return F;
  const double correction = F - past_.second(used_step_, port);
  past_.correct(used_step_, port, 0, correction);
  return copy + correction;
}

coupling::RowPartner PartnerForce::linearisation(std::size_t port,
                                                 const coupling::ActuatorSample& sample) const noexcept {
  if (levels_[port] == coupling::Level::hold) return {.v_ref = sample.v_ref[port]};
  return {sample.F_dot[port], sample.K[port], sample.lambda[port], sample.D[port], sample.F[port], sample.v_ref[port]};
}

void PartnerForce::remember(StepIndex n, std::span<const double> x, std::span<const double> z) noexcept {
  if (is_free_running_) past_.keep(n, x, z);
}

}  // namespace slew::mechanics_node
