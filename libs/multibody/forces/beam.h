// SPDX-License-Identifier: Apache-2.0
// A massless beam between a frame on one body (its near end) and a frame on another (its far end), x along the beam.
//
// x of frame_pair.h with d_0 = [l 0 0]: the far end seen from the near end. With the transverse shear numbers
//   phi_y = 12 E Izz/(k_y G A l^2),   phi_z = 12 E Iyy/(k_z G A l^2)        (0 without shear)          (1)
// the far end carries Q = -K x - beta K x', and K, symmetric, has the entries
//   K11 = E A/l                       K44 = G J/l
//   K22 = 12 E Izz/(l^3 (1+phi_y))    K26 = -6 E Izz/(l^2 (1+phi_y))    K66 = (4+phi_y) E Izz/(l (1+phi_y))
//   K33 = 12 E Iyy/(l^3 (1+phi_z))    K35 = +6 E Iyy/(l^2 (1+phi_z))    K55 = (4+phi_z) E Iyy/(l (1+phi_z))   (2)
// The wrench on the near end balances the far end's (frame_pair.h): F_ji = -F_ij, T_ji = -T_ij - l x F_ij.
//
// Source: the flexible-body tutorial thesis (2017), eq. 28 to 33, after Sopanen 2004 and Przemieniecki 1968.
// Deviations (its misprints): signs of K26 and K35 for a far end, phi_y goes with Izz, D = beta K with beta in seconds.
// Rotations by the rotation vector instead of small angles. Not covered: mass of the beam (give it to the bodies),
// warping, geometric stiffness inside of one segment (use several). Card: docs/models/multibody_beam.md.
#pragma once

#include <string>
#include <vector>

#include "multibody/forces/connector.h"

namespace slew::multibody {

struct BeamDef {
  std::string name{};
  ConnectorFrames frames{};   // x along the beam; frame 1 at its near end
  double length = 0;          // m, without load
  double youngs_modulus = 0;  // Pa
  double shear_modulus = 0;   // Pa; 0: from poisson_ratio
  double poisson_ratio = 0.3;
  double area = 0;              // m2
  double second_moment_y = 0;   // m4, bending in the x-z plane
  double second_moment_z = 0;   // m4, bending in the x-y plane
  double torsion_constant = 0;  // m4
  double shear_factor_y = 0;    // share of the area that carries shear along y; 0: no shear deformation
  double shear_factor_z = 0;
  double damping_time = 0;  // s, damping matrix over stiffness matrix
};

// The entries of (2) that are not zero [N/m, N, N m/rad].
struct BeamStiffness {
  double k11 = 0, k22 = 0, k33 = 0, k44 = 0, k55 = 0, k66 = 0;
  double k26 = 0, k35 = 0;
};

struct BeamSection {
  double length = 0;            // l [m], > 0
  double youngs_modulus = 0;    // E [Pa]
  double shear_modulus = 0;     // G [Pa]
  double area = 0;              // A [m2]
  double second_moment_y = 0;   // Iyy [m4]: bending in the x-z plane
  double second_moment_z = 0;   // Izz [m4]: bending in the x-y plane
  double torsion_constant = 0;  // J [m4]
  double shear_factor_y = 0;    // k_y; 0: no shear deformation along y
  double shear_factor_z = 0;    // k_z
};

[[nodiscard]] BeamStiffness stiffness_of(const BeamSection& section) noexcept;

struct Beam {
  std::string name;
  FramePair frames;
  BeamStiffness K;
  double damping_time = 0;  // beta [s]
};

[[nodiscard]] Six force_of(const Beam& beam, const Deflection& deflection) noexcept;
// (position + rate beta) K.
[[nodiscard]] SixBySix slopes_of(const Beam& beam, const Deflection& deflection, ChangeWeights weights) noexcept;
[[nodiscard]] double stored_energy(const Beam& beam, const Deflection& deflection) noexcept;  // x^T K x/2 [J]
[[nodiscard]] WrenchPair wrenches_of(const Beam& beam, const LinkMotion& link1, const LinkMotion& link2) noexcept;

[[nodiscard]] std::span<const Field> beam_fields() noexcept;

struct BeamRow : ConnectorRow<Beam> {
  struct Defs {
    std::vector<BeamDef> beams;
  };
  struct Elements {
    std::vector<Beam> beams;  // of the scene, then those between the segments of bodies
  };
  static constexpr auto kElements = &Elements::beams;
  static constexpr std::tuple kTypes{
      ForceType{"forces", "beam", "massless elastic beam between two frames", beam_fields, &Defs::beams}};

  static Beam build(const BeamDef& def, ElementBuilder& builder);
  static void check(const BeamDef& def, ElementRules& rules);
  static void check_start(const BeamDef& def, ElementStartRules& rules);
  static void silence(Beam& beam);
  static std::span<const std::string_view> value_keys(const Beam& beam) noexcept;
  static double* value(Beam& beam, std::size_t /*index*/) noexcept { return &beam.damping_time; }
};

}  // namespace slew::multibody
