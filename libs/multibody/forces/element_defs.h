// What a scene says about force elements beyond spring-dampers, and about the masses that elements carry.
//
// Frames as in multibody/model/defs.h: a point and successive rotations about x, y', z'' in a body. A table is a
// monotone cubic through its points (math/monotone_cubic.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/field.h"

namespace slew::multibody {

// Axes that a load's direction keeps.
enum class LoadAxes : int { body, ground };

// Force at a point of a body: F = (force + force_table(t)) direction.
struct PointForceDef {
  std::string name{};
  std::string body{};
  Triple point{};             // m, body frame
  Triple direction{1, 0, 0};  // of any length but 0, in `axes`
  LoadAxes axes = LoadAxes::body;
  double force = 0;     // N
  Table force_table{};  // s, N; holds its last values
};

// Torque on a body: M = (torque + torque_table(t)) direction.
struct PointTorqueDef {
  std::string name{};
  std::string body{};
  Triple direction{1, 0, 0};
  LoadAxes axes = LoadAxes::body;
  double torque = 0;     // N m
  Table torque_table{};  // s, N m; holds its last values
};

// Where a connector's two frames lie.
struct ConnectorFrames {
  std::string body1{};
  Triple point1{};        // m, body 1 frame
  Triple orientation1{};  // rad
  std::string body2{};
  Triple point2{};        // m, body 2 frame
  Triple orientation2{};  // rad
};

// Tables of a bushing, by direction.
struct DirectionTables {
  Table x{}, y{}, z{};
  Table about_x{}, about_y{}, about_z{};

  [[nodiscard]] std::array<const Table*, 6> all() const { return {&x, &y, &z, &about_x, &about_y, &about_z}; }
};

struct BushingDef {
  std::string name{};
  ConnectorFrames frames{};
  Triple stiffness{};                      // N/m, along the axes of frame 1
  Triple rotational_stiffness{};           // N m/rad
  Triple damping{};                        // N s/m
  Triple rotational_damping{};             // N m s/rad
  std::vector<double> stiffness_matrix{};  // 36 numbers row by row, SI; added to the diagonal; none: zero
  std::vector<double> damping_matrix{};    // the same
  Triple preload_force{};                  // N, on body 2 without deflection
  Triple preload_moment{};                 // N m
  DirectionTables spring_tables{};         // m or rad, N or N m; go on with their last slopes
  DirectionTables damper_tables{};         // m/s or rad/s, N or N m; never fall beyond their ends
};

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

// Rope over points[k] on bodies[k].
struct RopeDef {
  std::string name{};
  std::vector<std::string> bodies{};
  std::vector<Triple> points{};  // m, each in its body's frame
  double free_length = 0;        // m
  double stiffness = 0;          // N/m, of the whole rope
  double axial_rigidity = 0;     // N, E times A: stiffness = axial_rigidity / free_length
  double damping_constant = 0;   // N s/m
  Table spring_table{};          // m of stretch, N; goes on with its last slope
  Table damper_table{};          // m/s, N; never falls beyond its ends
};

// Whether a tyre's wheel turns with the body that carries it.
enum class TyreRolling : int { free, with_body };

// Wheel with its mass and the forces of the ground on it. Dummy's frame: origin in the wheel's centre, z along the
// axle.
struct TyreDummyDef {
  std::string name{};
  std::string relative_to{};  // body
  Triple position{};          // m, wheel's centre in the body
  Triple orientation{};       // rad, Euler z-x'-z''
  double mass = 0;            // kg
  Triple inertia{};           // kg m2 about the centre, dummy's frame; Izz has no effect on a wheel that turns freely
  TyreRolling rolling = TyreRolling::free;
  double radius = 0;                    // m, without load
  Triple ground_normal{0, 1, 0};        // of any length but 0, Ground axes
  double ground_height = 0;             // m, of the plane along its normal, from Ground's origin
  double stiffness = 0;                 // N/m
  double damping = 0;                   // N s/m
  double friction = 0.8;                // largest friction over normal force
  double longitudinal_slip_slope = 10;  // friction over normal force, per slip
  double lateral_slip_slope = 10;       // the same per tangent of the slip angle
  double rolling_resistance = 0;        // share of the normal force
  double slip_speed = 0.1;              // m/s, below which slip is a damper
};

// Mass that one body carries, placed in the frame of another as it is at the start.
struct PartDummyDef {
  std::string name{};
  std::string relative_to = "Ground";  // body that position and orientation refer to
  std::string carried_by{};            // body that it is fixed to
  Triple position{};                   // m
  Triple orientation{};                // rad, Euler z-x'-z''
  double mass = 0;                     // kg
  Triple center_of_mass{};             // m, dummy's frame
  Triple inertia{};                    // kg m2 about the centre of mass, dummy's frame
};

// Mass of a joint's own part, fixed to the joint's frame on body 1 or on body 2.
struct ConstraintDummyDef {
  std::string name{};
  std::string relative_to{};  // joint
  std::int64_t index = 1;     // 1: frame on body 1, 2: frame on body 2
  Triple position{};          // m, in the joint's frame
  Triple orientation{};       // rad, Euler z-x'-z''
  double mass = 0;            // kg
  Triple center_of_mass{};    // m, dummy's frame
  Triple inertia{};           // kg m2 about the centre of mass, dummy's frame
};

}  // namespace slew::multibody
