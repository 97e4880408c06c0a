#include "multibody/forces/beam.h"

namespace slew::multibody {
namespace {

Six times(const BeamStiffness& K, const Six& x) noexcept {
  return {K.k11 * x[0], K.k22 * x[1] + K.k26 * x[5], K.k33 * x[2] + K.k35 * x[4],
          K.k44 * x[3], K.k35 * x[2] + K.k55 * x[4], K.k26 * x[1] + K.k66 * x[5]};
}

// (1): bending E I against shear k G A
double shear_number(double bending, double factor, const BeamSection& s) noexcept {
  return factor > 0 ? 12 * bending / (factor * s.shear_modulus * s.area * s.length * s.length) : 0.0;
}

}  // namespace

BeamStiffness stiffness_of(const BeamSection& s) noexcept {
  const double l = s.length;
  const double EIy = s.youngs_modulus * s.second_moment_y, EIz = s.youngs_modulus * s.second_moment_z;
  const double phi_y = shear_number(EIz, s.shear_factor_y, s), phi_z = shear_number(EIy, s.shear_factor_z, s);
  return {.k11 = s.youngs_modulus * s.area / l,
          .k22 = 12 * EIz / (l * l * l * (1 + phi_y)),
          .k33 = 12 * EIy / (l * l * l * (1 + phi_z)),
          .k44 = s.shear_modulus * s.torsion_constant / l,
          .k55 = (4 + phi_z) * EIy / (l * (1 + phi_z)),
          .k66 = (4 + phi_y) * EIz / (l * (1 + phi_y)),
          .k26 = -6 * EIz / (l * l * (1 + phi_y)),
          .k35 = 6 * EIy / (l * l * (1 + phi_z))};
}

Six force_of(const Beam& beam, const Deflection& deflection) noexcept {
  Six strained;
  for (std::size_t i = 0; i < 6; ++i) strained[i] = -deflection.x[i] - beam.damping_time * deflection.rate[i];
  return times(beam.K, strained);
}

SixBySix slopes_of(const Beam& beam, ChangeWeights weights) noexcept {
  const double weight = weights.position + weights.rate * beam.damping_time;
  SixBySix A{};
  for (std::size_t j = 0; j < 6; ++j) {
    Six unit{};
    unit[j] = weight;
    const Six column = times(beam.K, unit);
    for (std::size_t i = 0; i < 6; ++i) A[6 * i + j] = column[i];
  }
  return A;
}

double stored_energy(const Beam& beam, const Deflection& deflection) noexcept {
  const Six Kx = times(beam.K, deflection.x);
  double energy = 0;
  for (std::size_t i = 0; i < 6; ++i) energy += 0.5 * deflection.x[i] * Kx[i];
  return energy;
}

WrenchPair wrenches_of(const Beam& beam, const LinkMotion& link1, const LinkMotion& link2) noexcept {
  const Deflection deflection = deflection_of(beam.frames, link1, link2);
  return wrenches_of(deflection, force_of(beam, deflection), link1, link2);
}

}  // namespace slew::multibody
