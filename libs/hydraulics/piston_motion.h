// SPDX-License-Identifier: Apache-2.0
// The interface by which a partner's model of the mechanics moves the pistons inside the circuit's integration.
//
// The circuit integrates x' = v, v' = a(F, x, v) together with its pressures, F = p_A A_A - p_B A_B per actuator. A
// subsystem implements a(...) by its model of the partner, e.g. the reduced model a_free + W F_line(F, x, v) with
// friction and end stops inside (slopes up to 4e4 1/s are handled), or zero (held speed).
// Plain arrays in actuator order; matrices m x m, row-major. Nothing here may allocate, lock or throw.
#pragma once

#include <cstddef>
#include <limits>

namespace slew::hydraulics {

class PistonMotion {
 public:
  virtual ~PistonMotion() = default;
  // a [m/s2] from F [N], x [m], v [m/s].
  virtual void accelerations(const double* F, const double* x, const double* v, double* a) const noexcept = 0;
  // da/dF [1/kg], da/dx [1/s2], da/dv [1/s]; every element is written.
  virtual void slopes(const double* F, const double* x, const double* v, double* da_dF, double* da_dx,
                      double* da_dv) const noexcept = 0;
  // Time [s] to the edge of the steep part of a piston's friction about rest, from speeds v, accelerations a and their
  // rates j [m/s3]: first to just before the edge, from there to just behind it.
  [[nodiscard]] virtual double time_to_rest(const double* /*v*/, const double* /*a*/,
                                            const double* /*j*/) const noexcept {
    return std::numeric_limits<double>::infinity();
  }
};

// Pistons with held speed, for test rigs.
class HeldSpeed final : public PistonMotion {
 public:
  explicit HeldSpeed(std::size_t actuators) noexcept : m_(actuators) {}
  void accelerations(const double*, const double*, const double*, double* a) const noexcept override {
    for (std::size_t i = 0; i < m_; ++i) a[i] = 0;
  }
  void slopes(const double*, const double*, const double*, double* da_dF, double* da_dx,
              double* da_dv) const noexcept override {
    for (std::size_t i = 0; i < m_ * m_; ++i) da_dF[i] = da_dx[i] = da_dv[i] = 0;
  }

 private:
  std::size_t m_;
};

}  // namespace slew::hydraulics
