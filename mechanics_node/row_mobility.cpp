// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/row_mobility.h"

#include <cmath>
#include <utility>

namespace slew::mechanics_node {
namespace {

using multibody::Integrator;

// Change of W over an interval, in units of sqrt(W_ii W_jj): an error of a tenth in W is far inside of what level two
// tolerates (coupling study, section 3), and rows over an interval cost a factorisation each.
constexpr double kSignificantChange = 0.1;
// Change from which on springs behind rows of rk4 answer in its stages: omega h of 0.14, where a held row that is late
// feeds an undamped swing with 4e-6 a sub-step.
constexpr double kAnsweringChange = 0.01;

// Implicit sub-steps do not resolve the springs behind the rows.
bool takes_long_substeps(Integrator integrator) noexcept {
  return multibody::is_implicit(integrator) || integrator == Integrator::index3_trapezoidal;
}

// How the integrator answers a force that is held over a sub-step. generalised_alpha: the trapezoidal rule, apart from
// the accelerations that it carries along. sdirk2: to second order; motion much faster than the sub-step stops at its
// end.
multibody::StepShares shares_of(Integrator integrator) noexcept {
  switch (integrator) {
    case Integrator::trapezoidal:
    case Integrator::generalised_alpha:
    case Integrator::index3_trapezoidal:
      return multibody::kTrapezoidalShares;
    case Integrator::sdirk2:
      return {.position = 0.5, .rate = 1, .strain = 0.5};
    default:
      return {};
  }
}

}  // namespace

RowMobility::RowMobility(Mechanism& mechanism, std::size_t ports, double exchange_interval, double substep)
    : mechanism_(mechanism), exchange_interval_(exchange_interval) {
  const Integrator integrator = multibody::step_rule(mechanism.def()).integrator;
  substep_shares_ = shares_of(integrator);
  const multibody::Model& model = mechanism.model();
  if (model.rows.empty() || !multibody::has_springs(model)) return;
  auto step_rows = std::make_unique<multibody::StepRows>(model);
  mechanism.evaluate();
  const auto varies = [&](std::size_t count, double h, double change = kSignificantChange,
                          multibody::StepShares shares = {}) {
    return step_rows->evaluate(model, mechanism.state(), mechanism.workspace(), h, shares) &&
           differs(count, change, step_rows->mobility());
  };
  varies_over_exchange_ = ports > 0 && varies(ports, exchange_interval);
  varies_over_substep_ =
      takes_long_substeps(integrator) && (varies_over_exchange_ || varies(model.rows.size(), substep));
  constexpr multibody::StepShares kSpringsAlone{.position = 0.5, .rate = 0, .strain = 1};
  springs_answer_ = integrator == Integrator::rk4 &&
                    (!model.parts.empty() || varies(model.rows.size(), substep, kAnsweringChange, kSpringsAlone));
  mechanism.mark_changed();
  if (varies_over_exchange_ || varies_over_substep_ || model.contact != nullptr) step_rows_ = std::move(step_rows);
}

// Compares the first `count` rows.
bool RowMobility::differs(std::size_t count, double change, std::span<const double> W_h) const noexcept {
  const std::span<const double> W = multibody::row_mobility(mechanism_.workspace());
  const std::size_t rows = mechanism_.row_count();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const double scale = std::sqrt(W[i * rows + i] * W[j * rows + j]);
      if (std::fabs(W_h[i * rows + j] - W[i * rows + j]) > change * scale) return true;
    }
  }
  return false;
}

Rows RowMobility::at_instant() const noexcept {
  const multibody::Workspace& workspace = mechanism_.workspace();
  return {multibody::row_free_accelerations(workspace), multibody::row_mobility(workspace)};
}

Rows RowMobility::over(double h, multibody::StepShares shares) noexcept {
  if (step_rows_ == nullptr ||
      !step_rows_->evaluate(mechanism_.model(), mechanism_.state(), mechanism_.workspace(), h, shares)) {
    return at_instant();
  }
  return {step_rows_->free_accelerations(), step_rows_->mobility(), coupling::MobilityKind::step};
}

Rows RowMobility::over_exchange() noexcept {
  const bool takes_interval = varies_over_exchange_ || mechanism_.has_active_contact();
  return takes_interval ? over(exchange_interval_, {}) : at_instant();
}

Rows RowMobility::over_substep(double h) noexcept {
  const bool takes_interval = varies_over_substep_ || mechanism_.has_active_contact();
  return takes_interval ? over(h, substep_shares_) : at_instant();
}

}  // namespace slew::mechanics_node
