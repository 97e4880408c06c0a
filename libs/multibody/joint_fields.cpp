#include "multibody/joint_fields.h"

namespace slew::multibody {
namespace {

using enum Dimension;

constexpr Field kBody1 = field<&JointDef::body1>("body1", {.reference = "body", .doc = "first body"});
constexpr Field kPoint1 = field<&JointDef::point1>("point1", {.dimension = length, .doc = "joint's point in body 1"});
constexpr Field kOrientation1 = field<&JointDef::orientation1>(
    "orientation1", {.dimension = angle, .doc = "joint frame in body 1: successive rotations about x, y', z''"});
constexpr Field kBody2 =
    field<&JointDef::body2>("body2", {.presence = Presence::required, .reference = "body", .doc = "second body"});
constexpr Field kPoint2 = field<&JointDef::point2>("point2", {.dimension = length, .doc = "joint's point in body 2"});
constexpr Field kOrientation2 = field<&JointDef::orientation2>(
    "orientation2", {.dimension = angle, .doc = "joint frame in body 2: successive rotations about x, y', z''"});

// limits and friction of a joint with one coordinate, in the dimensions of that coordinate
struct AxisDimensions {
  Dimension coordinate, speed, stiffness, damping, force;
};

constexpr Field initial_velocity_row(const AxisDimensions& d) {
  return field<&JointDef::initial_velocity>(
      "initial_velocity",
      {.dimension = d.speed, .doc = "rate of the joint coordinate at the start; none: 0, or what a loop makes of it"});
}
constexpr Field limit_min_row(const AxisDimensions& d) {
  return field<&JointDef::limit_min>("limit_min",
                                     {.dimension = d.coordinate, .doc = "lower limit of the joint coordinate"});
}
constexpr Field limit_max_row(const AxisDimensions& d) {
  return field<&JointDef::limit_max>("limit_max",
                                     {.dimension = d.coordinate, .doc = "upper limit of the joint coordinate"});
}
constexpr Field limit_stiffness_row(const AxisDimensions& d) {
  return field<&JointDef::limit_stiffness>("limit_stiffness", {.dimension = d.stiffness,
                                                               .range = kNotNegative,
                                                               .change = Change::live,
                                                               .doc = "spring of the limits; they push only"});
}
constexpr Field limit_damping_row(const AxisDimensions& d) {
  return field<&JointDef::limit_damping>(
      "limit_damping",
      {.dimension = d.damping, .range = kNotNegative, .change = Change::live, .doc = "damper of the limits"});
}
constexpr Field coulomb_row(const AxisDimensions& d) {
  return field<&JointDef::coulomb_friction>(
      "coulomb_friction",
      {.dimension = d.force, .range = kNotNegative, .change = Change::live, .doc = "dry friction of the joint"});
}
constexpr Field viscous_row(const AxisDimensions& d) {
  return field<&JointDef::viscous_friction>(
      "viscous_friction",
      {.dimension = d.damping, .range = kNotNegative, .change = Change::live, .doc = "viscous friction of the joint"});
}
constexpr Field friction_speed_row(const AxisDimensions& d) {
  return field<&JointDef::friction_speed>(
      "friction_speed", {.dimension = d.speed,
                         .range = kPositive,
                         .doc = "speed over which dry friction is smoothed, tanh(v / friction_speed); of bristles the "
                                "Stribeck speed"});
}
constexpr Field bristle_stiffness_row(const AxisDimensions& d) {
  return field<&JointDef::bristle_stiffness>("bristle_stiffness",
                                             {.dimension = d.stiffness,
                                              .range = kNotNegative,
                                              .doc = "dry friction by bristles, which hold at rest; 0: none"});
}
constexpr Field bristle_damping_row(const AxisDimensions& d) {
  return field<&JointDef::bristle_damping>(
      "bristle_damping", {.dimension = d.damping, .range = kNotNegative, .doc = "damping of the bristles"});
}
constexpr Range kFromOne{.min = 1, .min_is_open = false};
constexpr Field breakaway_ratio_row() {
  return field<&JointDef::breakaway_ratio>("breakaway_ratio",
                                           {.range = kFromOne, .doc = "breakaway over dry friction, of bristles"});
}

constexpr AxisDimensions kRotation{angle, angular_velocity, rotational_stiffness, rotational_damping, torque};
constexpr AxisDimensions kTranslation{length, velocity, stiffness, damping, force};

constexpr Field kRevoluteFields[] = {kBody1,
                                     kPoint1,
                                     kOrientation1,
                                     kBody2,
                                     kPoint2,
                                     kOrientation2,
                                     initial_velocity_row(kRotation),
                                     limit_min_row(kRotation),
                                     limit_max_row(kRotation),
                                     limit_stiffness_row(kRotation),
                                     limit_damping_row(kRotation),
                                     coulomb_row(kRotation),
                                     viscous_row(kRotation),
                                     friction_speed_row(kRotation),
                                     bristle_stiffness_row(kRotation),
                                     bristle_damping_row(kRotation),
                                     breakaway_ratio_row()};

constexpr Field kPrismaticFields[] = {kBody1,
                                      kPoint1,
                                      kOrientation1,
                                      kBody2,
                                      kPoint2,
                                      kOrientation2,
                                      initial_velocity_row(kTranslation),
                                      limit_min_row(kTranslation),
                                      limit_max_row(kTranslation),
                                      limit_stiffness_row(kTranslation),
                                      limit_damping_row(kTranslation),
                                      coulomb_row(kTranslation),
                                      viscous_row(kTranslation),
                                      friction_speed_row(kTranslation),
                                      bristle_stiffness_row(kTranslation),
                                      bristle_damping_row(kTranslation),
                                      breakaway_ratio_row()};

constexpr Field kInitialRotation = field<&JointDef::initial_rotation>(
    "initial_angular_velocity",
    {.dimension = angular_velocity,
     .doc =
         "angular velocity of body 2 seen from body 1 at the start, body 1 axes; none: 0, or what a loop makes of it"});
constexpr Field kInitialTranslation = field<&JointDef::initial_translation>(
    "initial_velocity",
    {.dimension = velocity, .doc = "velocity of point 2 seen from body 1 at the start, body 1 axes"});

constexpr Field kSphericalFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kOrientation2, kInitialRotation};

constexpr Field kFixedFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kOrientation2};

constexpr Field kFloatingFields[] = {kBody1,  kPoint1,       kOrientation1,       kBody2,
                                     kPoint2, kOrientation2, kInitialTranslation, kInitialRotation};

constexpr Field kUniversalFields[] = {
    kBody1,
    kPoint1,
    kOrientation1,
    kBody2,
    kPoint2,
    kOrientation2,
    field<&JointDef::initial_velocity>("initial_velocity_1",
                                       {.dimension = angular_velocity, .doc = "rate about z of frame 1 at the start"}),
    field<&JointDef::initial_velocity_2>(
        "initial_velocity_2", {.dimension = angular_velocity, .doc = "rate about z of frame 2 at the start"})};

constexpr Field kCylindricalFields[] = {
    kBody1,
    kPoint1,
    kOrientation1,
    kBody2,
    kPoint2,
    kOrientation2,
    field<&JointDef::initial_velocity>("initial_angular_velocity",
                                       {.dimension = angular_velocity, .doc = "rate about z at the start"}),
    field<&JointDef::initial_velocity_2>("initial_velocity",
                                         {.dimension = velocity, .doc = "rate along z at the start"})};

constexpr Field kInPlaneFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2};
constexpr Field kInLineFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2};
constexpr Field kPerpendicularFields[] = {kBody1, kOrientation1, kBody2, kOrientation2};

constexpr Field kLength = field<&JointDef::length>(
    "length", {.dimension = length, .range = kNotNegative, .doc = "length of the link; 0: as the points stand"});
constexpr Field kLinkFields[] = {kBody1, kPoint1, kBody2, kPoint2, kLength};
constexpr Field kHingedLinkFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kLength};
constexpr Field kTwiceHingedLinkFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kOrientation2, kLength};

template <JointType Type>
void* append_joint(MechanicsDef& mechanics, std::string_view element) {
  JointDef& def = mechanics.joints.emplace_back();
  def.name = element;
  def.type = Type;
  return &def;
}

// in the order of JointType
constexpr ElementType kJointTypes[] = {
    {"revolute", "joint", "turns about z", kRevoluteFields, append_joint<JointType::revolute>},
    {"prismatic", "joint", "slides along z", kPrismaticFields, append_joint<JointType::prismatic>},
    {"spherical", "joint", "turns about a point", kSphericalFields, append_joint<JointType::spherical>},
    {"fixed", "joint", "merges the two bodies", kFixedFields, append_joint<JointType::fixed>},
    {"floating", "joint", "leaves body 2 free", kFloatingFields, append_joint<JointType::floating>},
    {"universal", "joint", "turns about z of frame 1 and about z of frame 2, which stay at a right angle",
     kUniversalFields, append_joint<JointType::universal>},
    {"cylindrical", "joint", "turns about z and slides along it", kCylindricalFields,
     append_joint<JointType::cylindrical>},
    {"in_plane", "joint", "keeps point 2 in the plane through point 1 with the normal z of frame 1", kInPlaneFields,
     append_joint<JointType::in_plane>},
    {"in_line", "joint", "keeps point 2 on the line through point 1 along z of frame 1", kInLineFields,
     append_joint<JointType::in_line>},
    {"perpendicular", "joint", "keeps z of frame 1 and z of frame 2 at a right angle", kPerpendicularFields,
     append_joint<JointType::perpendicular>},
    {"spherical_spherical", "joint", "massless link between point 1 and point 2, with a ball at either end",
     kLinkFields, append_joint<JointType::spherical_spherical>},
    {"revolute_spherical", "joint", "massless link: hinge about z of frame 1 at point 1, ball at point 2",
     kHingedLinkFields, append_joint<JointType::revolute_spherical>},
    {"revolute_revolute", "joint", "massless link: hinge about z of frame 1 at point 1, about z of frame 2 at point 2",
     kTwiceHingedLinkFields, append_joint<JointType::revolute_revolute>},
};

}  // namespace

std::span<const ElementType> joint_types() noexcept {
  return kJointTypes;
}

}  // namespace slew::multibody
