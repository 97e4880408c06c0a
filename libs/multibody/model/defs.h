// SPDX-License-Identifier: Apache-2.0
// Definitions of mechanics: bodies, joints, forces and dummies, as plain structs.
//
// Frames. Right-handed. A body's pose is given relative to another body (or Ground): position of its origin, and
// successive Euler rotations z-x'-z'' (phi, theta, psi). A joint has a frame in each body: a point and successive
// rotations about x, y', z''. The joint's axis is the frames' z; its coordinate is the motion of frame 2 relative to
// frame 1, and its value at the start follows from the bodies' poses. `Ground` is predefined.
//
// field_tables.h binds every member that a scene may set to its key, dimension, range and default.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "multibody/constraints/gear_defs.h"
#include "multibody/contacts/contact_defs.h"
#include "multibody/flexible/flexible_def.h"
#include "multibody/flexible/segmented_def.h"
#include "multibody/forces/dummy_defs.h"
#include "multibody/forces/force_kinds.h"
#include "multibody/model/not_given.h"
#include "multibody/motions/motion_defs.h"

namespace slew::multibody {

inline constexpr std::string_view kGroundName = "Ground";
inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

enum class InertiaPoint : int { center_of_mass, body_origin };

// In the order of the body types of field_tables.h.
enum class BodyType : int { rigid, flexible, segmented };

// Shape of a flexible or segmented body at the start. equilibrium: under its load, where no loop or joint prevents it.
enum class StartShape : int { equilibrium, undeformed };

// One struct for all types; each type's field table lists the members that it has.
struct BodyDef {
  std::string name{};
  BodyType type = BodyType::rigid;
  std::string relative_to = "Ground";  // body that the pose refers to
  Triple position{};                   // m, origin in relative_to's frame
  Triple orientation{};                // rad, Euler z-x'-z''
  double mass = 0;                     // kg, > 0
  Triple center_of_mass{};             // m, body frame
  Triple inertia{};                    // kg m2, Ixx Iyy Izz in body axes; 0 0 0 is a point mass
  Triple products{};                   // kg m2, the tensor's elements Ixy Ixz Iyz (that is -integral x y dm, ...)
  InertiaPoint inertia_about = InertiaPoint::center_of_mass;
  // Members of a flexible or segmented body: files and the selection from them. Their contents are in
  // MechanicsDef::flexible_bodies and segmented_bodies.
  std::string flex_model{};                  // first part of the files' names; empty: the scene's name
  std::string flex_file_prefix{};            // second part
  std::string flex_modes{};                  // ordinals, "1;2", or "none"; empty: all
  double flex_frequency_limit = kUnlimited;  // Hz
  std::string relative_damping{};            // zeta by mode, "0.005;0.005", or one for all; empty: 0
  StartShape start_shape = StartShape::equilibrium;
  std::string modal_coordinates{};  // q at the start by mode, "0.01;0"; empty: by start_shape
  std::string modal_rates{};        // q' at the start by mode; empty: 0
  std::int64_t segments = 20;       // connectors of a segmented body
};

// Types from in_plane on have no coordinates of their own (topology.h): their rows are in constraint.h.
enum class JointType : int {
  revolute,
  prismatic,
  spherical,
  fixed,
  floating,
  universal,            // turns about z of frame 1, then about z of frame 2, which stands at a right angle to it:
                        // R_12 = Rz(q1) [y z x] Rz(q2)
  cylindrical,          // turns about z and slides along it
  in_plane,             // point 2 in the plane of frame 1 with the normal z
  in_line,              // point 2 on the line of frame 1 along z
  perpendicular,        // z of frame 2 at a right angle to z of frame 1
  spherical_spherical,  // massless link with a ball at either end
  revolute_spherical,   // massless link: hinge about z of frame 1, ball at point 2
  revolute_revolute,    // massless link: hinge about z of either frame
  node,                 // internal, not in scenes: body 2 is a node of the flexible body 1
};

// Friction and limits along one coordinate of a joint: joint_law.h.
struct JointAxisDef {
  double limit_min = -kUnlimited;  // rad or m
  double limit_max = kUnlimited;   // rad or m
  double limit_stiffness = 0;      // N m/rad or N/m
  double limit_damping = 0;        // N m s/rad or N s/m; a limit pushes only
  double coulomb_friction = 0;     // N m or N
  double viscous_friction = 0;     // N m s/rad or N s/m
  double friction_speed = 1e-3;    // rad/s or m/s, over which the Coulomb part is smoothed
  double bristle_stiffness = 0;    // N m/rad or N/m; > 0: bristles that hold at rest, instead of smoothing
  double bristle_damping = 0;      // N m s/rad or N s/m, of the bristles
  double breakaway_ratio = 1;      // breakaway over coulomb_friction, >= 1; falls with friction_speed
  std::int64_t start_turns = 0;    // whole turns that an angle has at the start beyond the (-pi, pi] of the poses
};

// One struct for every joint type; each type's field table lists the members that it has, in its own dimensions.
struct JointDef {
  std::string name{};
  JointType type = JointType::revolute;
  std::string body1 = "Ground";
  Triple point1{};        // m, body 1 frame
  Triple orientation1{};  // rad, successive x, y', z''
  std::string body2{};
  Triple point2{};        // m, body 2 frame
  Triple orientation2{};  // rad
  // Speeds at the start: given ones are kept where loops leave a choice.
  double initial_velocity = kNotGiven;      // rad/s or m/s; rad/s about z of frame 1 (universal, cylindrical)
  double initial_velocity_2 = kNotGiven;    // rad/s about z of frame 2 (universal); m/s along z (cylindrical)
  double length = 0;                        // m, length of a massless link; 0: distance of its points at the start
  Triple initial_translation = kNoneGiven;  // m/s, of point 2 seen from body 1, in body 1 axes (floating)
  Triple initial_rotation = kNoneGiven;     // rad/s, of body 2 seen from body 1, in body 1 axes (spherical, floating)
  JointAxisDef first{};                     // friction and limits of the first coordinate (joint_axes.h)
  JointAxisDef second{};                    // of the second
};

// Force along the line between a point of body 1 and a point of body 2; positive pushes them apart.
struct TranslationalForceDef {
  std::string name{};
  std::string body1{};
  Triple point1{};  // m, body 1 frame
  std::string body2{};
  Triple point2{};                  // m, body 2 frame
  double spring_constant = 0;       // N/m
  double damping_constant = 0;      // N s/m
  double free_length = 0;           // m, length at which the spring carries nothing
  double min_length = 0;            // m, below it the end damper pushes
  double max_length = kUnlimited;   // m, above it the end damper pulls back
  double end_spring_constant = 0;   // N/m, 0: no end dampers
  double end_damping_constant = 0;  // N s/m
  Table spring_table{};             // m beyond the free length, N that holds it; instead of spring_constant
  Table damper_table{};             // m/s, N; instead of damping_constant
};

// Torque about the axis f1 x g1 of body 1; the angle is that of f2 in the plane of f1 and g1, counted from f1 to g1.
struct RotationalForceDef {
  std::string name{};
  std::string body1{};
  Triple f1{0, 0, 1};  // direction, body 1 frame
  Triple g1{1, 0, 0};  // direction at a right angle to f1, body 1 frame
  std::string body2{};
  Triple f2{0, 0, 1};               // direction, body 2 frame
  double spring_constant = 0;       // N m/rad
  double damping_constant = 0;      // N m s/rad
  double free_angle = 0;            // rad
  double min_angle = -kUnlimited;   // rad
  double max_angle = kUnlimited;    // rad
  double end_spring_constant = 0;   // N m/rad, 0: no end dampers
  double end_damping_constant = 0;  // N m s/rad
  Table spring_table{};             // rad beyond the free angle, N m that holds it; instead of spring_constant
  Table damper_table{};             // rad/s, N m; instead of damping_constant
};

// Mass of a cylinder (index 1) or of a piston with its rod (index 2), carried by a translational force without
// degrees of freedom. Element frame: x = unit(P1 - P2), origin P1 for index 1 and P2 for index 2.
struct ForceDummyDef {
  std::string name{};
  std::string relative_to{};  // translational force
  std::int64_t index = 1;     // 1: at body 1's end, 2: at body 2's end
  double mass = 0;            // kg
  Triple center_of_mass{};    // m, element frame; on the x axis
  Triple inertia{};           // kg m2 about the centre of mass, element frame; Iyy = Izz, Ixx has no effect
};

// Mass fixed to a body.
struct StaticDummyDef {
  std::string name{};
  std::string relative_to = "Ground";  // body
  Triple position{};                   // m, in the body's frame
  Triple orientation{};                // rad, Euler z-x'-z''
  double mass = 0;                     // kg, 0: graphics only
  Triple center_of_mass{};             // m, dummy's frame
  Triple inertia{};                    // kg m2 about the centre of mass, dummy's frame
};

enum class Formulation : int { recursive, lagrange, augmented, penalty };

// Integration rule of a sub-step: integrators.h; index3_trapezoidal: body_penalty.h; own: own_integrator().
enum class Integrator : int {
  rk4,
  semi_implicit_euler,
  trapezoidal,
  generalised_alpha,
  sdirk2,
  index3_trapezoidal,
  own
};

// The lists of force kinds beyond spring-dampers (point_forces, bushings, ...) come with the table of kinds.
struct MechanicsDef : ForceKinds::Defs {
  // compiled once, in the source file, and not in every unit that holds one
  MechanicsDef();
  ~MechanicsDef();
  MechanicsDef(const MechanicsDef&);
  MechanicsDef(MechanicsDef&&) noexcept;
  MechanicsDef& operator=(const MechanicsDef&);
  MechanicsDef& operator=(MechanicsDef&&) noexcept;

  Triple gravity{0, -9.81, 0};  // m/s2
  Formulation formulation = Formulation::recursive;
  double assembly_tolerance = 1e-3;  // m and rad, largest violation of a joint at the start
  double max_substep = 1e-3;         // s, longest sub-step of the integrator
  double penalty_factor = 1e7;       // penalty mass of the joints' rows over the mechanism's mass (augmented, penalty)
  double penalty_damping = 1;        // xi, damping ratio of the rows (penalty)
  double penalty_frequency = 100;    // rad/s, omega_n of the rows (penalty)
  Integrator integrator = Integrator::own;
  double spectral_radius = 0.8;       // rho_inf of generalised_alpha, 0 .. 1: 1 damps nothing
  double iteration_tolerance = 1e-9;  // implicit integrators: error of speeds relative to the mechanism's speed or 1
                                      // m/s
  std::string payload;                // body that the machine lifts; empty: the end of the longest chain

  std::vector<BodyDef> bodies;
  std::vector<JointDef> joints;
  std::vector<TranslationalForceDef> translational_forces;
  std::vector<RotationalForceDef> rotational_forces;
  std::vector<ForceDummyDef> force_dummies;
  std::vector<StaticDummyDef> static_dummies;

  double contact_substep = 1e-4;  // s, longest sub-step while shapes touch or are about to
  std::vector<ShapeDef> shapes;
  std::vector<ContactPairDef> contacts;
  std::vector<FrictionDef> frictions;
  std::vector<PartDummyDef> part_dummies;
  std::vector<ConstraintDummyDef> constraint_dummies;
  std::vector<MotionDef> motions;
  std::vector<GearDef> gears;
  std::vector<FlexibleBodyDef> flexible_bodies;    // bodies of that type, filled when their files are read
  std::vector<SegmentedBodyDef> segmented_bodies;  // the same for segmented bodies
  std::vector<std::string> held_forces;            // forces of actuators, which hold their lengths and angles at the
                                                   // start; filled with the circuit's actuators
};

}  // namespace slew::multibody
