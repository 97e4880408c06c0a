// SPDX-License-Identifier: Apache-2.0
#include "coupling/samples.h"

namespace slew::coupling {
namespace {

void zero(PortArray& values, std::size_t ports) {
  values.resize(ports);
  for (double& value : values) value = 0;
}

}  // namespace

void resize(MechanismSample& sample, std::size_t ports) {
  for (PortArray* values : {&sample.x, &sample.v, &sample.a, &sample.a_free, &sample.F_used, &sample.F_line,
                            &sample.work, &sample.impulse, &sample.v_mean}) {
    zero(*values, ports);
  }
  sample.W.resize(ports * ports);
  for (double& value : sample.W) value = 0;
}

void resize(ActuatorSample& sample, std::size_t ports) {
  for (PortArray* values :
       {&sample.F, &sample.F_dot, &sample.K, &sample.lambda, &sample.D, &sample.x_ref, &sample.v_ref,
        &sample.friction_scale, &sample.work, &sample.impulse, &sample.p_A, &sample.p_B, &sample.Q_A, &sample.Q_B}) {
    zero(*values, ports);
  }
  sample.K_cross.clear();
}

double spring_force(const ActuatorSample& sample, std::size_t port, std::span<const double> dx) noexcept {
  double force = sample.K[port] * dx[port];
  if (sample.K_cross.empty()) return force;
  const std::size_t m = sample.K.size();
  for (std::size_t j = 0; j < m; ++j) force += sample.K_cross[port * m + j] * dx[j];
  return force;
}

}  // namespace slew::coupling
