// SPDX-License-Identifier: Apache-2.0
#include "multibody/model/field_tables.h"

#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include "multibody/constraints/gear_fields.h"
#include "multibody/contacts/contact_fields.h"
#include "multibody/forces/dummy_fields.h"
#include "multibody/formulations/integrators.h"
#include "multibody/joints/joint_fields.h"
#include "multibody/motions/motion_fields.h"

namespace slew::multibody {
namespace {

using enum Dimension;

constexpr Range kAssemblyRange{.min = 0, .max = 0.1, .min_is_open = false, .max_is_open = false};
constexpr Range kSubstepRange{.min = 1e-6, .max = 20e-3, .min_is_open = false, .max_is_open = false};
// below, joints are soft; above, rounding corrupts the free directions
constexpr Range kPenaltyFactorRange{.min = 1e3, .max = 1e10, .min_is_open = false, .max_is_open = false};
constexpr Range kPenaltyDampingRange{.min = 0.01, .max = 10, .min_is_open = false, .max_is_open = false};
constexpr Range kPenaltyFrequencyRange{.min = 0, .max = 1e6, .max_is_open = false};
constexpr Range kRadiusRange{.min = 0, .max = 1, .min_is_open = false, .max_is_open = false};
constexpr Range kIterationRange{.min = 1e-13, .max = 1e-3, .min_is_open = false, .max_is_open = false};
constexpr double kMassRamp = 1.0;  // s

constexpr std::array<std::string_view, 2> kInertiaPoints = {"center_of_mass", "body_origin"};
constexpr std::array<std::string_view, 2> kStartShapes = {"equilibrium", "undeformed"};
constexpr std::array<std::string_view, 4> kFormulations = {"recursive", "lagrange", "augmented", "penalty"};
constexpr std::array<std::string_view, 7> kIntegrators = {
    "rk4", "semi_implicit_euler", "trapezoidal", "generalised_alpha", "sdirk2", "index3_trapezoidal", "own"};

constexpr ReadBy kReadByPenaltyFactor[] = {
    read_by<&MechanicsDef::formulation, Formulation::augmented, Formulation::penalty>(
        "formulation", "formulation: augmented or penalty")};
constexpr ReadBy kReadByPenalty[] = {
    read_by<&MechanicsDef::formulation, Formulation::penalty>("formulation", "formulation: penalty")};
constexpr ReadBy kReadByAlpha[] = {
    read_by<&MechanicsDef::integrator, Integrator::generalised_alpha>("integrator", "integrator: generalised_alpha")};
// index3_trapezoidal is the default of augmented
constexpr ReadBy kReadByImplicit[] = {{"integrator", "an implicit integrator", [](const void* def) noexcept {
                                         const auto& mechanics = *static_cast<const MechanicsDef*>(def);
                                         const Integrator rule = mechanics.integrator == Integrator::own
                                                                     ? own_integrator(mechanics.formulation)
                                                                     : mechanics.integrator;
                                         return rule != Integrator::rk4 && rule != Integrator::semi_implicit_euler;
                                       }}};

constexpr Field kMechanicsFields[] = {
    field<&MechanicsDef::gravity>(
        "gravity", {.dimension = acceleration, .change = Change::live, .doc = "acceleration of gravity, global axes"}),
    field<&MechanicsDef::formulation>("formulation", {.choices = kFormulations, .doc = "equations of motion"}),
    field<&MechanicsDef::assembly_tolerance>("assembly_tolerance",
                                             {.dimension = length,
                                              .range = kAssemblyRange,
                                              .doc = "largest violation of a joint by the start poses (a radian as a "
                                                     "metre): the bodies are moved onto it and named"}),
    field<&MechanicsDef::max_substep>(
        "max_substep",
        {.dimension = time, .range = kSubstepRange, .doc = "longest sub-step of the integrator inside a step"}),
    field<&MechanicsDef::contact_substep>(
        "contact_substep",
        {.dimension = time, .range = kSubstepRange, .doc = "longest sub-step while shapes touch or are about to"}),
    field<&MechanicsDef::penalty_factor>("penalty_factor",
                                         {.range = kPenaltyFactorRange,
                                          .read_by = kReadByPenaltyFactor,
                                          .doc = "penalty mass of a joint, relative to the mechanism's mass"}),
    field<&MechanicsDef::penalty_damping>(
        "penalty_damping",
        {.range = kPenaltyDampingRange, .read_by = kReadByPenalty, .doc = "damping ratio of a joint's violation"}),
    field<&MechanicsDef::penalty_frequency>("penalty_frequency", {.dimension = angular_velocity,
                                                                  .range = kPenaltyFrequencyRange,
                                                                  .read_by = kReadByPenalty,
                                                                  .doc = "angular frequency at which a joint closes"}),
    field<&MechanicsDef::integrator>(
        "integrator",
        {.choices = kIntegrators,
         .doc = "rule of a sub-step. recursive, lagrange: the first five, the last three of them implicit (for stiff "
                "springs and dampers); augmented: index3_trapezoidal; penalty: rk4. own: the first of these"}),
    field<&MechanicsDef::spectral_radius>(
        "spectral_radius", {.range = kRadiusRange,
                            .read_by = kReadByAlpha,
                            .doc = "share of an oscillation far too fast for the sub-step that remains after one"}),
    field<&MechanicsDef::iteration_tolerance>(
        "iteration_tolerance",
        {.range = kIterationRange,
         .read_by = kReadByImplicit,
         .doc =
             "error of speeds that ends the iteration, relative to the mechanism's largest (at least 1 m/s, 1 rad/s)"}),
    field<&MechanicsDef::payload>("payload", {.reference = "body",
                                              .doc = "lifted body of the load notes, a rigid one that moves; default: "
                                                     "the end of the longest chain of joints outside of loops"}),
};

constexpr Field kRelativeTo = field<&BodyDef::relative_to>(
    "relative_to", {.reference = "body", .doc = "body that position and orientation refer to"});
constexpr Field kPosition =
    field<&BodyDef::position>("position", {.dimension = length, .doc = "origin of the body's frame"});
constexpr Field kOrientation =
    field<&BodyDef::orientation>("orientation", {.dimension = angle, .doc = "Euler rotations z, x', z''"});

constexpr Field kFlexModel = field<&BodyDef::flex_model>(
    "flex_model",
    {.doc = "Model in the names Model_Prefix_Matrix.dat of the files beside the scene; without it the scene's name"});
constexpr Field kFlexFilePrefix = field<&BodyDef::flex_file_prefix>(
    "flex_file_prefix", {.presence = Presence::required, .doc = "Prefix in these names"});

constexpr Field kBodyFields[] = {
    kRelativeTo,
    kPosition,
    kOrientation,
    field<&BodyDef::mass>("mass", {.dimension = mass,
                                   .range = kPositive,
                                   .presence = Presence::required,
                                   .change = Change::live,
                                   .ramp = kMassRamp,
                                   .doc = "mass; a live change scales the inertia with it"}),
    field<&BodyDef::center_of_mass>("center_of_mass", {.dimension = length, .doc = "centre of mass, body frame"}),
    field<&BodyDef::inertia>("inertia", {.dimension = inertia,
                                         .range = kNotNegative,
                                         .presence = Presence::required,
                                         .doc = "moments Ixx, Iyy, Izz in body axes; 0, 0, 0 is a point mass; or "
                                                "from_mesh, from_shape, from_parts"}),
    field<&BodyDef::products>(
        "products",
        {.dimension = inertia, .doc = "elements Ixy, Ixz, Iyz of the tensor (minus the integral of x y dm)"}),
    field<&BodyDef::inertia_about>("inertia_about",
                                   {.choices = kInertiaPoints, .doc = "point that inertia and products refer to"}),
};

constexpr ReadBy kReadWithoutCoordinates[] = {
    {"modal_coordinates", "no modal_coordinates",
     [](const void* def) noexcept { return static_cast<const BodyDef*>(def)->modal_coordinates.empty(); }}};

constexpr Field kFlexibleBodyFields[] = {
    kRelativeTo,
    kPosition,
    kOrientation,
    kFlexModel,
    kFlexFilePrefix,
    field<&BodyDef::flex_modes>(
        "flex_modes", {.doc = "selected modes, as '1;2', or none: rigid, with the files' mass; default: all"}),
    field<&BodyDef::flex_frequency_limit>(
        "flex_frequency_limit",
        {.dimension = Dimension::frequency, .range = kPositive, .doc = "frequency above which modes are omitted"}),
    field<&BodyDef::relative_damping>(
        "relative_damping",
        {.doc = "damping over critical damping by mode, as '0.005;0.005', or one for all; default 0"}),
    field<&BodyDef::start_shape>("start_shape", {.choices = kStartShapes,
                                                 .read_by = kReadWithoutCoordinates,
                                                 .doc = "equilibrium: the body rests under its load at the start; with "
                                                        "loops only where actuators hold its joints, else undeformed"}),
    field<&BodyDef::modal_coordinates>(
        "modal_coordinates", {.doc = "modal coordinates at the start, as '0.01;0', in SI units of the files' modes"}),
    field<&BodyDef::modal_rates>("modal_rates",
                                 {.doc = "their rates, as '0.1;0'; default 0. Loops close by the other speeds"}),
};

constexpr Field kSegmentedBodyFields[] = {
    kRelativeTo,
    kPosition,
    kOrientation,
    kFlexModel,
    kFlexFilePrefix,
    field<&BodyDef::segments>("segments", {.range = {1, 200, false, false},
                                           .doc = "elastic connectors, of equal length, between one more rigid lumps"}),
    field<&BodyDef::relative_damping>(
        "relative_damping", {.doc = "damping over critical damping of the first mode, one number; default 0"}),
    field<&BodyDef::start_shape>("start_shape",
                                 {.choices = kStartShapes,
                                  .doc = "equilibrium: the body rests under its load at the start, with loops it is "
                                         "undeformed; undeformed: all segmented bodies of the scene are"}),
};

template <typename Def>
constexpr Field spring_table_row(Dimension argument, Dimension value, std::string_view doc) {
  return field<&Def::spring_table>("spring_table", {.dimension = argument, .value_dimension = value, .doc = doc});
}
template <typename Def>
constexpr Field damper_table_row(Dimension argument, Dimension value, std::string_view doc) {
  return field<&Def::damper_table>("damper_table", {.dimension = argument, .value_dimension = value, .doc = doc});
}

constexpr Field kTranslationalForceFields[] = {
    field<&TranslationalForceDef::body1>("body1",
                                         {.presence = Presence::required, .reference = "body", .doc = "first body"}),
    field<&TranslationalForceDef::point1>("point1", {.dimension = length, .doc = "force's point P1 in body 1"}),
    field<&TranslationalForceDef::body2>("body2",
                                         {.presence = Presence::required, .reference = "body", .doc = "second body"}),
    field<&TranslationalForceDef::point2>("point2", {.dimension = length, .doc = "force's point P2 in body 2"}),
    field<&TranslationalForceDef::spring_constant>(
        "spring_constant",
        {.dimension = stiffness, .range = kNotNegative, .change = Change::live, .doc = "spring between the points"}),
    field<&TranslationalForceDef::damping_constant>(
        "damping_constant",
        {.dimension = damping, .range = kNotNegative, .change = Change::live, .doc = "damper between the points"}),
    field<&TranslationalForceDef::free_length>("free_length", {.dimension = length,
                                                               .range = kNotNegative,
                                                               .change = Change::live,
                                                               .doc = "length at which the spring carries nothing"}),
    field<&TranslationalForceDef::min_length>(
        "min_length", {.dimension = length, .range = kNotNegative, .doc = "length below which the end damper pushes"}),
    field<&TranslationalForceDef::max_length>(
        "max_length",
        {.dimension = length, .range = kNotNegative, .doc = "length above which the end damper pulls back"}),
    field<&TranslationalForceDef::end_spring_constant>("end_spring_constant",
                                                       {.dimension = stiffness,
                                                        .range = kNotNegative,
                                                        .change = Change::live,
                                                        .doc = "spring of the end dampers; 0: no end dampers"}),
    field<&TranslationalForceDef::end_damping_constant>(
        "end_damping_constant",
        {.dimension = damping, .range = kNotNegative, .change = Change::live, .doc = "damper of the end dampers"}),
    spring_table_row<TranslationalForceDef>(length, force, "tension over length - free_length"),
    damper_table_row<TranslationalForceDef>(velocity, force, "tension over the rate of length"),
};

constexpr Field kRotationalForceFields[] = {
    field<&RotationalForceDef::body1>("body1",
                                      {.presence = Presence::required, .reference = "body", .doc = "first body"}),
    field<&RotationalForceDef::f1>("f1", {.doc = "direction across the axis, body 1"}),
    field<&RotationalForceDef::g1>("g1", {.doc = "direction across axis and f1, body 1"}),
    field<&RotationalForceDef::body2>("body2",
                                      {.presence = Presence::required, .reference = "body", .doc = "second body"}),
    field<&RotationalForceDef::f2>("f2", {.doc = "direction of the angle, from f1 towards g1, body 2"}),
    field<&RotationalForceDef::spring_constant>("spring_constant", {.dimension = rotational_stiffness,
                                                                    .range = kNotNegative,
                                                                    .change = Change::live,
                                                                    .doc = "spring about the axis"}),
    field<&RotationalForceDef::damping_constant>("damping_constant", {.dimension = rotational_damping,
                                                                      .range = kNotNegative,
                                                                      .change = Change::live,
                                                                      .doc = "damper about the axis"}),
    field<&RotationalForceDef::free_angle>(
        "free_angle", {.dimension = angle, .change = Change::live, .doc = "angle at which the spring carries nothing"}),
    field<&RotationalForceDef::min_angle>("min_angle",
                                          {.dimension = angle, .doc = "angle below which the end damper pushes"}),
    field<&RotationalForceDef::max_angle>("max_angle",
                                          {.dimension = angle, .doc = "angle above which the end damper pushes back"}),
    field<&RotationalForceDef::end_spring_constant>("end_spring_constant",
                                                    {.dimension = rotational_stiffness,
                                                     .range = kNotNegative,
                                                     .change = Change::live,
                                                     .doc = "spring of the end dampers; 0: no end dampers"}),
    field<&RotationalForceDef::end_damping_constant>("end_damping_constant", {.dimension = rotational_damping,
                                                                              .range = kNotNegative,
                                                                              .change = Change::live,
                                                                              .doc = "damper of the end dampers"}),
    spring_table_row<RotationalForceDef>(angle, torque, "torque that holds angle - free_angle"),
    damper_table_row<RotationalForceDef>(angular_velocity, torque, "torque that holds the rate"),
};

constexpr Range kDummyIndex{.min = 1, .max = 2, .min_is_open = false, .max_is_open = false};

constexpr Field kForceDummyFields[] = {
    field<&ForceDummyDef::relative_to>(
        "relative_to",
        {.presence = Presence::required, .reference = "force", .doc = "translational force that carries the mass"}),
    field<&ForceDummyDef::index>("index", {.range = kDummyIndex,
                                           .presence = Presence::required,
                                           .doc = "1: cylinder, at body 1's point; 2: piston, at body 2's point"}),
    field<&ForceDummyDef::mass>("mass",
                                {.dimension = mass, .range = kPositive, .presence = Presence::required, .doc = "mass"}),
    field<&ForceDummyDef::center_of_mass>(
        "center_of_mass", {.dimension = length, .doc = "centre of mass on the element's x axis = unit(P1 - P2)"}),
    field<&ForceDummyDef::inertia>(
        "inertia", {.dimension = inertia,
                    .range = kNotNegative,
                    .doc = "moments about the centre of mass, element frame; Iyy = Izz, Ixx has no effect"}),
};

constexpr Field kStaticDummyFields[] = {
    field<&StaticDummyDef::relative_to>("relative_to", {.reference = "body", .doc = "body that carries the mass"}),
    field<&StaticDummyDef::position>("position", {.dimension = length, .doc = "origin of the dummy in the body"}),
    field<&StaticDummyDef::orientation>("orientation", {.dimension = angle, .doc = "Euler rotations z, x', z''"}),
    field<&StaticDummyDef::mass>("mass",
                                 {.dimension = mass, .range = kNotNegative, .doc = "mass; 0 for graphics only"}),
    field<&StaticDummyDef::center_of_mass>("center_of_mass",
                                           {.dimension = length, .doc = "centre of mass, dummy's frame"}),
    field<&StaticDummyDef::inertia>(
        "inertia",
        {.dimension = inertia, .range = kNotNegative, .doc = "moments about the centre of mass, dummy's axes"}),
};

template <auto List>
void* append_to(MechanicsDef& mechanics, std::string_view element) {
  auto& def = (mechanics.*List).emplace_back();
  def.name = element;
  return &def;
}

template <BodyType Type>
void* append_body(MechanicsDef& mechanics, std::string_view element) {
  BodyDef& body = mechanics.bodies.emplace_back();
  body.name = element;
  body.type = Type;
  return &body;
}

// in the order of BodyType
constexpr ElementType kBodyTypes[] = {
    {"rigid", "body", "rigid body", kBodyFields, append_to<&MechanicsDef::bodies>, true},
    {"flexible", "body", "flexible body of a reduced finite element model", kFlexibleBodyFields,
     append_body<BodyType::flexible>},
    {"segmented", "body", "body of rigid lumps with elastic beams between them, from the same files",
     kSegmentedBodyFields, append_body<BodyType::segmented>},
};

constexpr ElementType kSpringTypes[] = {
    {"translational", "force", "spring-damper between two points, or a cylinder's line of force",
     kTranslationalForceFields, append_to<&MechanicsDef::translational_forces>},
    {"rotational", "force", "spring-damper about an axis, or a slewing drive's torque", kRotationalForceFields,
     append_to<&MechanicsDef::rotational_forces>},
};

constexpr ElementType kDummyTypes[] = {
    {"body_to_body_force", "dummy", "mass of a cylinder or piston, carried by a translational force", kForceDummyFields,
     append_to<&MechanicsDef::force_dummies>},
    {"static", "dummy", "mass fixed to a body", kStaticDummyFields, append_to<&MechanicsDef::static_dummies>},
};

constexpr ElementType kPartTypes[] = {
    {"part", "dummy", "mass on one body, placed in the frame of another", kPartDummyFields,
     append_to<&MechanicsDef::part_dummies>},
    {"constraint", "dummy", "mass of a joint's own part", kConstraintDummyFields,
     append_to<&MechanicsDef::constraint_dummies>},
};

// a type of a force kind
template <typename Row, std::size_t Index>
ElementType element_type() {
  constexpr const auto& type = std::get<Index>(Row::kTypes);
  return {type.name,
          type.section == "forces" ? "force" : "dummy",
          type.doc,
          type.fields(),
          [](MechanicsDef& mechanics, std::string_view element) -> void* {
            auto& def = (mechanics.*std::get<Index>(Row::kTypes).list).emplace_back();
            def.name = element;
            return &def;
          },
          false,
          [](const void* def, const Field& field) {
            using List = std::remove_cvref_t<decltype(std::declval<MechanicsDef>().*std::get<Index>(Row::kTypes).list)>;
            return Row::obstacle_of_change(*static_cast<const typename List::value_type*>(def), field);
          }};
}

void append_kinds(std::string_view section, std::vector<ElementType>& types) {
  for_each_force_kind([&](auto row) {
    using Row = decltype(row);
    [&]<std::size_t... Index>(std::index_sequence<Index...>) {
      const auto append = [&](const ElementType& type, std::string_view of) {
        if (of == section) types.push_back(type);
      };
      (append(element_type<Row, Index>(), std::get<Index>(Row::kTypes).section), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<std::remove_cvref_t<decltype(Row::kTypes)>>>());
  });
}

// the types of the library's core, then the force kinds of the section
std::vector<ElementType> types_of(std::string_view section, std::span<const ElementType> first,
                                  std::span<const ElementType> last = {}) {
  std::vector<ElementType> types(first.begin(), first.end());
  append_kinds(section, types);
  types.insert(types.end(), last.begin(), last.end());
  return types;
}

}  // namespace

std::span<const Section> sections() noexcept {
  static const std::vector<ElementType> kForces = types_of("forces", kSpringTypes);
  static const std::vector<ElementType> kDummies = types_of("dummies", kDummyTypes, kPartTypes);
  static const Section kSections[] = {
      {"bodies", kBodyTypes},          {"joints", joint_types()},   {"forces", kForces},
      {"dummies", kDummies},           {"shapes", shape_types()},   {"contacts", contact_types()},
      {"frictions", friction_types()}, {"motions", motion_types()}, {"gears", gear_types()}};
  return kSections;
}

const ElementType* find_type(std::string_view section, std::string_view name) noexcept {
  for (const Section& one : sections()) {
    for (const ElementType& type : one.types) {
      if (one.name == section && type.name == name) return &type;
    }
  }
  return nullptr;
}

std::span<const Field> part_dummy_fields() noexcept {
  return kPartDummyFields;
}

std::span<const Field> constraint_dummy_fields() noexcept {
  return kConstraintDummyFields;
}

std::span<const Field> mechanics_fields() noexcept {
  return kMechanicsFields;
}

std::string_view key_of(Formulation formulation) noexcept {
  return kFormulations[static_cast<std::size_t>(formulation)];
}

std::string_view key_of(Integrator integrator) noexcept {
  return kIntegrators[static_cast<std::size_t>(integrator)];
}

}  // namespace slew::multibody
