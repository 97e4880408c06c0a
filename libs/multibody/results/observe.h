// SPDX-License-Identifier: Apache-2.0
// Results of a mechanism at an instant: energies, joint reactions, variables, a description.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/element_variable.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// Motion of all links and elements at the state; call it before the readings below that take a Workspace. Cheap, does
// not allocate.
void observe(const Model& model, const State& state, Workspace& ws) noexcept;
// The same where ws shows the motion of the state already, as evaluate() of dynamics.h leaves it: what it left out.
void observe_elements(const Model& model, const State& state, Workspace& ws) noexcept;

// Kinetic energy of all masses; potential energy of gravity (zero at Ground's origin) and of the elements' springs,
// end dampers included, of the springs of contacts and of their bristles. The owner of the rows accounts for joint
// limits. [J]
struct Energy {
  double kinetic = 0, potential = 0;
};
[[nodiscard]] Energy energy(const Model& model, const Workspace& ws) noexcept;

// Linear momentum, and angular momentum about Ground's origin, of all moving masses [kg m/s, kg m2/s].
struct Momentum {
  Triple linear{}, angular{};
};
[[nodiscard]] Momentum momentum(const Model& model, const Workspace& ws) noexcept;

// Pose of a body's origin in Ground, by its index in the model (0: Ground).
struct BodyPose {
  Triple position{};                    // m
  std::array<double, 4> orientation{};  // quaternion w x y z
  Triple center_of_mass{};              // m
  Triple velocity{};                    // m/s, of the origin
  Triple angular_velocity{};            // rad/s, Ground axes
};
[[nodiscard]] BodyPose body_pose(const Model& model, const Workspace& ws, int body) noexcept;

// Joint reactions. If redundant rows leave them open: those with the smallest sum of squares of all joints' forces [N]
// and moments [N m].
//
// Newton and Euler over the bodies of the scene with the accelerations that the given row forces cause. reactions: one
// per joint of the scene. Runs a forward dynamics; does not allocate.
void joint_reactions(const Model& model, const State& state, Workspace& ws, std::span<const double> row_forces,
                     std::span<JointReaction> reactions) noexcept;

// Variables of bodies ("Bag.position.y"), joints with one coordinate ("Body_Pillar.position"), forces
// ("ForceT_Lift.length") and energies ("mechanics.kinetic_energy"), in a fixed order; allocates.
[[nodiscard]] std::vector<ElementVariable> variables(const Model& model);

// Values in the order of variables(), after observe(). row_forces: forces of the rows at this instant, shown as the
// `force` of their element or joint together with its own law; empty: zero.
void read_variables(const Model& model, const State& state, const Workspace& ws, std::span<const double> row_forces,
                    std::span<double> values) noexcept;

// Variables of the pairs of shapes ("Bag_Truck.normal_force.y"), part of variables() and read_variables(): number of
// points, largest depth, sums of the normal and the friction forces on shape A, centre of pressure. Returns how many
// values were written.
void append_contact_variables(const Model& model, std::vector<ElementVariable>& variables);
std::size_t read_contact_variables(const Model& model, const Workspace& ws, std::span<double> values) noexcept;

// True if a flexible part is bent by more than a tenth of its length at coordinates q: beyond small deflections.
[[nodiscard]] bool is_bent_far(const Model& model, std::size_t part, std::span<const double> q) noexcept;
// True if two neighbours of a segmented body are turned by more than kLargestBend against each other.
[[nodiscard]] bool is_bent_far(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept;

// Largest deflection of a flexible part at coordinates q, and of a segmented body against its root after a motion in
// ws, over the body's length [1].
[[nodiscard]] double deflection_share(const Model& model, std::size_t part, std::span<const double> q) noexcept;
[[nodiscard]] double deflection_share(const Model& model, const SegmentedPart& part, const Workspace& ws) noexcept;

// Reactions of every joint, as "Joint.reaction_force.x" and "Joint.reaction_moment.x": six for each joint of the scene,
// in the order and form of JointReaction; then "Gear.torque_1" and "Gear.force_2" (or "Gear.torque_2" ...), the forces
// of a gear's row on the coordinates of its joints; then "Motion.torque" or "Motion.force", and "Motion.power", for
// each prescribed motion. Allocates.
[[nodiscard]] std::vector<ElementVariable> reaction_variables(const Model& model);

// Values in the order of reaction_variables(), after joint_reactions() with this workspace. Does not allocate.
void read_reactions(const Model& model, const Workspace& ws, std::span<const double> row_forces,
                    std::span<const JointReaction> reactions, std::span<double> values) noexcept;

// Force of a prescribed motion on its coordinate, positive when it pushes the coordinate to grow [N or N m]: the
// joint's reaction along it, less the joint's own friction and limits. After joint_reactions() with this workspace.
[[nodiscard]] double drive_force(const Model& model, const Workspace& ws, std::size_t drive,
                                 std::span<const double> row_forces, std::span<const JointReaction> reactions) noexcept;

// Name of the joint that a coordinate (index < coordinates) or a speed (counted on from there) belongs to.
[[nodiscard]] std::string_view joint_of(const Model& model, int state_index) noexcept;

// For `slewring describe`.
struct LinkDescription {
  std::string joint;  // joint that moves it
  std::string joint_type;
  int degrees_of_freedom = 0;
  std::vector<std::string> bodies;  // bodies merged into it
};
// A joint that closes a loop, or has no coordinates.
struct CutDescription {
  std::string joint;
  std::string joint_type;
  int rows = 0;                        // number of added rows
  std::vector<std::string> redundant;  // "row 3 (angle between x and z of body 2)": implied by others
};
struct Description {
  int bodies = 0;  // bodies of the scene, without Ground
  int joints = 0;
  int degrees_of_freedom = 0;
  int rows = 0;
  std::vector<LinkDescription> links;
  std::vector<CutDescription> cuts;
  std::vector<std::string> gears;            // "Slew_Gear (Pinion_Axis, Slew_Joint)", those that others imply too
  std::vector<std::string> idle_gears;       // names of the implied gears
  std::vector<std::string> driven;           // "Crank_Drive (Crank_Pin, angle)": prescribed motions
  std::vector<std::string> flexible;         // "Boom: 2 modes of 51.29 to 51.29 rad/s, nodes Boom.Node20 in use"
  std::vector<std::string> fixed_to_ground;  // bodies that do not move
  std::vector<std::string> pairs;            // tested pairs of shapes
  std::vector<std::string>
      pairs_at_rest;  // untested pairs: their shapes cannot move against each other, or the scene excludes them
};
[[nodiscard]] Description describe(const Model& model);

}  // namespace slew::multibody
