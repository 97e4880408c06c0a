#include "multibody/topology.h"

#include <cmath>
#include <cstddef>
#include <string>

namespace slew::multibody {
namespace {

// bodies from `from` towards Ground along the edges found so far
std::string way_to_ground(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree, int from) {
  std::string names(body_name(mechanics, from));
  while (from != kGround) {
    for (const TreeEdge& edge : tree) {
      if (edge.child != from) continue;
      from = edge.parent;
      names += " - " + std::string(body_name(mechanics, from));
      break;
    }
  }
  return names;
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

std::vector<TreeEdge> find_tree(const MechanicsDef& mechanics, Problems& problems) {
  std::vector<TreeEdge> tree;
  std::vector<bool> is_reached(mechanics.bodies.size() + 1, false);
  std::vector<bool> is_used(mechanics.joints.size(), false);
  is_reached[kGround] = true;
  check_floating(mechanics, problems);
  // breadth first from Ground, joints in the order of the file
  std::vector<int> frontier = {kGround};
  for (std::size_t next = 0; next < frontier.size(); ++next) {
    const int body = frontier[next];
    for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
      if (is_used[j]) continue;
      const int body1 = find_body(mechanics, mechanics.joints[j].body1);
      const int body2 = find_body(mechanics, mechanics.joints[j].body2);
      if (body1 == kNoBody || body2 == kNoBody || (body1 != body && body2 != body)) continue;
      is_used[j] = true;
      const int other = body1 == body ? body2 : body1;
      if (is_reached[static_cast<std::size_t>(other)]) {
        problems.push_back({mechanics.joints[j].name,
                            "this joint closes a loop: " + way_to_ground(mechanics, tree, other) + " and " +
                                way_to_ground(mechanics, tree, body),
                            "joints that form a tree; loops are not in this version",
                            {}});
        continue;
      }
      is_reached[static_cast<std::size_t>(other)] = true;
      tree.push_back({static_cast<int>(j), body, other, body1 == other});
      frontier.push_back(other);
    }
  }
  report_unreached(mechanics, is_reached, problems);
  return tree;
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
    if (mechanics.joints[static_cast<std::size_t>(edge.joint)].type != JointType::fixed) continue;
    merged[static_cast<std::size_t>(edge.child)] = merged[static_cast<std::size_t>(edge.parent)];
  }
  return merged;
}

}  // namespace slew::multibody
