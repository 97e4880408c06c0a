#include "hydraulics/components/chamber_pair.h"

#include <utility>

namespace slew::hydraulics {
namespace {

// a chamber squeezed beyond its stop keeps this part of its largest volume, so that the equations stay defined
constexpr double kSmallestChamber = 1e-3;

}  // namespace

ChamberPair::ChamberPair(CircuitBuilder& builder, Actuator actuator, double span, double dead_volume,
                         double wall_modulus)
    : a_(actuator.port_a), b_(actuator.port_b), A_a_(actuator.area_a), A_b_(actuator.area_b) {
  actuator_ = builder.add_actuator(std::move(actuator));
  x_ = builder.position(actuator_);
  v_ = builder.speed(actuator_);
  const WallLaw wall{.factor = 0, .lowest = wall_modulus, .highest = wall_modulus};
  builder.add_content({.volume_index = a_,
                       .volume = dead_volume,
                       .slope = A_a_,
                       .position = x_,
                       .smallest = kSmallestChamber * A_a_ * span,
                       .wall = wall});
  builder.add_content({.volume_index = b_,
                       .volume = A_b_ * span + dead_volume,
                       .slope = -A_b_,
                       .position = x_,
                       .smallest = kSmallestChamber * A_b_ * span,
                       .wall = wall});
}

void ChamberPair::declare_dependencies(DependencyList& dependencies) const {
  dependencies.add_restriction(a_, b_);
  dependencies.add(a_, v_);
  dependencies.add(b_, v_);
}

double ChamberPair::leak(const CircuitView& view) const noexcept {
  return G_leak_ * (view[a_] - view[b_]);
}

double ChamberPair::pressure_force(const CircuitView& view) const noexcept {
  return view[a_] * A_a_ - view[b_] * A_b_;
}

void ChamberPair::add_rates(const CircuitView& view, Rates& rates) const noexcept {
  const double v = view[v_];
  rates.move(a_, b_, leak(view));
  // an extending piston takes oil from A and pushes oil out of B
  rates.add_flow(a_, -v * A_a_);
  rates.add_flow(b_, v * A_b_);
}

void ChamberPair::add_jacobian(JacobianStamp& jacobian) const noexcept {
  jacobian.move(a_, b_, a_, G_leak_);
  jacobian.move(a_, b_, b_, -G_leak_);
  jacobian.add(a_, v_, -A_a_);
  jacobian.add(b_, v_, A_b_);
}

}  // namespace slew::hydraulics
