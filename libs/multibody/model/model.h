// SPDX-License-Identifier: Apache-2.0
// The mechanism as flat arrays in depth order, ready for the recursion.
//
// A link is one or more bodies merged by fixed joints; link 0 is Ground. A link's frame sits at the child side of its
// joint with z along the joint's axis, so that the pose of link i in its parent is a fixed offset followed by the
// joint's motion. Coordinates q and speeds u by joint type:
//   revolute   q: angle                                  u: rate
//   prismatic  q: displacement                           u: rate
//   spherical  q: quaternion w x y z of the link in Ground   u: angular velocity seen from the parent, Ground axes
//   floating   q: position, quaternion of the link in Ground u: velocity of the link's origin, angular velocity
//   universal  q: angles about z of frame 1 and of frame 2   u: their rates
//   cylindrical q: angle, displacement                       u: their rates
//   node       none: it moves with its parent and the parent's modes (flexible/flexible_part.h)
// After those of the joints come the modal coordinates and speeds of the flexible parts.
// The joint's type is an enum, its kernels are picked by a switch in each pass: no virtual call per joint.
//
// A Model does not change during a step; live parameters change between steps through parameters.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/problem.h"
#include "math/rotation.h"
#include "multibody/constraints/gear.h"
#include "multibody/contacts/contact_elements.h"
#include "multibody/flexible/flexible_part.h"
#include "multibody/flexible/node_dummies.h"
#include "multibody/flexible/segmented_part.h"
#include "multibody/forces/element_set.h"
#include "multibody/joints/joint_law.h"
#include "multibody/model/defs.h"
#include "multibody/motions/drive.h"

namespace slew::multibody {

inline constexpr int kMaxJointRows = 6;

enum class LinkJoint : std::uint8_t { revolute, prismatic, spherical, floating, universal, cylindrical, node };

[[nodiscard]] constexpr int speed_count(LinkJoint joint) noexcept {
  switch (joint) {
    case LinkJoint::revolute:
    case LinkJoint::prismatic:
      return 1;
    case LinkJoint::universal:
    case LinkJoint::cylindrical:
      return 2;
    case LinkJoint::spherical:
      return 3;
    case LinkJoint::node:
      return 0;
    case LinkJoint::floating:
      break;
  }
  return 6;
}

struct Link {
  math::Mat3 R_PJ;  // joint frame in the parent link, at q = 0
  math::Vec3 p_PJ;  // m
  math::Mat3 I_L;   // kg m2, about the link's origin, link axes
  math::Vec3 h_L;   // kg m, mass times centre of mass, link axes
  double mass = 0;  // kg
  int parent = 0;   // link
  LinkJoint joint = LinkJoint::revolute;
  int q = 0;              // first entry in State::q
  int u = 0;              // first entry in State::u
  int first_coupled = 0;  // CoupledMass entries of this link's joint: [first_coupled, coupled_end)
  int coupled_end = 0;
  int node = -1;       // Model::nodes, for a link with LinkJoint::node
  int first_part = 0;  // flexible parts whose frame this link is: [first_part, part_end) of Model::parts
  int part_end = 0;
  int first_node_dummy = 0;  // Model::node_dummies across this link's joint: [first_node_dummy, node_dummy_end)
  int node_dummy_end = 0;
  bool is_driven = false;
  std::array<int, 2> drive = {-1, -1};  // Model::drives, by coordinate; -1: free
  [[nodiscard]] bool has_parts() const noexcept { return part_end > first_part; }
  [[nodiscard]] bool has_node_dummies() const noexcept { return node_dummy_end > first_node_dummy; }
};

// A mass fixed to a link: a body, a static dummy, a force dummy between merged bodies.
struct LumpedMass {
  math::Vec3 c_L;             // m, centre of mass, link frame
  math::Mat3 I_c;             // kg m2, about it, link axes, for reference_mass
  double mass = 0;            // kg, now
  double reference_mass = 0;  // kg, mass in the scene
  int link = 0;
  int owner = 0;  // body that carries it: itself, or a dummy's body; -1: two bodies, by Model::welded
};

struct Body {
  std::string name;
  math::Mat3 R_LB;  // pose in the link
  math::Vec3 p_LB;  // m
  math::Vec3 c_B;   // m, centre of mass, body frame
  math::Mat3 I_B;   // kg m2, about the centre of mass, body axes, for the reference mass
  int link = 0;
  int parent = -1;  // body, through the joint that holds it; Ground's is -1
  int joint = -1;   // that joint
  int lumped = -1;  // its LumpedMass
};

struct Joint {
  std::string name;
  JointType type = JointType::revolute;
  int body1 = 0, body2 = 0;
  math::Mat3 R_B1, R_B2;     // joint frames in their bodies
  math::Vec3 p_B1, p_B2;     // m
  int link = 0;              // link that it moves; 0 for a fixed and for a cut joint
  int cut = -1;              // Model::cuts
  bool is_reversed = false;  // the tree walks it from body 2 to body 1
};

// Linear law of a force element with its end dampers; lengths in m or rad.
struct ElementLaw {
  double spring = 0, damping = 0, free = 0;
  double min = 0, max = 0, end_spring = 0, end_damping = 0;
  bool is_active = false;                              // false: nothing to evaluate
  math::MonotoneCubic spring_curve{}, damper_curve{};  // instead of spring and damping
};

struct LineElement {
  std::string name;
  math::Vec3 p1, p2;  // m, points in their links
  int link1 = 0, link2 = 0;
  int body1 = 0, body2 = 0;
  ElementLaw law;
  bool is_used = false;  // by its law, a row or a dummy: evaluated at every stage
};

struct AngleElement {
  std::string name;
  math::Vec3 f1, g1, axis;  // unit, orthogonal, link 1
  math::Vec3 f2;            // unit, link 2
  int link1 = 0, link2 = 0;
  int body1 = 0, body2 = 0;
  ElementLaw law;
  bool has_row = false;
  bool is_coaxial = false;  // every joint between the links turns about this axis: angle = offset + sum(+-q)
  double offset = 0;        // rad
  int first_path = 0;       // entries of Model::paths from link 1 to link 2
  int path_end = 0;
};

// Dummies of one force: masses without degrees of freedom, whose points lie on a link and on its parent, on one link,
// or, with nodes of flexible bodies, as in flexible/node_dummies.h.
struct CoupledMass {
  int line = 0;   // LineElement
  int child = 0;  // link whose joint it spans; of one link: 0
  bool is_point1_on_child = false;
  double m1 = 0, c1 = 0;  // kg, m: cylinder; centre at P1 + c1 e
  double m2 = 0, c2 = 0;  // kg, m: piston; centre at P2 + c2 e
  double transverse = 0;  // kg m2, sum of both transverse moments about their centres
};

// A joint on the path between two links; sign +1: it moves the second link outwards, -1: the first.
struct PathEntry {
  int link = 0;
  double sign = 0;
  double turn = 0;  // for a coaxial AngleElement: d(angle)/dq, +1 or -1
};

// The laws of constraint rows: constraint.h.
enum class RowForm : std::uint8_t {
  in_plane,
  in_plane_of_2,
  perpendicular,
  distance,
  turn,         // angles that are coordinates: of x_2 about z_1
  first_turn,   // of z_2 about z_1
  second_turn,  // of x_2 about z_2
};

struct ConstraintRow {
  RowForm form = RowForm::in_plane;
  int axis1 = 0;      // 0 x, 1 y, 2 z: a, of frame 1
  int axis2 = 0;      // b, of frame 2
  double offset = 0;  // c [m or 1]
  int drive = -1;     // Model::drives: the row follows its law
};

// The rows of one joint between two links.
struct Constraint {
  int joint = 0;  // Model::joints
  int link1 = 0, link2 = 0;
  math::Mat3 R_L1, R_L2;  // frames in their links
  math::Vec3 p_L1, p_L2;  // m
  std::vector<ConstraintRow> rows;
  int node = -1;  // Model::nodes: frame 1 rides on the modes there
};

// A joint outside of the tree: its rows that are independent of the tree and of the cuts before it.
struct Cut : Constraint {
  int first_row = 0;      // among the rows of all cuts
  int first_support = 0;  // entries of Model::supports: all links between its bodies and Ground, outermost first
  int support_end = 0;
  std::vector<int> kept;                 // places of the kept rows in the order of rows_of(), by entry of `rows`
  std::vector<ConstraintRow> redundant;  // rows that the others imply in every position
  std::vector<int> left_out;             // their places in the order of rows_of()
};

enum class RowKind : std::uint8_t {
  length,
  angle,
  joint,
  ball  // about one axis of a spherical joint's frame 1; three in a row, the first of which has the law
};

// A scalar generalised coordinate through which a partner or a joint's law acts.
struct Row {
  RowKind kind = RowKind::joint;
  int element = 0;     // LineElement, AngleElement or Joint (joint, ball)
  int link = 0;        // link of a joint row; 0: the joint is cut
  int number = 0;      // joint row: number of the joint's coordinate; ball: number of the axis
  int place = 0;       // joint row: place of that coordinate among the link's
  int first_path = 0;  // entries of Model::paths
  int path_end = 0;
  int first_support = 0;  // entries of Model::supports: all links between its bodies and Ground, outermost first
  int support_end = 0;
  JointLaw law{};  // law of a joint row
  std::string name{};
};

// A speed that the scene gives for a cut joint.
struct GivenSpeed {
  int cut = 0;
  int number = 0;    // number of the joint's coordinate; for a spherical joint the axis of body 1
  double speed = 0;  // rad/s or m/s
};

// Numbers of the formulations that hold joints by penalties (body_penalty.h).
struct PenaltyNumbers {
  double factor = 0;     // alpha over the mechanism's mass
  double damping = 0;    // xi
  double frequency = 0;  // omega_n [rad/s]
};

struct Model {
  // compiled once, in the source file, and not in every unit that holds one
  Model();
  ~Model();
  Model(const Model&);
  Model(Model&&) noexcept;
  Model& operator=(const Model&);
  Model& operator=(Model&&) noexcept;

  math::Vec3 gravity;         // m/s2, Ground axes
  double max_substep = 1e-3;  // s
  PenaltyNumbers penalty;
  std::vector<Link> links;          // [0] is Ground
  std::vector<FlexiblePart> parts;  // by link
  std::vector<FlexibleNode> nodes;
  std::vector<SegmentedPart> segmented;  // in the order of the scene
  std::vector<LumpedMass> lumped;
  std::vector<CoupledMass> coupled;     // by child link, then those of node_dummies
  std::vector<NodeDummy> node_dummies;  // by child link
  std::vector<CoupledMass> welded;      // within one link: lumped into it, but carried by both bodies of their line
  std::vector<LineElement> lines;
  std::vector<AngleElement> angles;
  ElementSet elements;  // all other kinds
  std::vector<PathEntry> paths;
  std::vector<int> supports;
  std::vector<Row> rows;
  std::vector<Body> bodies;  // [0] is Ground
  std::vector<Joint> joints;
  std::vector<Cut> cuts;
  std::vector<Drive> drives;          // prescribed coordinates, in the order of the scene
  std::vector<Gear> gears;            // whose rows come after those of the cuts
  std::vector<Gear> idle_gears;       // gears that the joints and the gears before them imply in every position
  std::vector<double> cut_reference;  // 1/kg or 1/(kg m2), by closing row: a mobility that is not near zero
  std::vector<int> body_order;        // bodies from Ground outwards, parents first; without Ground
  std::vector<double> start_q, start_u;
  bool rests_in_loops = false;       // flexible bodies of a mechanism with loops start at rest under their loads
  std::vector<char> start_is_given;  // by u: 1 where the scene gives the speed
  std::vector<GivenSpeed> given_speeds;
  std::shared_ptr<const ContactElements> contact;  // none: no pairs; immutable, the same for all copies

  [[nodiscard]] int coordinate_count() const noexcept { return static_cast<int>(start_q.size()); }
  [[nodiscard]] int speed_count() const noexcept { return static_cast<int>(start_u.size()); }
  [[nodiscard]] int cut_row_count() const noexcept {
    return cuts.empty() ? 0 : cuts.back().first_row + static_cast<int>(cuts.back().rows.size());
  }
  // Rows that the tree's coordinates do not satisfy by themselves: those of cuts, then one for each gear.
  [[nodiscard]] bool has_closing_rows() const noexcept { return !cuts.empty() || !gears.empty(); }
  [[nodiscard]] int closing_row_count() const noexcept { return cut_row_count() + static_cast<int>(gears.size()); }
  // Reference mobilities away from singular positions.
  [[nodiscard]] int degrees_of_freedom() const noexcept {
    int prescribed = 0;
    for (const Drive& drive : drives) prescribed += drive.link > 0 ? 1 : 0;
    return speed_count() - closing_row_count() - prescribed;
  }
  [[nodiscard]] int row_count() const noexcept { return static_cast<int>(rows.size()); }
};

// visit(place in State::q, place in State::u) for every modal coordinate.
template <typename Visit>
void for_each_mode(const Model& model, Visit visit) noexcept {
  for (const FlexiblePart& part : model.parts) {
    for (std::size_t k = 0; k < part.modes; ++k) {
      visit(static_cast<std::size_t>(part.q) + k, static_cast<std::size_t>(part.u) + k);
    }
  }
}

// Labels of the joints' coordinates that need a row because they have friction or limits, in the scene's order.
[[nodiscard]] std::vector<std::string> joint_rows(const MechanicsDef& mechanics);

// Appends a problem for every name that is neither a force nor a coordinate of a joint.
void validate_rows(const MechanicsDef& mechanics, std::span<const std::string> rows, Problems& problems);

// Pre-condition: validate() and validate_rows() found nothing. rows: names of translational forces (coordinate:
// length), rotational forces (angle) and coordinates of joints (row_label()), in the order of the rows.
// Allocates; not for a step.
[[nodiscard]] Model build_model(const MechanicsDef& mechanics, std::span<const std::string> rows = {});

// Index of a body, joint or row by name; -1 when there is none.
[[nodiscard]] int find_body(const Model& model, std::string_view name) noexcept;
[[nodiscard]] int find_joint(const Model& model, std::string_view name) noexcept;
[[nodiscard]] int find_row(const Model& model, std::string_view name) noexcept;
[[nodiscard]] std::string_view row_name(const Model& model, int row) noexcept;

// False if all constants are zero: the element then needs no evaluation.
[[nodiscard]] bool has_effect(const ElementLaw& law) noexcept;

// Whether each force element is evaluated at every stage, after a change of its law.
void mark_used_elements(Model& model) noexcept;

// Mass properties of a link from its lumped masses. Does not allocate.
void lump_link(Model& model, int link) noexcept;
// The same for all links.
void lump_links(Model& model) noexcept;

}  // namespace slew::multibody
