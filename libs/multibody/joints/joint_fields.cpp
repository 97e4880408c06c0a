// SPDX-License-Identifier: Apache-2.0
#include "multibody/joints/joint_fields.h"

#include <array>

namespace slew::multibody {
namespace {

using enum Dimension;

constexpr Field kBody1 = field<&JointDef::body1>("body1", {.reference = "body", .doc = "first body"});
constexpr Field kPoint1 = field<&JointDef::point1>("point1", {.dimension = length, .doc = "joint's point in body 1"});
constexpr Field kOrientation1 = field<&JointDef::orientation1>(
    "orientation1", {.dimension = angle, .doc = "joint frame in body 1: rotations about x, y', z''"});
constexpr Field kBody2 =
    field<&JointDef::body2>("body2", {.presence = Presence::required, .reference = "body", .doc = "second body"});
constexpr Field kPoint2 = field<&JointDef::point2>("point2", {.dimension = length, .doc = "joint's point in body 2"});
constexpr Field kOrientation2 = field<&JointDef::orientation2>(
    "orientation2", {.dimension = angle, .doc = "joint frame in body 2: rotations about x, y', z''"});

// limits and friction of a coordinate, in its dimensions
struct AxisDimensions {
  Dimension coordinate, speed, stiffness, damping, force;
};
constexpr AxisDimensions kRotation{angle, angular_velocity, rotational_stiffness, rotational_damping, torque};
constexpr AxisDimensions kTranslation{length, velocity, stiffness, damping, force};

// keys of a coordinate, with its suffix
struct AxisKeys {
  std::string_view limit_min, limit_max, limit_stiffness, limit_damping, coulomb, viscous, friction_speed,
      bristle_stiffness, bristle_damping, breakaway_ratio;
};
constexpr AxisKeys kPlain{"limit_min",        "limit_max",        "limit_stiffness", "limit_damping",
                          "coulomb_friction", "viscous_friction", "friction_speed",  "bristle_stiffness",
                          "bristle_damping",  "breakaway_ratio"};
constexpr AxisKeys kFirst{"limit_min_1",        "limit_max_1",        "limit_stiffness_1", "limit_damping_1",
                          "coulomb_friction_1", "viscous_friction_1", "friction_speed_1",  "bristle_stiffness_1",
                          "bristle_damping_1",  "breakaway_ratio_1"};
constexpr AxisKeys kSecond{"limit_min_2",        "limit_max_2",        "limit_stiffness_2", "limit_damping_2",
                           "coulomb_friction_2", "viscous_friction_2", "friction_speed_2",  "bristle_stiffness_2",
                           "bristle_damping_2",  "breakaway_ratio_2"};
constexpr AxisKeys kAngle{"limit_min_angle",      "limit_max_angle",         "limit_stiffness_angle",
                          "limit_damping_angle",  "coulomb_friction_angle",  "viscous_friction_angle",
                          "friction_speed_angle", "bristle_stiffness_angle", "bristle_damping_angle",
                          "breakaway_ratio_angle"};

constexpr Range kFromOne{.min = 1, .min_is_open = false};

template <auto Axis>
constexpr std::array<Field, 10> axis_rows(const AxisDimensions& d, const AxisKeys& k) {
  using A = JointAxisDef;
  return {field<Axis, &A::limit_min>(k.limit_min, {.dimension = d.coordinate, .doc = "lower limit of the coordinate"}),
          field<Axis, &A::limit_max>(k.limit_max, {.dimension = d.coordinate, .doc = "upper limit of the coordinate"}),
          field<Axis, &A::limit_stiffness>(k.limit_stiffness, {.dimension = d.stiffness,
                                                               .range = kNotNegative,
                                                               .change = Change::live,
                                                               .doc = "spring of the limits; they push only"}),
          field<Axis, &A::limit_damping>(
              k.limit_damping,
              {.dimension = d.damping, .range = kNotNegative, .change = Change::live, .doc = "damper of the limits"}),
          field<Axis, &A::coulomb_friction>(
              k.coulomb, {.dimension = d.force, .range = kNotNegative, .change = Change::live, .doc = "dry friction"}),
          field<Axis, &A::viscous_friction>(
              k.viscous,
              {.dimension = d.damping, .range = kNotNegative, .change = Change::live, .doc = "viscous friction"}),
          field<Axis, &A::friction_speed>(
              k.friction_speed,
              {.dimension = d.speed,
               .range = kPositive,
               .doc = "speed that smooths dry friction, tanh(v / friction_speed); of bristles the Stribeck speed"}),
          field<Axis, &A::bristle_stiffness>(k.bristle_stiffness,
                                             {.dimension = d.stiffness,
                                              .range = kNotNegative,
                                              .doc = "bristles of the dry friction, which hold at rest; 0: none"}),
          field<Axis, &A::bristle_damping>(
              k.bristle_damping, {.dimension = d.damping, .range = kNotNegative, .doc = "damping of the bristles"}),
          field<Axis, &A::breakaway_ratio>(k.breakaway_ratio,
                                           {.range = kFromOne, .doc = "breakaway over dry friction, of bristles"})};
}

// of an angle
template <auto Axis>
constexpr std::array<Field, 1> turns_row(std::string_view key) {
  return {field<Axis, &JointAxisDef::start_turns>(
      key, {.range = {.min = -1e6, .max = 1e6},
            .doc = "whole turns of the coordinate at the start beyond the half turn of the poses"})};
}

template <std::size_t... Sizes>
constexpr auto joined(const std::array<Field, Sizes>&... parts) {
  std::array<Field, (Sizes + ...)> all{};
  std::size_t next = 0;
  const auto add = [&](const auto& part) {
    for (const Field& row : part) all[next++] = row;
  };
  (add(parts), ...);
  return all;
}

constexpr std::array<Field, 6> kFrames = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kOrientation2};

constexpr std::array<Field, 1> initial_velocity_row(const AxisDimensions& d) {
  return {field<&JointDef::initial_velocity>(
      "initial_velocity",
      {.dimension = d.speed, .doc = "rate of the coordinate at the start; none: 0, or that of a loop"})};
}

constexpr auto kRevoluteFields =
    joined(kFrames, initial_velocity_row(kRotation), axis_rows<&JointDef::first>(kRotation, kPlain),
           turns_row<&JointDef::first>("start_turns"));
constexpr auto kPrismaticFields =
    joined(kFrames, initial_velocity_row(kTranslation), axis_rows<&JointDef::first>(kTranslation, kPlain));

constexpr Field kInitialRotation = field<&JointDef::initial_rotation>(
    "initial_angular_velocity",
    {.dimension = angular_velocity,
     .doc = "angular velocity of body 2 seen from body 1 at the start, in its axes; none: 0, or that of a loop"});
constexpr Field kInitialTranslation = field<&JointDef::initial_translation>(
    "initial_velocity",
    {.dimension = velocity, .doc = "velocity of point 2 seen from body 1 at the start, in its axes"});

// all but the limits
constexpr auto friction_rows(const std::array<Field, 10>& all) {
  return std::array<Field, 6>{all[4], all[5], all[6], all[7], all[8], all[9]};
}
constexpr auto kSphericalFields = joined(kFrames, std::array<Field, 1>{kInitialRotation},
                                         friction_rows(axis_rows<&JointDef::first>(kRotation, kPlain)));

constexpr Field kFixedFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2, kOrientation2};

constexpr Field kFloatingFields[] = {kBody1,  kPoint1,       kOrientation1,       kBody2,
                                     kPoint2, kOrientation2, kInitialTranslation, kInitialRotation};

constexpr std::array<Field, 2> kUniversalSpeeds = {
    field<&JointDef::initial_velocity>("initial_velocity_1",
                                       {.dimension = angular_velocity, .doc = "rate about z of frame 1 at the start"}),
    field<&JointDef::initial_velocity_2>(
        "initial_velocity_2", {.dimension = angular_velocity, .doc = "rate about z of frame 2 at the start"})};
constexpr auto kUniversalFields =
    joined(kFrames, kUniversalSpeeds, axis_rows<&JointDef::first>(kRotation, kFirst),
           turns_row<&JointDef::first>("start_turns_1"), axis_rows<&JointDef::second>(kRotation, kSecond),
           turns_row<&JointDef::second>("start_turns_2"));

constexpr std::array<Field, 2> kCylindricalSpeeds = {
    field<&JointDef::initial_velocity>("initial_angular_velocity",
                                       {.dimension = angular_velocity, .doc = "rate about z at the start"}),
    field<&JointDef::initial_velocity_2>("initial_velocity",
                                         {.dimension = velocity, .doc = "rate along z at the start"})};
constexpr auto kCylindricalFields =
    joined(kFrames, kCylindricalSpeeds, axis_rows<&JointDef::first>(kRotation, kAngle),
           turns_row<&JointDef::first>("start_turns_angle"), axis_rows<&JointDef::second>(kTranslation, kPlain));

constexpr Field kInPlaneFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2};
constexpr Field kInLineFields[] = {kBody1, kPoint1, kOrientation1, kBody2, kPoint2};
constexpr Field kPerpendicularFields[] = {kBody1, kOrientation1, kBody2, kOrientation2};

constexpr Field kLength = field<&JointDef::length>(
    "length", {.dimension = length, .range = kNotNegative, .doc = "length of the link; 0: distance of the points"});
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
