// SPDX-License-Identifier: Apache-2.0
#include "mechanics_node/timed_loads.h"

#include <algorithm>

namespace slew::mechanics_node {
namespace {

// Drives change coordinates by time alone as well: then the motion at the start does not hold later.
bool has_timed_loads(const multibody::Model& model) noexcept {
  const auto& loads = model.elements.loads;
  const bool has_tables =
      std::any_of(loads.begin(), loads.end(), [](const multibody::PointLoad& load) { return !load.table.empty(); });
  return has_tables && model.drives.empty() && !model.rows.empty();
}

}  // namespace

TimedLoads::TimedLoads(const Mechanism& mechanism)
    : exist_(has_timed_loads(mechanism.model())),
      begin_(mechanism.row_count()),
      middle_(mechanism.row_count()),
      end_(mechanism.row_count()) {
  const multibody::Integrator integrator = multibody::step_rule(mechanism.def()).integrator;
  has_course_ = exist_ && integrator != multibody::Integrator::semi_implicit_euler;
  is_rk4_ = integrator == multibody::Integrator::rk4;
}

void TimedLoads::look_ahead(Mechanism& mechanism, double h) noexcept {
  if (!exist_) return;
  const double now = mechanism.state().time;
  mechanism.free_accelerations_at(now + 0.5 * h, middle_);
  mechanism.free_accelerations_at(now + h, end_);
  mechanism.evaluate();
  const std::vector<double>& a_free = mechanism.workspace().row_a_free;
  std::copy(a_free.begin(), a_free.end(), begin_.begin());
}

// A straight line through the integrator's quadrature of the change.
TimedLoads::Course TimedLoads::course_of(std::size_t row, double a_free, double h) const noexcept {
  const double middle = middle_[row] - a_free, end = end_[row] - a_free;
  const double mean = is_rk4_ ? (4 * middle + end) / 6 : 0.5 * end;
  return {mean - 0.5 * end, end / h};
}

}  // namespace slew::mechanics_node
