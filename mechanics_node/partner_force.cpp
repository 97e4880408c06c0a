// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/partner_force.h"

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
  return coupling::coupling_frequency(W, sample.K, static_cast<double>(age_) * H) > coupling::kDegradedAbove;
}

double PartnerForce::at_exchange(std::size_t port, const coupling::ActuatorSample& sample, double copy,
                                 double x) noexcept {
  if (!has_new_sample_) return copy;
  const bool is_hold = levels_[port] == coupling::Level::hold;
  const auto at = [&](double position) {
    return is_hold ? sample.F[port] : sample.F[port] - sample.K[port] * (position - sample.x_ref[port]);
  };
  if (age_ == 0) return at(x);
  if (!past_.has(used_step_)) return copy;
  const double correction = at(past_.first(used_step_, port)) - past_.second(used_step_, port);
  past_.correct(used_step_, port, 0, correction);
  return copy + correction;
}

coupling::RowPartner PartnerForce::linearisation(std::size_t port,
                                                 const coupling::ActuatorSample& sample) const noexcept {
  if (levels_[port] == coupling::Level::hold) return {};
  return {sample.F_dot[port], sample.K[port], sample.lambda[port], sample.D[port], sample.F[port], sample.v_ref[port]};
}

void PartnerForce::remember(StepIndex n, std::span<const double> x, std::span<const double> z) noexcept {
  if (is_free_running_) past_.keep(n, x, z);
}

}  // namespace slew::mechanics_node
