// SPDX-License-Identifier: Apache-2.0
#include "multibody/model/topology.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "core/index.h"
#include "multibody/joints/joint_axes.h"

namespace slew::multibody {
namespace {

// Number of cuts from which a tree with short paths to the cuts is searched, and the factor by which the paths of the
// file's order must be longer to use it: every body on a path couples the cut to all others behind it
// (closing_pattern.h).
constexpr std::size_t kManyCuts = 5, kLongWays = 2;

// a flexible body with modes that has a node at the joint
bool rides_on_modes(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return joint.type == JointType::node &&
         std::any_of(mechanics.flexible_bodies.begin(), mechanics.flexible_bodies.end(),
                     [&](const FlexibleBodyDef& body) { return body.body == joint.body1 && body.modes->modes() > 0; });
}

// The two bodies of each joint.
using JointEnds = std::vector<std::pair<int, int>>;

JointEnds ends_of_joints(const MechanicsDef& mechanics) {
  const BodyNumbers number_of(mechanics);
  JointEnds ends;
  ends.reserve(mechanics.joints.size());
  for (const JointDef& joint : mechanics.joints) ends.emplace_back(number_of(joint.body1), number_of(joint.body2));
  return ends;
}

// Bodies that joints connect, by union of their sets.
class Groups {
 public:
  explicit Groups(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0); }
  // False if they were connected before.
  bool connect(int a, int b) {
    a = root_of(a);
    b = root_of(b);
    parent_[at(a)] = b;
    return a != b;
  }
  // Shortens the path for the next search.
  [[nodiscard]] int root_of(int body) {
    while (parent_[at(body)] != body) body = parent_[at(body)] = parent_[at(parent_[at(body)])];
    return body;
  }

 private:
  std::vector<int> parent_;
};

bool needs_coordinates(const JointDef& joint) noexcept {
  return has_row(axis_of(joint, 0)) || has_row(axis_of(joint, 1)) || is_given(joint.initial_velocity) ||
         is_given(joint.initial_velocity_2) || is_given(joint.initial_rotation);
}

// Joints are taken into the tree by classes, within a class in the order of the file. Names of joints: driven by a
// motion; geared, whose angles count whole turns, which those of cut joints do not.
int class_of(const std::set<std::string_view>& driven, const std::set<std::string_view>& geared,
             const JointDef& joint) noexcept {
  if (joint.type == JointType::fixed || joint.type == JointType::node) return 0;
  if (geared.contains(joint.name)) return 1;
  if (joint.type == JointType::floating) return 4;
  return needs_coordinates(joint) || driven.contains(joint.name) ? 2 : 3;
}

bool may_be_in_tree(const JointDef& joint) noexcept {
  return has_coordinates(joint.type) || joint.type == JointType::node;
}

// Joints within a class by their number of joints from Ground, then in the order of the file.
std::vector<std::size_t> nearest_first(const MechanicsDef& mechanics, const JointEnds& ends) {
  std::vector<std::vector<int>> joined(mechanics.bodies.size() + 1);
  for (std::size_t j = 0; j < ends.size(); ++j) {
    const auto [body1, body2] = ends[j];
    const JointDef& joint = mechanics.joints[j];
    if (body1 == kNoBody || body2 == kNoBody || !may_be_in_tree(joint) || joint.type == JointType::floating) continue;
    joined[at(body1)].push_back(body2);
    joined[at(body2)].push_back(body1);
  }
  const std::size_t far = joined.size();
  std::vector<std::size_t> distance(joined.size(), far);
  distance[kGround] = 0;
  std::vector<int> frontier = {kGround};
  for (std::size_t next = 0; next < frontier.size(); ++next) {
    for (const int other : joined[at(frontier[next])]) {
      if (distance[at(other)] < far) continue;
      distance[at(other)] = distance[at(frontier[next])] + 1;
      frontier.push_back(other);
    }
  }
  const auto distance_of = [&](std::size_t j) {
    const auto [body1, body2] = ends[j];
    return body1 == kNoBody || body2 == kNoBody ? far : std::min(distance[at(body1)], distance[at(body2)]);
  };
  std::vector<std::size_t> order(ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t j, std::size_t k) { return distance_of(j) < distance_of(k); });
  return order;
}

// is_barred, by joint: must be cut; order: within a class
std::vector<bool> choose_tree(const MechanicsDef& mechanics, const JointEnds& ends, std::span<const std::size_t> order,
                              const std::vector<bool>& is_barred) {
  std::set<std::string_view> driven, geared;
  for (const MotionDef& motion : mechanics.motions) driven.insert(motion.joint);
  for (const GearDef& gear : mechanics.gears) geared.insert({gear.joint1, gear.joint2});
  std::vector<bool> is_in_tree(mechanics.joints.size(), false);
  Groups groups(mechanics.bodies.size() + 1);
  for (int choice = 0; choice < 5; ++choice) {
    for (const std::size_t j : order) {
      const JointDef& joint = mechanics.joints[j];
      const auto [body1, body2] = ends[j];
      if (body1 == kNoBody || body2 == kNoBody || !may_be_in_tree(joint) || is_barred[j] ||
          class_of(driven, geared, joint) != choice) {
        continue;
      }
      is_in_tree[j] = groups.connect(body1, body2);
    }
  }
  return is_in_tree;
}

std::vector<bool> connected_to_ground(const MechanicsDef& mechanics, const JointEnds& ends) {
  Groups groups(mechanics.bodies.size() + 1);
  for (const auto& [body1, body2] : ends) {
    if (body1 != kNoBody && body2 != kNoBody) groups.connect(body1, body2);
  }
  std::vector<bool> is_connected(mechanics.bodies.size() + 1);
  for (std::size_t b = 0; b < is_connected.size(); ++b) {
    is_connected[b] = groups.root_of(static_cast<int>(b)) == groups.root_of(kGround);
  }
  return is_connected;
}

void report_unreached(const MechanicsDef& mechanics, const JointEnds& ends, const std::vector<bool>& is_reached,
                      Problems& problems) {
  std::vector<bool> has_joint(is_reached.size(), false);
  for (const auto& [body1, body2] : ends) {
    if (body1 != kNoBody) has_joint[at(body1)] = true;
    if (body2 != kNoBody) has_joint[at(body2)] = true;
  }
  for (std::size_t b = 1; b < is_reached.size(); ++b) {
    if (is_reached[b]) continue;
    const std::string& name = mechanics.bodies[b - 1].name;
    problems.push_back({name,
                        has_joint[b] ? "no chain of joints leads from this body to Ground" : "this body has no joint",
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

BodyNumbers::BodyNumbers(const MechanicsDef& mechanics) {
  numbers_.reserve(mechanics.bodies.size() + 1);
  numbers_.emplace(kGroundName, kGround);
  for (std::size_t i = 0; i < mechanics.bodies.size(); ++i) {
    numbers_.emplace(mechanics.bodies[i].name, static_cast<int>(i) + 1);
  }
}

int BodyNumbers::operator()(std::string_view name) const noexcept {
  const auto found = numbers_.find(name);
  return found == numbers_.end() ? kNoBody : found->second;
}

std::string_view body_name(const MechanicsDef& mechanics, int body) noexcept {
  return body == kGround ? kGroundName : std::string_view(mechanics.bodies[static_cast<std::size_t>(body) - 1].name);
}

bool merges(const MechanicsDef& mechanics, const JointDef& joint) noexcept {
  return joint.type == JointType::fixed || (joint.type == JointType::node && !rides_on_modes(mechanics, joint));
}

bool has_coordinates(JointType type) noexcept {
  return type < JointType::in_plane;
}

namespace {

// Joints of the tree by body, in the order of the file.
std::vector<std::vector<int>> joints_by_body(const MechanicsDef& mechanics, const JointEnds& ends,
                                             const std::vector<bool>& is_in_tree) {
  std::vector<std::vector<int>> joints(mechanics.bodies.size() + 1);
  for (std::size_t j = 0; j < ends.size(); ++j) {
    if (!is_in_tree[j]) continue;
    joints[at(ends[j].first)].push_back(static_cast<int>(j));
    joints[at(ends[j].second)].push_back(static_cast<int>(j));
  }
  return joints;
}

std::vector<TreeEdge> walk_tree(const MechanicsDef& mechanics, const JointEnds& ends,
                                std::span<const std::size_t> order, const std::vector<bool>& is_barred,
                                std::vector<bool>& is_reached) {
  const std::vector<bool> is_in_tree = choose_tree(mechanics, ends, order, is_barred);
  const std::vector<std::vector<int>> joints = joints_by_body(mechanics, ends, is_in_tree);
  std::vector<TreeEdge> tree;
  is_reached.assign(mechanics.bodies.size() + 1, false);
  is_reached[kGround] = true;
  // breadth first from Ground, joints in the order of the file
  std::vector<int> frontier = {kGround};
  std::size_t next = 0;
  const auto walk = [&] {
    for (; next < frontier.size(); ++next) {
      const int body = frontier[next];
      for (const int j : joints[at(body)]) {
        const auto [body1, body2] = ends[at(j)];
        const int other = body1 == body ? body2 : body1;
        if (is_reached[at(other)]) continue;
        is_reached[at(other)] = true;
        tree.push_back({j, body, other, body1 == other});
        frontier.push_back(other);
      }
    }
  };
  walk();
  const std::vector<bool> is_connected = connected_to_ground(mechanics, ends);
  for (std::size_t body = 1; body < is_reached.size(); ++body) {
    if (is_reached[body] || !is_connected[body]) continue;
    is_reached[body] = true;
    tree.push_back({kNoJoint, kGround, static_cast<int>(body), false});
    frontier.push_back(static_cast<int>(body));
    walk();
  }
  return tree;
}

// The joint by which the tree enters a flexible body at a node, from which its frame cannot be found; kNoJoint: none.
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

std::vector<TreeEdge> spanning_tree(const MechanicsDef& mechanics, const JointEnds& ends,
                                    std::span<const std::size_t> order, std::vector<bool>& is_reached) {
  std::vector<bool> is_barred(mechanics.joints.size(), false);
  std::vector<TreeEdge> tree = walk_tree(mechanics, ends, order, is_barred, is_reached);
  for (int entry = entry_at_a_node(mechanics, tree); entry != kNoJoint; entry = entry_at_a_node(mechanics, tree)) {
    is_barred[at(entry)] = true;
    tree = walk_tree(mechanics, ends, order, is_barred, is_reached);
  }
  return tree;
}

// bodies between the cut joints and Ground, summed over the cuts
std::size_t ways_of_cuts(const MechanicsDef& mechanics, const JointEnds& ends, const std::vector<TreeEdge>& tree) {
  std::vector<std::size_t> depth(mechanics.bodies.size() + 1, 0);
  for (const TreeEdge& edge : tree) depth[at(edge.child)] = depth[at(edge.parent)] + 1;
  std::size_t ways = 0;
  for (const int cut : cut_joints(mechanics, tree)) {
    const auto [body1, body2] = ends[at(cut)];
    if (body1 != kNoBody && body2 != kNoBody) ways += depth[at(body1)] + depth[at(body2)];
  }
  return ways;
}

}  // namespace

std::vector<TreeEdge> find_tree(const MechanicsDef& mechanics, Problems& problems) {
  check_floating(mechanics, problems);
  std::vector<bool> is_reached;
  const JointEnds ends = ends_of_joints(mechanics);
  std::vector<std::size_t> order(ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<TreeEdge> tree = spanning_tree(mechanics, ends, order, is_reached);
  if (mechanics.joints.size() >= tree.size() + kManyCuts) {
    std::vector<TreeEdge> nearest = spanning_tree(mechanics, ends, nearest_first(mechanics, ends), is_reached);
    if (ways_of_cuts(mechanics, ends, tree) > kLongWays * ways_of_cuts(mechanics, ends, nearest)) {
      tree = std::move(nearest);
    }
  }
  report_unreached(mechanics, ends, is_reached, problems);
  return tree;
}

std::vector<int> cut_joints(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree) {
  std::vector<bool> is_in_tree(mechanics.joints.size(), false);
  for (const TreeEdge& edge : tree) {
    if (edge.joint != kNoJoint) is_in_tree[at(edge.joint)] = true;
  }
  std::vector<int> cuts;
  for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
    if (mechanics.joints[j].type == JointType::floating || is_in_tree[j]) continue;
    cuts.push_back(static_cast<int>(j));
  }
  return cuts;
}

std::vector<Pose> start_poses(const MechanicsDef& mechanics, Problems& problems) {
  const std::size_t count = mechanics.bodies.size() + 1;
  const BodyNumbers number_of(mechanics);
  std::vector<int> reference(count, kNoBody);
  for (std::size_t b = 1; b < count; ++b) reference[b] = number_of(mechanics.bodies[b - 1].relative_to);
  std::vector<Pose> poses(count);
  enum class Place : std::uint8_t { open, asked, known, none };
  std::vector<Place> place(count, Place::open);
  place[kGround] = Place::known;
  // from each body along its references to a placed one, and back; a body visited twice is in a cycle
  std::vector<std::size_t> chain;
  for (std::size_t first = 1; first < count; ++first) {
    std::size_t b = first;
    for (; place[b] == Place::open; b = at(reference[b])) {
      place[b] = Place::asked;
      chain.push_back(b);
      if (reference[b] == kNoBody) break;
    }
    const bool is_placed = place[b] == Place::known;
    for (; !chain.empty(); chain.pop_back()) {
      b = chain.back();
      place[b] = is_placed ? Place::known : Place::none;
      if (!is_placed) continue;
      const BodyDef& body = mechanics.bodies[b - 1];
      const Pose& base = poses[at(reference[b])];
      poses[b] = {base.R * math::rotation_zxz(body.orientation), base.p + base.R * math::Vec3(body.position)};
    }
  }
  for (std::size_t b = 1; b < count; ++b) {
    const BodyDef& body = mechanics.bodies[b - 1];
    if (place[b] == Place::known || reference[b] == kNoBody) continue;
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
