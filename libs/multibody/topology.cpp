#include "multibody/topology.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "core/index.h"
#include "multibody/joint_axes.h"

namespace slew::multibody {
namespace {

// a flexible body with modes, at a node of which the joint is
bool rides_on_modes(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return joint.type == JointType::node &&
         std::any_of(mechanics.flexible_bodies.begin(), mechanics.flexible_bodies.end(),
                     [&](const FlexibleBodyDef& body) { return body.body == joint.body1 && body.modes->modes() > 0; });
}

std::pair<int, int> bodies_of(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return {find_body(mechanics, joint.body1), find_body(mechanics, joint.body2)};
}

// Bodies that joints connect, by union of their sets.
class Groups {
 public:
  explicit Groups(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0); }
  // False when they were connected before.
  bool connect(int a, int b) {
    a = root_of(a);
    b = root_of(b);
    parent_[at(a)] = b;
    return a != b;
  }
  [[nodiscard]] int root_of(int body) const {
    while (parent_[at(body)] != body) body = parent_[at(body)];
    return body;
  }

 private:
  std::vector<int> parent_;
};

bool needs_coordinates(const JointDef& joint) noexcept {
  return has_row(axis_of(joint, 0)) || has_row(axis_of(joint, 1)) || is_given(joint.initial_velocity) ||
         is_given(joint.initial_velocity_2) || is_given(joint.initial_rotation);
}

bool is_driven(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return std::any_of(mechanics.motions.begin(), mechanics.motions.end(),
                     [&joint](const MotionDef& motion) { return motion.joint == joint.name; });
}

// their angles count whole turns, which those of cut joints do not
bool is_geared(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return std::any_of(mechanics.gears.begin(), mechanics.gears.end(),
                     [&joint](const GearDef& gear) { return gear.joint1 == joint.name || gear.joint2 == joint.name; });
}

// joints are taken into the tree by classes, within a class in the order of the file
int class_of(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  if (joint.type == JointType::fixed || joint.type == JointType::node) return 0;
  if (is_geared(mechanics, joint)) return 1;
  if (joint.type == JointType::floating) return 4;
  return needs_coordinates(joint) || is_driven(mechanics, joint) ? 2 : 3;
}

// is_barred, by joint: must be cut
std::vector<bool> choose_tree(const MechanicsDef& mechanics, const std::vector<bool>& is_barred) {
  std::vector<bool> is_in_tree(mechanics.joints.size(), false);
  Groups groups(mechanics.bodies.size() + 1);
  for (int choice = 0; choice < 5; ++choice) {
    for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
      const JointDef& joint = mechanics.joints[j];
      const auto [body1, body2] = bodies_of(mechanics, joint);
      const bool is_of_tree = has_coordinates(joint.type) || joint.type == JointType::node;
      if (body1 == kNoBody || body2 == kNoBody || !is_of_tree || is_barred[j] || class_of(mechanics, joint) != choice) {
        continue;
      }
      is_in_tree[j] = groups.connect(body1, body2);
    }
  }
  return is_in_tree;
}

std::vector<bool> connected_to_ground(const MechanicsDef& mechanics) {
  Groups groups(mechanics.bodies.size() + 1);
  for (const JointDef& joint : mechanics.joints) {
    const auto [body1, body2] = bodies_of(mechanics, joint);
    if (body1 != kNoBody && body2 != kNoBody) groups.connect(body1, body2);
  }
  std::vector<bool> is_connected(mechanics.bodies.size() + 1);
  for (std::size_t b = 0; b < is_connected.size(); ++b) {
    is_connected[b] = groups.root_of(static_cast<int>(b)) == groups.root_of(kGround);
  }
  return is_connected;
}

void report_unreached(const MechanicsDef& mechanics, const std::vector<bool>& is_reached, Problems& problems) {
  for (std::size_t b = 1; b < is_reached.size(); ++b) {
    if (is_reached[b]) continue;
    const std::string& name = mechanics.bodies[b - 1].name;
    bool has_joint = false;
    for (const JointDef& joint : mechanics.joints) has_joint |= joint.body1 == name || joint.body2 == name;
    problems.push_back({name,
                        has_joint ? "no chain of joints leads from this body to Ground" : "this body has no joint",
                        "a joint to Ground or to a body that is connected to it; type floating for a free body",
                        {}});
  }
}

void check_floating(const MechanicsDef& mechanics, Problems& problems) {
  for (const JointDef& joint : mechanics.joints) {
    if (joint.type != JointType::floating || joint.body1 == kGroundName) continue;
    problems.push_back({joint.name + ".body1",
                        "a floating joint starts from '" + joint.body1 + "'",
                        "Ground: a floating joint leaves body 2 free of every other body",
                        {}});
  }
}

}  // namespace

int find_body(const MechanicsDef& mechanics, std::string_view name) noexcept {
  if (name == kGroundName) return kGround;
  for (std::size_t i = 0; i < mechanics.bodies.size(); ++i) {
    if (mechanics.bodies[i].name == name) return static_cast<int>(i) + 1;
  }
  return kNoBody;
}

std::string_view body_name(const MechanicsDef& mechanics, int body) noexcept {
  return body == kGround ? kGroundName : std::string_view(mechanics.bodies[static_cast<std::size_t>(body) - 1].name);
}

bool merges(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return joint.type == JointType::fixed || (joint.type == JointType::node && !rides_on_modes(mechanics, joint));
}

bool has_coordinates(JointType type) noexcept {
  return type <= JointType::cylindrical;
}

namespace {

std::vector<TreeEdge> walk_tree(const MechanicsDef& mechanics, const std::vector<bool>& is_barred,
                                std::vector<bool>& is_reached) {
  const std::vector<bool> is_in_tree = choose_tree(mechanics, is_barred);
  std::vector<TreeEdge> tree;
  is_reached.assign(mechanics.bodies.size() + 1, false);
  is_reached[kGround] = true;
  // breadth first from Ground, joints in the order of the file
  std::vector<int> frontier = {kGround};
  std::size_t next = 0;
  const auto walk = [&] {
    for (; next < frontier.size(); ++next) {
      const int body = frontier[next];
      for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
        if (!is_in_tree[j]) continue;
        const auto [body1, body2] = bodies_of(mechanics, mechanics.joints[j]);
        if (body1 != body && body2 != body) continue;
        const int other = body1 == body ? body2 : body1;
        if (is_reached[at(other)]) continue;
        is_reached[at(other)] = true;
        tree.push_back({static_cast<int>(j), body, other, body1 == other});
        frontier.push_back(other);
      }
    }
  };
  walk();
  const std::vector<bool> is_connected = connected_to_ground(mechanics);
  for (std::size_t body = 1; body < is_reached.size(); ++body) {
    if (is_reached[body] || !is_connected[body]) continue;
    is_reached[body] = true;
    tree.push_back({kNoJoint, kGround, static_cast<int>(body), false});
    frontier.push_back(static_cast<int>(body));
    walk();
  }
  return tree;
}

// The joint by which the tree enters a flexible body at a node, whose frame it cannot find from there; kNoJoint: none.
int entry_at_a_node(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree) {
  for (const TreeEdge& edge : tree) {
    const bool is_node = edge.joint != kNoJoint && rides_on_modes(mechanics, mechanics.joints[at(edge.joint)]);
    if (!is_node || !edge.is_reversed) continue;
    const auto entry =
        std::find_if(tree.begin(), tree.end(), [&](const TreeEdge& e) { return e.child == edge.parent; });
    if (entry != tree.end()) return entry->joint;
  }
  return kNoJoint;
}

}  // namespace

std::vector<TreeEdge> find_tree(const MechanicsDef& mechanics, Problems& problems) {
  check_floating(mechanics, problems);
  std::vector<bool> is_barred(mechanics.joints.size(), false), is_reached;
  std::vector<TreeEdge> tree = walk_tree(mechanics, is_barred, is_reached);
  for (int entry = entry_at_a_node(mechanics, tree); entry != kNoJoint; entry = entry_at_a_node(mechanics, tree)) {
    is_barred[at(entry)] = true;
    tree = walk_tree(mechanics, is_barred, is_reached);
  }
  report_unreached(mechanics, is_reached, problems);
  return tree;
}

std::vector<int> cut_joints(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree) {
  std::vector<int> cuts;
  for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
    const auto is_this = [j](const TreeEdge& edge) { return edge.joint == static_cast<int>(j); };
    if (mechanics.joints[j].type == JointType::floating || std::any_of(tree.begin(), tree.end(), is_this)) continue;
    cuts.push_back(static_cast<int>(j));
  }
  return cuts;
}

std::vector<Pose> start_poses(const MechanicsDef& mechanics, Problems& problems) {
  const std::size_t count = mechanics.bodies.size() + 1;
  std::vector<Pose> poses(count);
  std::vector<bool> is_known(count, false);
  is_known[kGround] = true;
  // each sweep places the bodies whose reference is placed; a sweep without one means a cycle
  for (bool has_advanced = true; has_advanced;) {
    has_advanced = false;
    for (std::size_t b = 1; b < count; ++b) {
      const BodyDef& body = mechanics.bodies[b - 1];
      const int reference = find_body(mechanics, body.relative_to);
      if (is_known[b] || reference == kNoBody || !is_known[static_cast<std::size_t>(reference)]) continue;
      const Pose& base = poses[static_cast<std::size_t>(reference)];
      poses[b] = {base.R * math::rotation_zxz(body.orientation), base.p + base.R * math::Vec3(body.position)};
      is_known[b] = true;
      has_advanced = true;
    }
  }
  for (std::size_t b = 1; b < count; ++b) {
    const BodyDef& body = mechanics.bodies[b - 1];
    if (is_known[b] || find_body(mechanics, body.relative_to) == kNoBody) continue;
    problems.push_back({body.name + ".relative_to",
                        "the chain of relative_to from '" + body.name + "' does not end",
                        "a chain of bodies that ends at Ground",
                        {}});
  }
  return poses;
}

JointFrames joint_frames(const JointDef& joint, const Pose& body1, const Pose& body2) noexcept {
  return {{body1.R * math::rotation_xyz(joint.orientation1), body1.p + body1.R * math::Vec3(joint.point1)},
          {body2.R * math::rotation_xyz(joint.orientation2), body2.p + body2.R * math::Vec3(joint.point2)}};
}

double start_coordinate(JointType type, const JointFrames& frames) noexcept {
  const auto& [frame1, frame2] = frames;
  if (type == JointType::prismatic) return math::dot(frame1.R.c[2], frame2.p - frame1.p);
  return std::atan2(math::dot(frame1.R.c[1], frame2.R.c[0]), math::dot(frame1.R.c[0], frame2.R.c[0]));
}

std::vector<int> merged_into(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree) {
  std::vector<int> merged(mechanics.bodies.size() + 1);
  for (std::size_t b = 0; b < merged.size(); ++b) merged[b] = static_cast<int>(b);
  for (const TreeEdge& edge : tree) {
    if (edge.joint == kNoJoint || !merges(mechanics, mechanics.joints[at(edge.joint)])) continue;
    merged[static_cast<std::size_t>(edge.child)] = merged[static_cast<std::size_t>(edge.parent)];
  }
  return merged;
}

}  // namespace slew::multibody
