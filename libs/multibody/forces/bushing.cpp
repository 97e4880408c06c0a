#include "multibody/forces/bushing.h"

#include <algorithm>

namespace slew::multibody {
namespace {

// row i of a full matrix times a column
double row_times(const SixBySix& matrix, std::size_t i, const Six& x) noexcept {
  double sum = 0;
  for (std::size_t j = 0; j < 6; ++j) sum += matrix[6 * i + j] * x[j];
  return sum;
}

}  // namespace

Six force_of(const Bushing& bushing, const Deflection& deflection) noexcept {
  Six Q;
  for (std::size_t i = 0; i < 6; ++i) {
    Q[i] = bushing.preload[i] - bushing.spring[i] * deflection.x[i] - bushing.damping[i] * deflection.rate[i];
  }
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < 6; ++i) {
      Q[i] -= row_times(bushing.K, i, deflection.x) + row_times(bushing.D, i, deflection.rate);
    }
  }
  for (const DirectionCurve& own : bushing.curves) {
    const auto i = static_cast<std::size_t>(own.direction);
    Q[i] -= math::value_at(own.curve, own.is_damper ? deflection.rate[i] : deflection.x[i]);
  }
  return Q;
}

SixBySix slopes_of(const Bushing& bushing, const Deflection& deflection, ChangeWeights weights) noexcept {
  SixBySix A{};
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < A.size(); ++i) A[i] = weights.position * bushing.K[i] + weights.rate * bushing.D[i];
  }
  for (std::size_t i = 0; i < 6; ++i) {
    A[7 * i] += weights.position * bushing.spring[i] + weights.rate * bushing.damping[i];
  }
  for (const DirectionCurve& own : bushing.curves) {
    const auto i = static_cast<std::size_t>(own.direction);
    const double slope = math::slope_at(own.curve, own.is_damper ? deflection.rate[i] : deflection.x[i]);
    A[7 * i] += (own.is_damper ? weights.rate : weights.position) * std::max(0.0, slope);
  }
  return A;
}

double stored_energy(const Bushing& bushing, const Deflection& deflection) noexcept {
  const Six& x = deflection.x;
  double energy = 0;
  for (std::size_t i = 0; i < 6; ++i) energy += x[i] * (0.5 * bushing.spring[i] * x[i] - bushing.preload[i]);
  if (bushing.has_coupling) {
    for (std::size_t i = 0; i < 6; ++i) energy += 0.5 * x[i] * row_times(bushing.K, i, x);
  }
  for (const DirectionCurve& own : bushing.curves) {
    if (!own.is_damper) energy += math::integral_to(own.curve, x[static_cast<std::size_t>(own.direction)]);
  }
  return energy;
}

WrenchPair wrenches_of(const Bushing& bushing, const LinkMotion& link1, const LinkMotion& link2) noexcept {
  const Deflection deflection = deflection_of(bushing.frames, link1, link2);
  return wrenches_of(deflection, force_of(bushing, deflection), link1, link2);
}

}  // namespace slew::multibody
