// SPDX-License-Identifier: Apache-2.0
#include "hydraulics_node/reduced_mechanics.h"

#include <algorithm>
#include <array>
#include <limits>

namespace slew::hydraulics_node {

using coupling::kMaxPorts;

coupling::LineForce ReducedMechanics::line_force(std::size_t port, double F, double x, double v) const noexcept {
  if (ports_[port].level != coupling::Level::tlm) return laws_[port].evaluate(F, x, v);
  coupling::LineForce line = laws_[port].evaluate(ports_[port].thrust, x, v);
  line.d_pressure = 0;
  return line;
}

void ReducedMechanics::free_accelerations(const double* F, const double* x, const double* v, double* a) const noexcept {
  const std::size_t m = laws_.size();
  std::array<double, kMaxPorts> line{};
  for (std::size_t j = 0; j < m; ++j) line[j] = line_force(j, F[j], x[j], v[j]).force;
  for (std::size_t i = 0; i < m; ++i) {
    double sum = a_free_[i];
    for (std::size_t j = 0; j < m; ++j) sum += W_[i * m + j] * line[j];
    a[i] = sum;
  }
}

void ReducedMechanics::accelerations(const double* F, const double* x, const double* v, double* a) const noexcept {
  free_accelerations(F, x, v, a);
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    if (ports_[i].level != coupling::Level::two) a[i] = 0;
  }
}

double ReducedMechanics::time_to_rest(const double* v, const double* a, const double* j) const noexcept {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < laws_.size(); ++i) shortest = std::min(shortest, laws_[i].time_to_rest(v[i], a[i], j[i]));
  return shortest;
}

void ReducedMechanics::slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
                              double* da_dv) const noexcept {
  const std::size_t m = laws_.size();
  for (std::size_t j = 0; j < m; ++j) {
    const coupling::LineForce line = line_force(j, F[j], x[j], v[j]);
    for (std::size_t i = 0; i < m; ++i) {
      const double w = ports_[i].level == coupling::Level::two ? W_[i * m + j] : 0.0;
      da_dF[i * m + j] = w * line.d_pressure;
      da_dx[i * m + j] = w * line.d_position;
      da_dv[i * m + j] = w * line.d_speed;
    }
  }
}

}  // namespace slew::hydraulics_node
