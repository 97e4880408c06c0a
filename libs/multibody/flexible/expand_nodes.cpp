// SPDX-License-Identifier: Apache-2.0
#include "multibody/flexible/expand_nodes.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

class Expander {
 public:
  explicit Expander(const MechanicsDef& mechanics) : def_(mechanics) {}

  MechanicsDef run() {
    for (const FlexibleBodyDef& flexible : def_.flexible_bodies) {
      take_mass(*flexible.modes, *find(def_.bodies, flexible.body));
    }
    for (const SegmentedBodyDef& segmented : def_.segmented_bodies) add_lumps(segmented);
    // bodies with attached elements first, so that their order is that of the file
    for (JointDef& joint : def_.joints) attach(joint.body1, joint.point1), attach(joint.body2, joint.point2);
    for (TranslationalForceDef& force : def_.translational_forces) {
      attach(force.body1, force.point1), attach(force.body2, force.point2);
    }
    for (RotationalForceDef& force : def_.rotational_forces) attach(force.body1), attach(force.body2);
    for (StaticDummyDef& dummy : def_.static_dummies) attach(dummy.relative_to, dummy.position);
    for (ShapeDef& shape : def_.shapes) attach(shape.body, shape.position);
    const VisitPoint attach_point = [this](std::string& body, Triple* point) {
      point == nullptr ? attach(body) : attach(body, *point);
    };
    for_each_force_type(def_, [&](auto row, const auto& /*type*/, auto& defs) {
      for (auto& def : defs) row.visit_points(def, attach_point);
    });
    for (PartDummyDef& dummy : def_.part_dummies) attach(dummy.carried_by);
    def_.bodies.insert(def_.bodies.end(), nodes_.begin(), nodes_.end());
    def_.joints.insert(def_.joints.end(), holds_.begin(), holds_.end());
    for (const SegmentedBodyDef& segmented : def_.segmented_bodies) free_lumps(segmented);
    return std::move(def_);
  }

 private:
  static BodyDef* find(std::vector<BodyDef>& bodies, const std::string& name) {
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [&](const BodyDef& body) { return body.name == name; });
    return found == bodies.end() ? nullptr : &*found;
  }

  // True at the root and at other clamped nodes: no mode moves the node in the body's frame.
  [[nodiscard]] static bool is_clamped(const ModalNode& node) {
    const auto is_zero = [](const Vec3& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; };
    return !node.shift.empty() && std::all_of(node.shift.begin(), node.shift.end(), is_zero) &&
           std::all_of(node.turn.begin(), node.turn.end(), is_zero) &&
           std::all_of(node.shortening.begin(), node.shortening.end(), is_zero);
  }

  // the body of a node, created if new
  std::string use(const FlexibleBodyDef& flexible, std::size_t index) {
    const ModalNode& node = flexible.modes->nodes[index];
    std::string name = node_name(flexible.body, node.id);
    if (!used_.insert(name).second) return name;
    nodes_.push_back({.name = name, .relative_to = flexible.body, .position = node.position.array()});
    holds_.push_back({.name = name,
                      .type = is_clamped(node) ? JointType::fixed : JointType::node,
                      .body1 = flexible.body,
                      .point1 = node.position.array(),
                      .body2 = name});
    return name;
  }

  void add_lumps(const SegmentedBodyDef& segmented) {
    const SegmentChain& chain = *segmented.chain;
    for (std::size_t i = 0; i < chain.lumps.size(); ++i) {
      const SegmentLump& lump = chain.lumps[i];
      const Mat3& J = lump.inertia;
      const auto fill = [&](BodyDef& body, Vec3 origin) {
        body.type = BodyType::rigid;
        body.mass = lump.mass;
        body.center_of_mass = (lump.centre - origin).array();
        body.inertia_about = InertiaPoint::center_of_mass;
        body.inertia = {J(0, 0), J(1, 1), J(2, 2)};
        body.products = {J(0, 1), J(0, 2), J(1, 2)};
      };
      if (i == chain.root) {
        fill(*find(def_.bodies, segmented.body), Vec3());
      } else {
        nodes_.push_back(
            {.name = lump_name(segmented, i), .relative_to = segmented.body, .position = lump.station.array()});
        fill(nodes_.back(), lump.station);
      }
    }
  }

  // a floating joint to Ground for every lump that no joint leads to
  void free_lumps(const SegmentedBodyDef& segmented) {
    std::map<std::string, std::string> group;
    const std::function<std::string(const std::string&)> group_of = [&](const std::string& name) {
      const auto known = group.find(name);
      return known == group.end() ? name : group_of(known->second);
    };
    const auto connect = [&](const JointDef& joint) {
      const std::string a = group_of(joint.body1), b = group_of(joint.body2);
      if (a != b) group[a] = b;
    };
    for (const JointDef& joint : def_.joints) connect(joint);
    const std::string ground(kGroundName);
    const auto release = [&](std::size_t lump) {
      const std::string name = lump_name(segmented, lump);
      if (group_of(name) == group_of(ground)) return;
      def_.joints.push_back({.name = name, .type = JointType::floating, .body1 = ground, .body2 = name});
      connect(def_.joints.back());
    };
    // a root without joints is free if joints hold other lumps; else the scene lacks a joint for the body
    const std::size_t root = segmented.chain->root, count = segmented.chain->lumps.size();
    bool is_held = false;
    for (std::size_t i = 0; i < count; ++i) {
      is_held = is_held || group_of(lump_name(segmented, i)) == group_of(ground);
    }
    if (is_held) release(root);
    for (std::size_t i = 0; i < count; ++i) {
      if (i != root) release(i);
    }
  }

  // the body of a node that rides on a lump, created if new
  std::string use(const SegmentedBodyDef& segmented, const SegmentNode& node) {
    std::string name = node_name(segmented.body, node.id);
    if (!used_.insert(name).second) return name;
    const std::string lump = lump_name(segmented, node.lump);
    const bool is_root = node.lump == segmented.chain->root;
    const Triple place = (node.position - (is_root ? Vec3() : segmented.chain->lumps[node.lump].station)).array();
    nodes_.push_back({.name = name, .relative_to = lump, .position = place});
    holds_.push_back({.name = name, .type = JointType::fixed, .body1 = lump, .point1 = place, .body2 = name});
    return name;
  }

  // true if the body belongs to a segmented one
  bool attach_to_lump(std::string& body, Triple& point) {
    for (const SegmentedBodyDef& segmented : def_.segmented_bodies) {
      const SegmentChain& chain = *segmented.chain;
      const auto nearer = [&](const auto& a, const auto& b) { return norm(a - Vec3(point)) < norm(b - Vec3(point)); };
      if (body == segmented.body) {
        const auto lump = static_cast<std::size_t>(
            std::min_element(chain.lumps.begin(), chain.lumps.end(),
                             [&](const auto& a, const auto& b) { return nearer(a.station, b.station); }) -
            chain.lumps.begin());
        if (lump == chain.root) return true;
        const auto node = std::min_element(chain.nodes.begin(), chain.nodes.end(), [&](const auto& a, const auto& b) {
          return nearer(a.position, b.position);
        });
        const bool has_node = node->lump == lump;
        body = has_node ? use(segmented, *node) : lump_name(segmented, lump);
        point = (Vec3(point) - (has_node ? node->position : chain.lumps[lump].station)).array();
        return true;
      }
      for (const SegmentNode& node : chain.nodes) {
        if (body == node_name(segmented.body, node.id)) return use(segmented, node), true;
      }
    }
    return false;
  }

  [[nodiscard]] static std::size_t nearest(const ModalBody& modes, Vec3 point) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < modes.nodes.size(); ++i) {
      if (norm(modes.nodes[i].position - point) < norm(modes.nodes[best].position - point)) best = i;
    }
    return best;
  }

  void attach(std::string& body, Triple& point) {
    if (attach_to_lump(body, point)) return;
    for (const FlexibleBodyDef& flexible : def_.flexible_bodies) {
      const ModalBody& modes = *flexible.modes;
      if (body == flexible.body) {
        const std::size_t index = nearest(modes, Vec3(point));
        if (static_cast<int>(index) == modes.root || is_clamped(modes.nodes[index])) return;
        body = use(flexible, index);
        point = (Vec3(point) - modes.nodes[index].position).array();
        return;
      }
      for (std::size_t index = 0; index < modes.nodes.size(); ++index) {
        if (body != node_name(flexible.body, modes.nodes[index].id)) continue;
        use(flexible, index);
        return;
      }
    }
  }
  // without a point: at the body's frame, or at the node that is named
  void attach(std::string& body) {
    for (const FlexibleBodyDef& flexible : def_.flexible_bodies) {
      if (body == flexible.body && flexible.modes->root >= 0) return;
    }
    for (const SegmentedBodyDef& segmented : def_.segmented_bodies) {
      if (body == segmented.body) return;
    }
    Triple origin{};
    attach(body, origin);
  }

  MechanicsDef def_;
  std::vector<BodyDef> nodes_;  // and the joints that hold them, in the order of their first use
  std::vector<JointDef> holds_;
  std::set<std::string> used_;
};

}  // namespace

void take_mass(const ModalBody& modes, BodyDef& body) noexcept {
  const Mat3& W = modes.second_moment;
  body.mass = modes.mass;
  body.center_of_mass = (modes.first_moment * (1 / modes.mass)).array();
  body.inertia_about = InertiaPoint::body_origin;
  body.inertia = {W(1, 1) + W(2, 2), W(0, 0) + W(2, 2), W(0, 0) + W(1, 1)};
  body.products = {-W(0, 1), -W(0, 2), -W(1, 2)};
}

void take_mass(const SegmentChain& chain, BodyDef& body) noexcept {
  double mass = 0;
  Vec3 first;
  Mat3 about;
  for (const SegmentLump& lump : chain.lumps) {
    const Vec3 c = lump.centre;
    mass += lump.mass;
    first += c * lump.mass;
    about = about + lump.inertia + (Mat3::diagonal(dot(c, c), dot(c, c), dot(c, c)) - outer(c, c)) * lump.mass;
  }
  body.mass = mass;
  body.center_of_mass = (first * (1 / mass)).array();
  body.inertia_about = InertiaPoint::body_origin;
  body.inertia = {about(0, 0), about(1, 1), about(2, 2)};
  body.products = {about(0, 1), about(0, 2), about(1, 2)};
}

std::string lump_name(const SegmentedBodyDef& segmented, std::size_t lump) {
  return lump == segmented.chain->root ? segmented.body : segmented.body + ".Segment" + std::to_string(lump + 1);
}

std::string node_name(const std::string& body, std::int64_t id) {
  return body + ".Node" + std::to_string(id);
}

MechanicsDef with_nodes(const MechanicsDef& mechanics) {
  return Expander(mechanics).run();
}

}  // namespace slew::multibody
