// Field tables of element_defs.h. Internal to the library: field_tables.cpp puts them into the sections.
#pragma once

#include <array>

#include "multibody/forces/element_defs.h"

namespace slew::multibody {

inline constexpr std::array<std::string_view, 2> kLoadAxes = {"body", "ground"};
inline constexpr std::array<std::string_view, 2> kTyreRolling = {"free", "with_body"};
inline constexpr Range kPoissonRange{.min = -1, .max = 0.5, .max_is_open = false};
inline constexpr Range kShearFactorRange{.min = 0, .max = 1, .min_is_open = false, .max_is_open = false};
inline constexpr Range kFrameIndex{.min = 1, .max = 2, .min_is_open = false, .max_is_open = false};
inline constexpr double kWinchRamp = 1.0;  // s

template <auto Member>
constexpr Field required_body(std::string_view key, std::string_view doc) {
  return field<Member>(key, {.presence = Presence::required, .reference = "body", .doc = doc});
}

inline constexpr Field kPointForceFields[] = {
    required_body<&PointForceDef::body>("body", "body that the force acts on"),
    field<&PointForceDef::point>("point", {.dimension = Dimension::length, .doc = "force's point in the body"}),
    field<&PointForceDef::direction>("direction", {.doc = "direction of a positive force, of any length"}),
    field<&PointForceDef::axes>("axes", {.choices = kLoadAxes, .doc = "axes that the direction is given in and keeps"}),
    field<&PointForceDef::force>("force",
                                 {.dimension = Dimension::force, .change = Change::live, .doc = "constant part"}),
    field<&PointForceDef::force_table>("force_table", {.dimension = Dimension::time,
                                                       .value_dimension = Dimension::force,
                                                       .doc = "force over time, added; holds its last values"}),
};

inline constexpr Field kPointTorqueFields[] = {
    required_body<&PointTorqueDef::body>("body", "body that the torque acts on"),
    field<&PointTorqueDef::direction>("direction", {.doc = "axis of a positive torque, of any length"}),
    field<&PointTorqueDef::axes>("axes",
                                 {.choices = kLoadAxes, .doc = "axes that the direction is given in and keeps"}),
    field<&PointTorqueDef::torque>("torque",
                                   {.dimension = Dimension::torque, .change = Change::live, .doc = "constant part"}),
    field<&PointTorqueDef::torque_table>("torque_table", {.dimension = Dimension::time,
                                                          .value_dimension = Dimension::torque,
                                                          .doc = "torque over time, added; holds its last values"}),
};

template <auto Frames, auto Member>
constexpr Field connector_body(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.presence = Presence::required, .reference = "body", .doc = doc});
}
template <auto Frames, auto Member>
constexpr Field connector_point(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.dimension = Dimension::length, .doc = doc});
}
template <auto Frames, auto Member>
constexpr Field connector_axes(std::string_view key, std::string_view doc) {
  return field<Frames, Member>(key, {.dimension = Dimension::angle, .doc = doc});
}

// constants of a bushing along its three axes, or about them
template <auto Member>
constexpr Field bushing_triple(std::string_view key, Dimension dimension, const Range& range, std::string_view doc) {
  return field<Member>(key, {.dimension = dimension, .range = range, .change = Change::live, .doc = doc});
}
template <auto Tables, auto Member>
constexpr Field bushing_table(std::string_view key, Dimension argument, Dimension value, std::string_view doc) {
  return field<Tables, Member>(key, {.dimension = argument, .value_dimension = value, .doc = doc});
}

inline constexpr std::string_view kSpringTableDoc = "force that holds a deflection, added to the springs";
inline constexpr std::string_view kDamperTableDoc = "force that holds a speed, added to the dampers";

inline constexpr Field kBushingFields[] = {
    connector_body<&BushingDef::frames, &ConnectorFrames::body1>("body1", "first body"),
    connector_point<&BushingDef::frames, &ConnectorFrames::point1>("point1", "origin of frame 1 in body 1"),
    connector_axes<&BushingDef::frames, &ConnectorFrames::orientation1>(
        "orientation1", "frame 1 in body 1: successive rotations about x, y', z''"),
    connector_body<&BushingDef::frames, &ConnectorFrames::body2>("body2", "second body"),
    connector_point<&BushingDef::frames, &ConnectorFrames::point2>("point2", "origin of frame 2 in body 2"),
    connector_axes<&BushingDef::frames, &ConnectorFrames::orientation2>(
        "orientation2", "frame 2 in body 2: successive rotations about x, y', z''"),
    bushing_triple<&BushingDef::stiffness>("stiffness", Dimension::stiffness, kNotNegative,
                                           "springs along the axes of frame 1"),
    bushing_triple<&BushingDef::rotational_stiffness>("rotational_stiffness", Dimension::rotational_stiffness,
                                                      kNotNegative, "springs about the axes of frame 1"),
    bushing_triple<&BushingDef::damping>("damping", Dimension::damping, kNotNegative,
                                         "dampers along the axes of frame 1"),
    bushing_triple<&BushingDef::rotational_damping>("rotational_damping", Dimension::rotational_damping, kNotNegative,
                                                    "dampers about the axes of frame 1"),
    field<&BushingDef::stiffness_matrix>(
        "stiffness_matrix",
        {.doc = "6 x 6 in SI, row by row, symmetric; added to the springs (x, y, z, about x, y, z)"}),
    field<&BushingDef::damping_matrix>("damping_matrix",
                                       {.doc = "6 x 6 in SI, row by row, symmetric; added to the dampers"}),
    bushing_triple<&BushingDef::preload_force>("preload_force", Dimension::force, kFinite,
                                               "force on body 2 without deflection, axes of frame 1"),
    bushing_triple<&BushingDef::preload_moment>("preload_moment", Dimension::torque, kFinite,
                                                "moment on body 2 without deflection, axes of frame 1"),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::x>("spring_table_x", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::y>("spring_table_y", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::z>("spring_table_z", Dimension::length,
                                                                   Dimension::force, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_x>("spring_table_about_x", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_y>("spring_table_about_y", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::spring_tables, &DirectionTables::about_z>("spring_table_about_z", Dimension::angle,
                                                                         Dimension::torque, kSpringTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::x>("damper_table_x", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::y>("damper_table_y", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::z>("damper_table_z", Dimension::velocity,
                                                                   Dimension::force, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_x>(
        "damper_table_about_x", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_y>(
        "damper_table_about_y", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
    bushing_table<&BushingDef::damper_tables, &DirectionTables::about_z>(
        "damper_table_about_z", Dimension::angular_velocity, Dimension::torque, kDamperTableDoc),
};

template <auto Member>
constexpr Field beam_number(std::string_view key, Dimension dimension, std::string_view doc) {
  return field<Member>(key, {.dimension = dimension, .range = kPositive, .presence = Presence::required, .doc = doc});
}

inline constexpr ReadBy kReadByNoShearModulus[] = {{"shear_modulus", "no shear_modulus", [](const void* def) noexcept {
                                                      return !(static_cast<const BeamDef*>(def)->shear_modulus > 0);
                                                    }}};

inline constexpr Field kBeamFields[] = {
    connector_body<&BeamDef::frames, &ConnectorFrames::body1>("body1", "body at the near end"),
    connector_point<&BeamDef::frames, &ConnectorFrames::point1>("point1", "near end in body 1"),
    connector_axes<&BeamDef::frames, &ConnectorFrames::orientation1>(
        "orientation1", "frame 1 in body 1, x along the beam: successive rotations about x, y', z''"),
    connector_body<&BeamDef::frames, &ConnectorFrames::body2>("body2", "body at the far end"),
    connector_point<&BeamDef::frames, &ConnectorFrames::point2>("point2", "far end in body 2"),
    connector_axes<&BeamDef::frames, &ConnectorFrames::orientation2>(
        "orientation2", "frame 2 in body 2, as frame 1 without load: successive rotations about x, y', z''"),
    beam_number<&BeamDef::length>("length", Dimension::length, "length without load"),
    beam_number<&BeamDef::youngs_modulus>("youngs_modulus", Dimension::pressure, "modulus of elasticity E"),
    field<&BeamDef::shear_modulus>("shear_modulus", {.dimension = Dimension::pressure,
                                                     .range = kNotNegative,
                                                     .doc = "shear modulus G; 0: E / (2 (1 + poisson_ratio))"}),
    field<&BeamDef::poisson_ratio>(
        "poisson_ratio",
        {.range = kPoissonRange, .read_by = kReadByNoShearModulus, .doc = "Poisson's ratio, where shear_modulus is 0"}),
    beam_number<&BeamDef::area>("area", Dimension::area, "area of the section"),
    beam_number<&BeamDef::second_moment_y>("second_moment_y", Dimension::second_moment_of_area,
                                           "second moment of area Iyy: bending along z"),
    beam_number<&BeamDef::second_moment_z>("second_moment_z", Dimension::second_moment_of_area,
                                           "second moment of area Izz: bending along y"),
    beam_number<&BeamDef::torsion_constant>("torsion_constant", Dimension::second_moment_of_area, "torsion constant J"),
    field<&BeamDef::shear_factor_y>("shear_factor_y", {.range = kShearFactorRange,
                                                       .doc = "share of the area that carries shear along y (5/6 of a "
                                                              "rectangle); 0: no shear deformation"}),
    field<&BeamDef::shear_factor_z>("shear_factor_z", {.range = kShearFactorRange, .doc = "the same along z"}),
    field<&BeamDef::damping_time>("damping_time", {.dimension = Dimension::time,
                                                   .range = kNotNegative,
                                                   .change = Change::live,
                                                   .doc = "damping over stiffness, 2 zeta / omega"}),
};

inline constexpr Field kRopeFields[] = {
    field<&RopeDef::bodies>("bodies", {.presence = Presence::required,
                                       .reference = "body",
                                       .doc = "body of every point, from one end of the rope to the other"}),
    field<&RopeDef::points>("points", {.dimension = Dimension::length,
                                       .presence = Presence::required,
                                       .doc = "points of the rope, each in its body"}),
    field<&RopeDef::free_length>("free_length", {.dimension = Dimension::length,
                                                 .range = kPositive,
                                                 .presence = Presence::required,
                                                 .change = Change::live,
                                                 .ramp = kWinchRamp,
                                                 .doc = "length below which the rope is slack"}),
    field<&RopeDef::stiffness>("stiffness", {.dimension = Dimension::stiffness,
                                             .range = kNotNegative,
                                             .change = Change::live,
                                             .doc = "spring of the whole rope"}),
    field<&RopeDef::axial_rigidity>("axial_rigidity", {.dimension = Dimension::force,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "E A, instead of stiffness: E A / free_length"}),
    field<&RopeDef::damping_constant>("damping_constant",
                                      {.dimension = Dimension::damping,
                                       .range = kNotNegative,
                                       .change = Change::live,
                                       .doc = "damper of the whole rope; carries at most what the spring does"}),
    field<&RopeDef::spring_table>("spring_table", {.dimension = Dimension::length,
                                                   .value_dimension = Dimension::force,
                                                   .range = kNotNegative,
                                                   .doc = "tension over stretch from [0, 0], instead of stiffness"}),
    field<&RopeDef::damper_table>("damper_table",
                                  {.dimension = Dimension::velocity,
                                   .value_dimension = Dimension::force,
                                   .doc = "force over the rate of length, instead of a damping_constant"}),
};

template <auto Member>
constexpr Field dummy_mass(std::string_view doc) {
  return field<Member>("mass", {.dimension = Dimension::mass, .range = kNotNegative, .doc = doc});
}

inline constexpr Field kTyreDummyFields[] = {
    required_body<&TyreDummyDef::relative_to>("relative_to", "body that carries the wheel"),
    field<&TyreDummyDef::position>("position", {.dimension = Dimension::length, .doc = "wheel's centre in the body"}),
    field<&TyreDummyDef::orientation>(
        "orientation", {.dimension = Dimension::angle, .doc = "successive Euler rotations z, x', z''; the axle is z"}),
    dummy_mass<&TyreDummyDef::mass>("mass of wheel and tyre"),
    field<&TyreDummyDef::inertia>("inertia", {.dimension = Dimension::inertia,
                                              .range = kNotNegative,
                                              .doc = "moments about the centre; Izz of a free wheel has no effect"}),
    field<&TyreDummyDef::rolling>(
        "rolling",
        {.choices = kTyreRolling, .doc = "free: turns on its axle; with_body: driven, braked, or its own body"}),
    field<&TyreDummyDef::radius>("radius", {.dimension = Dimension::length,
                                            .range = kPositive,
                                            .presence = Presence::required,
                                            .doc = "radius without load, at which it also rolls"}),
    field<&TyreDummyDef::ground_normal>("ground_normal", {.doc = "upward normal of the ground, Ground axes"}),
    field<&TyreDummyDef::ground_height>(
        "ground_height",
        {.dimension = Dimension::length, .change = Change::live, .doc = "ground along its normal, from the origin"}),
    field<&TyreDummyDef::stiffness>("stiffness", {.dimension = Dimension::stiffness,
                                                  .range = kPositive,
                                                  .presence = Presence::required,
                                                  .change = Change::live,
                                                  .doc = "spring between wheel and ground"}),
    field<&TyreDummyDef::damping>("damping", {.dimension = Dimension::damping,
                                              .range = kNotNegative,
                                              .change = Change::live,
                                              .doc = "damper; carries at most what the spring does"}),
    field<&TyreDummyDef::friction>(
        "friction", {.range = kPositive, .change = Change::live, .doc = "largest slip force over normal force"}),
    field<&TyreDummyDef::longitudinal_slip_slope>(
        "longitudinal_slip_slope", {.range = kNotNegative, .doc = "longitudinal force over normal force, per slip"}),
    field<&TyreDummyDef::lateral_slip_slope>(
        "lateral_slip_slope",
        {.range = kNotNegative, .doc = "lateral force over normal force, per tangent of the slip angle"}),
    field<&TyreDummyDef::rolling_resistance>(
        "rolling_resistance",
        {.range = kFraction, .change = Change::live, .doc = "resistance over normal force, also without slip"}),
    field<&TyreDummyDef::slip_speed>(
        "slip_speed",
        {.dimension = Dimension::velocity, .range = kPositive, .doc = "speed below which slip acts as a damper"}),
};

template <typename Def>
constexpr Field dummy_position(std::string_view doc) {
  return field<&Def::position>("position", {.dimension = Dimension::length, .doc = doc});
}
template <typename Def>
constexpr Field dummy_orientation() {
  return field<&Def::orientation>("orientation",
                                  {.dimension = Dimension::angle, .doc = "successive Euler rotations z, x', z''"});
}
template <typename Def>
constexpr Field dummy_center() {
  return field<&Def::center_of_mass>("center_of_mass",
                                     {.dimension = Dimension::length, .doc = "centre of mass, dummy's frame"});
}
template <typename Def>
constexpr Field dummy_inertia() {
  return field<&Def::inertia>("inertia", {.dimension = Dimension::inertia,
                                          .range = kNotNegative,
                                          .doc = "moments about the centre of mass, dummy's axes"});
}

inline constexpr Field kPartDummyFields[] = {
    field<&PartDummyDef::relative_to>("relative_to", {.reference = "body", .doc = "body that the pose refers to"}),
    required_body<&PartDummyDef::carried_by>("carried_by", "body that the mass is fixed to"),
    dummy_position<PartDummyDef>("origin of the dummy in relative_to's frame, at the start"),
    dummy_orientation<PartDummyDef>(),
    dummy_mass<&PartDummyDef::mass>("mass"),
    dummy_center<PartDummyDef>(),
    dummy_inertia<PartDummyDef>(),
};

inline constexpr Field kConstraintDummyFields[] = {
    field<&ConstraintDummyDef::relative_to>(
        "relative_to", {.presence = Presence::required, .reference = "joint", .doc = "joint whose part has the mass"}),
    field<&ConstraintDummyDef::index>("index", {.range = kFrameIndex,
                                                .presence = Presence::required,
                                                .doc = "1: fixed to the joint's frame on body 1; 2: on body 2"}),
    dummy_position<ConstraintDummyDef>("origin of the dummy in the joint's frame"),
    dummy_orientation<ConstraintDummyDef>(),
    dummy_mass<&ConstraintDummyDef::mass>("mass"),
    dummy_center<ConstraintDummyDef>(),
    dummy_inertia<ConstraintDummyDef>(),
};

}  // namespace slew::multibody
