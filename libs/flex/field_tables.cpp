// SPDX-License-Identifier: Apache-2.0
#include "flex/field_tables.h"

namespace slew::flex {
namespace {

constexpr std::string_view kMassMatrices[] = {"consistent", "lumped"};
constexpr std::string_view kRotaryInertias[] = {"with", "none"};
constexpr std::string_view kShears[] = {"timoshenko", "none"};
constexpr std::string_view kAttachments[] = {"clamped", "free"};
constexpr std::string_view kStiffenings[] = {"none", "straight_beam"};
constexpr std::string_view kEigenMethods[] = {"automatic", "dense", "lanczos"};
constexpr std::string_view kBeamKeys[] = {"materials", "sections", "material",    "section",        "line",
                                          "nodes",     "elements", "mass_matrix", "rotary_inertia", "y_axis"};

constexpr Range kPoisson{.min = -1, .max = 0.5};
constexpr Range kNodeCount{.min = 2, .max = 10000, .min_is_open = false, .max_is_open = false};
constexpr Range kModeCount{.min = 0, .max = 1000, .min_is_open = false, .max_is_open = false};

constexpr Field kBodyFields[] = {
    field<&FlexibleBodyDef::model>(
        "model", {.presence = Presence::required, .doc = "first part of the files' names; a name of the machine"}),
    field<&FlexibleBodyDef::prefix>(
        "prefix", {.presence = Presence::required, .doc = "second part of the files' names; distinguishes variants"}),
    field<&FlexibleBodyDef::description>("description", {.doc = "description of the body"}),
    field<&FlexibleBodyDef::material>(
        "material", {.reference = "material", .doc = "default of the elements; required if there are several"}),
    field<&FlexibleBodyDef::section>(
        "section", {.reference = "section", .doc = "default of the elements; required if there are several"}),
    field<&FlexibleBodyDef::y_axis>(
        "y_axis", {.doc = "a vector in the x-y plane of the sections, on the side of +y; along an element that lies in "
                          "its direction the body's z is taken"}),
    field<&FlexibleBodyDef::mass_matrix>(
        "mass_matrix", {.choices = kMassMatrices, .doc = "consistent with the deflections, or lumped at the nodes"}),
    field<&FlexibleBodyDef::rotary_inertia>(
        "rotary_inertia", {.choices = kRotaryInertias,
                           .doc = "rotary inertia of the sections in bending; none for comparison with Euler's "
                                  "beam: the frame keeps the inertia of the solid"}),
};

constexpr Field kMaterialFields[] = {
    field<&NamedMaterial::material, &Material::youngs_modulus>("youngs_modulus", {.dimension = Dimension::pressure,
                                                                                  .range = kPositive,
                                                                                  .presence = Presence::required,
                                                                                  .doc = "Young's modulus E"}),
    field<&NamedMaterial::material, &Material::poisson_ratio>("poisson_ratio",
                                                              {.range = kPoisson, .doc = "Poisson's ratio nu"}),
    field<&NamedMaterial::material, &Material::shear_modulus>(
        "shear_modulus",
        {.dimension = Dimension::pressure, .range = kNotNegative, .doc = "shear modulus G; 0: E/(2 (1 + nu))"}),
    field<&NamedMaterial::material, &Material::density>(
        "density",
        {.dimension = Dimension::density, .range = kPositive, .presence = Presence::required, .doc = "density rho"}),
};

template <auto Member>
constexpr Field required_of_section(std::string_view key, Dimension dimension, std::string_view doc) {
  return field<&NamedSection::section, Member>(
      key, {.dimension = dimension, .range = kPositive, .presence = Presence::required, .doc = doc});
}

constexpr Field kWidth = required_of_section<&SectionDef::width>("width", Dimension::length, "along y, outside");
constexpr Field kHeight = required_of_section<&SectionDef::height>("height", Dimension::length, "along z, outside");
constexpr Field kDiameter = required_of_section<&SectionDef::diameter>("diameter", Dimension::length, "outer diameter");
constexpr Field kShear = field<&NamedSection::section, &SectionDef::shear>(
    "shear", {.choices = kShears, .doc = "timoshenko: with shear; none: Euler and Bernoulli's beam"});
constexpr Field kShearFactor = field<&NamedSection::shear_factor>(
    "shear_factor", {.range = kNotNegative, .doc = "shear area over area along y and z; 0: by Cowper from the shape"});
constexpr Field kShearFactorY = field<&NamedSection::shear_factor_y>(
    "shear_factor_y", {.range = kNotNegative, .doc = "the same along y alone; 0: as shear_factor"});
constexpr Field kShearFactorZ = field<&NamedSection::shear_factor_z>(
    "shear_factor_z", {.range = kNotNegative, .doc = "the same along z alone; 0: as shear_factor"});

constexpr Field kGivenFields[] = {
    required_of_section<&SectionDef::area>("area", Dimension::area, "area A"),
    required_of_section<&SectionDef::second_moment_y>("second_moment_y", Dimension::second_moment_of_area,
                                                      "Iyy = integral z^2 dA: bending in the x-z plane"),
    required_of_section<&SectionDef::second_moment_z>("second_moment_z", Dimension::second_moment_of_area,
                                                      "Izz = integral y^2 dA: bending in the x-y plane"),
    required_of_section<&SectionDef::torsion_constant>("torsion_constant", Dimension::second_moment_of_area,
                                                       "torsion constant J"),
    kShear,
    field<&NamedSection::shear_factor>(
        "shear_factor", {.range = kNotNegative, .doc = "shear area over area along y and z; 0: rigid in shear"}),
    kShearFactorY,
    kShearFactorZ,
};

constexpr Field kHollowRectangleFields[] = {
    kWidth,
    kHeight,
    required_of_section<&SectionDef::wall>("wall", Dimension::length, "thickness of the walls normal to y"),
    field<&NamedSection::section, &SectionDef::flange>("flange",
                                                       {.dimension = Dimension::length,
                                                        .range = kNotNegative,
                                                        .doc = "thickness of the walls normal to z; 0: as wall"}),
    kShear,
    kShearFactor,
    kShearFactorY,
    kShearFactorZ,
};

constexpr Field kISectionFields[] = {
    kWidth,
    kHeight,
    required_of_section<&SectionDef::wall>("wall", Dimension::length, "thickness of the web, normal to y"),
    required_of_section<&SectionDef::flange>("flange", Dimension::length, "thickness of the flanges, normal to z"),
    kShear,
    kShearFactor,
    kShearFactorY,
    kShearFactorZ,
};

constexpr Field kTubeFields[] = {
    kDiameter,     required_of_section<&SectionDef::wall>("wall", Dimension::length, "thickness of the wall"),
    kShear,        kShearFactor,
    kShearFactorY, kShearFactorZ,
};

constexpr Field kSolidRectangleFields[] = {kWidth, kHeight, kShear, kShearFactor, kShearFactorY, kShearFactorZ};
constexpr Field kSolidCircleFields[] = {kDiameter, kShear, kShearFactor, kShearFactorY, kShearFactorZ};

constexpr SectionType kSectionTypes[] = {
    {"given", SectionShape::given, "by its numbers", kGivenFields},
    {"hollow_rectangle", SectionShape::hollow_rectangle, "box", kHollowRectangleFields},
    {"i_section", SectionShape::i_section, "I with its web along z", kISectionFields},
    {"tube", SectionShape::tube, "hollow circle", kTubeFields},
    {"solid_rectangle", SectionShape::solid_rectangle, "solid rectangle", kSolidRectangleFields},
    {"solid_circle", SectionShape::solid_circle, "solid circle", kSolidCircleFields},
};

constexpr Field kStressPointFields[] = {
    field<&StressPointDef::y>(
        "y", {.dimension = Dimension::length, .presence = Presence::required, .doc = "place from the centroid"}),
    field<&StressPointDef::z>(
        "z", {.dimension = Dimension::length, .presence = Presence::required, .doc = "place from the centroid"}),
    field<&StressPointDef::torsion_modulus>("torsion_modulus",
                                            {.dimension = Dimension::volume,
                                             .range = kNotNegative,
                                             .doc = "torque over its shear stress at the point; 0: no shear stress"}),
};

constexpr Field kLineFields[] = {
    field<&NodeLineDef::start>("start", {.dimension = Dimension::length,
                                         .presence = Presence::required,
                                         .doc = "place of node 1, the root, in the body frame"}),
    field<&NodeLineDef::end>(
        "end",
        {.dimension = Dimension::length, .presence = Presence::required, .doc = "place of the last node, the tip"}),
    field<&NodeLineDef::nodes>(
        "nodes", {.range = kNodeCount, .presence = Presence::required, .doc = "number of nodes, at equal distances"}),
};

constexpr Field kNodeField = field<&BeamNodeDef::position>(
    "position", {.dimension = Dimension::length, .doc = "place of the node in the body frame"});

constexpr Field kElementFields[] = {
    field<&ElementChainDef::through>(
        "through", {.presence = Presence::required, .doc = "numbers of the nodes that the elements join one by one"}),
    field<&ElementChainDef::section>("section", {.reference = "section", .doc = "name; default: the body's"}),
    field<&ElementChainDef::material>("material", {.reference = "material", .doc = "name; default: the body's"}),
    field<&ElementChainDef::y_axis>("y_axis", {.doc = "as the body's, of these elements; 0: the body's"}),
};

constexpr Field kMatrixFileFields[] = {
    field<&MatrixFilesDef::mass>(
        "mass", {.presence = Presence::required, .doc = "mass matrix, Matrix Market file; in SI kg, kg m, kg m2"}),
    field<&MatrixFilesDef::stiffness>("stiffness", {.presence = Presence::required,
                                                    .doc = "stiffness matrix, Matrix Market file; in SI N/m, N, N m"}),
    field<&MatrixFilesDef::nodes>(
        "nodes", {.presence = Presence::required, .doc = "table `id x y z freedoms` in the order of the rows"}),
    field<&MatrixFilesDef::units>(
        "units",
        {.choices = kUnitNames,
         .doc = "units of all three files: length_mass_time; _lbf_: pound-force, its mass lbf s2 over the length"}),
};

constexpr Field kReductionFields[] = {
    field<&BodyReductionDef::attachment>(
        "attachment", {.choices = kAttachments, .doc = "body frame: clamped at nodes, or free and without momentum"}),
    field<&BodyReductionDef::clamped_nodes>("clamped_nodes", {.doc = "numbers; none: the first node"}),
    field<&BodyReductionDef::interface_nodes>(
        "interface_nodes",
        {.doc = "node numbers with exact response to loads; none: the last node, free: the first and the last"}),
    field<&BodyReductionDef::fixed_interface_modes>(
        "fixed_interface_modes", {.range = kModeCount, .doc = "modes of the inside with the interfaces held"}),
    field<&BodyReductionDef::stiffening>(
        "stiffening", {.choices = kStiffenings, .doc = "straight_beam: shortening of a straight beam that bends"}),
    field<&BodyReductionDef::eigen_method>(
        "eigen_method", {.choices = kEigenMethods, .doc = "automatic: dense up to 500 freedoms, then lanczos"}),
};

}  // namespace

std::span<const Field> body_fields() noexcept {
  return kBodyFields;
}
std::span<const Field> material_fields() noexcept {
  return kMaterialFields;
}
std::span<const SectionType> section_types() noexcept {
  return kSectionTypes;
}
std::span<const Field> stress_point_fields() noexcept {
  return kStressPointFields;
}
std::span<const Field> line_fields() noexcept {
  return kLineFields;
}
const Field& node_field() noexcept {
  return kNodeField;
}
std::span<const Field> element_fields() noexcept {
  return kElementFields;
}
std::span<const Field> matrix_file_fields() noexcept {
  return kMatrixFileFields;
}
std::span<const Field> reduction_fields() noexcept {
  return kReductionFields;
}
std::span<const std::string_view> beam_keys() noexcept {
  return kBeamKeys;
}

}  // namespace slew::flex
