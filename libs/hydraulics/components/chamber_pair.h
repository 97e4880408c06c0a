// The two chambers and the piston leak that the linear and the slew cylinder share; equations in their headers.
#pragma once

#include "hydraulics/circuit_builder.h"
#include "hydraulics/component.h"

namespace slew::hydraulics {

class ChamberPair {
 public:
  // span: V_B / A_B at x = 0, the piston's free way [m].
  ChamberPair(CircuitBuilder& builder, Actuator actuator, double span, double dead_volume, double wall_modulus);

  void set_leak(double G) noexcept { G_leak_ = G; }  // m3/s/Pa

  void declare_dependencies(DependencyList& dependencies) const;
  void add_rates(const CircuitView& view, Rates& rates) const noexcept;
  void add_jacobian(JacobianStamp& jacobian) const noexcept;

  [[nodiscard]] double pressure_force(const CircuitView& view) const noexcept;
  [[nodiscard]] double leak(const CircuitView& view) const noexcept;
  [[nodiscard]] StateIndex position() const noexcept { return x_; }
  [[nodiscard]] StateIndex speed() const noexcept { return v_; }
  [[nodiscard]] StateIndex port_a() const noexcept { return a_; }
  [[nodiscard]] StateIndex port_b() const noexcept { return b_; }
  [[nodiscard]] double area_a() const noexcept { return A_a_; }
  [[nodiscard]] double area_b() const noexcept { return A_b_; }
  [[nodiscard]] int actuator() const noexcept { return actuator_; }

 private:
  StateIndex a_, b_;
  double A_a_, A_b_;
  int actuator_;
  StateIndex x_, v_;
  double G_leak_ = 0;
};

}  // namespace slew::hydraulics
