// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/beam.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "multibody/forces/build_elements.h"
#include "multibody/forces/force_fields.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

// frames farther off at the start than this are a mistake and no load
constexpr double kMostBending = 0.2;    // of the length
constexpr double kMostBentAngle = 0.5;  // rad

constexpr Range kPoissonRange{.min = -1, .max = 0.5, .max_is_open = false};
constexpr Range kShearFactorRange{.min = 0, .max = 1, .min_is_open = false, .max_is_open = false};

template <auto Member>
constexpr Field beam_number(std::string_view key, Dimension dimension, std::string_view doc) {
  return field<Member>(key, {.dimension = dimension, .range = kPositive, .presence = Presence::required, .doc = doc});
}

constexpr ReadBy kReadByNoShearModulus[] = {{"shear_modulus", "no shear_modulus", [](const void* def) noexcept {
                                               return !(static_cast<const BeamDef*>(def)->shear_modulus > 0);
                                             }}};

constexpr Field kBeamFields[] = {
    connector_body<&BeamDef::frames, &ConnectorFrames::body1>("body1", "body at the near end"),
    connector_point<&BeamDef::frames, &ConnectorFrames::point1>("point1", "near end in body 1"),
    connector_axes<&BeamDef::frames, &ConnectorFrames::orientation1>(
        "orientation1", "frame 1 in body 1, x along the beam: rotations about x, y', z''"),
    connector_body<&BeamDef::frames, &ConnectorFrames::body2>("body2", "body at the far end"),
    connector_point<&BeamDef::frames, &ConnectorFrames::point2>("point2", "far end in body 2"),
    connector_axes<&BeamDef::frames, &ConnectorFrames::orientation2>(
        "orientation2", "frame 2 in body 2, as frame 1 without load: rotations about x, y', z''"),
    beam_number<&BeamDef::length>("length", Dimension::length, "length without load"),
    beam_number<&BeamDef::youngs_modulus>("youngs_modulus", Dimension::pressure, "Young's modulus E"),
    field<&BeamDef::shear_modulus>("shear_modulus", {.dimension = Dimension::pressure,
                                                     .range = kNotNegative,
                                                     .doc = "shear modulus G; 0: E / (2 (1 + poisson_ratio))"}),
    field<&BeamDef::poisson_ratio>(
        "poisson_ratio", {.range = kPoissonRange, .read_by = kReadByNoShearModulus, .doc = "Poisson's ratio"}),
    beam_number<&BeamDef::area>("area", Dimension::area, "area of the section"),
    beam_number<&BeamDef::second_moment_y>("second_moment_y", Dimension::second_moment_of_area,
                                           "second moment of area Iyy: bending along z"),
    beam_number<&BeamDef::second_moment_z>("second_moment_z", Dimension::second_moment_of_area,
                                           "second moment of area Izz: bending along y"),
    beam_number<&BeamDef::torsion_constant>("torsion_constant", Dimension::second_moment_of_area, "torsion constant J"),
    field<&BeamDef::shear_factor_y>(
        "shear_factor_y", {.range = kShearFactorRange,
                           .doc = "share of the area in shear along y (5/6 of a rectangle); 0: no shear deformation"}),
    field<&BeamDef::shear_factor_z>(
        "shear_factor_z", {.range = kShearFactorRange,
                           .doc = "share of the area in shear along z (5/6 of a rectangle); 0: no shear deformation"}),
    field<&BeamDef::damping_time>("damping_time", {.dimension = Dimension::time,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .doc = "damping over stiffness, 2 zeta / omega"}),
};

constexpr std::array<std::string_view, 1> kBeamKeys = {"damping_time"};

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

SixBySix slopes_of(const Beam& beam, const Deflection& /*deflection*/, ChangeWeights weights) noexcept {
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

std::span<const Field> beam_fields() noexcept {
  return kBeamFields;
}

Beam BeamRow::build(const BeamDef& def, ElementBuilder& builder) {
  const double shear_modulus =
      def.shear_modulus > 0 ? def.shear_modulus : def.youngs_modulus / (2 * (1 + def.poisson_ratio));
  Beam beam{.name = def.name,
            .frames = builder.frames_of(def.frames),
            .K = stiffness_of({.length = def.length,
                               .youngs_modulus = def.youngs_modulus,
                               .shear_modulus = shear_modulus,
                               .area = def.area,
                               .second_moment_y = def.second_moment_y,
                               .second_moment_z = def.second_moment_z,
                               .torsion_constant = def.torsion_constant,
                               .shear_factor_y = def.shear_factor_y,
                               .shear_factor_z = def.shear_factor_z}),
            .damping_time = def.damping_time};
  beam.frames.rest = math::Vec3(def.length, 0, 0);
  return beam;
}

void BeamRow::check(const BeamDef& def, ElementRules& rules) {
  rules.check_connector(def.name, def.frames);
}

void BeamRow::check_start(const BeamDef& def, ElementStartRules& rules) {
  const Deflection d = rules.deflection(def.frames);
  const double off = std::hypot(d.x[0] - def.length, d.x[1], d.x[2]);
  if (off > kMostBending * def.length) {
    rules.add(def.name + ".point2",
              fmt::format("frame 2 is at ({:.4g}, {:.4g}, {:.4g}) m in frame 1 at the start", d.x[0], d.x[1], d.x[2]),
              fmt::format("about ({:.4g}, 0, 0): the beam is {:.4g} m long along x", def.length, def.length));
  }
  if (norm(d.theta) > kMostBentAngle) {
    rules.add(def.name + ".orientation2",
              fmt::format("the frames are turned by {:.4g} deg at the start", norm(d.theta) * 180 / M_PI),
              "frames that are parallel without load");
  }
}

void BeamRow::silence(Beam& beam) {
  beam.K = {};
  beam.damping_time = 0;
}

std::span<const std::string_view> BeamRow::value_keys(const Beam& /*beam*/) noexcept {
  return kBeamKeys;
}

}  // namespace slew::multibody
