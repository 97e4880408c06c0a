#include "multibody/flexible/expand_nodes.h"

#include <algorithm>
#include <cstddef>
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
    // bodies first that something is placed at, so that their order is that of the file
    for (JointDef& joint : def_.joints) attach(joint.body1, joint.point1), attach(joint.body2, joint.point2);
    for (TranslationalForceDef& force : def_.translational_forces) {
      attach(force.body1, force.point1), attach(force.body2, force.point2);
    }
    for (RotationalForceDef& force : def_.rotational_forces) attach(force.body1), attach(force.body2);
    for (StaticDummyDef& dummy : def_.static_dummies) attach(dummy.relative_to, dummy.position);
    for (ShapeDef& shape : def_.shapes) attach(shape.body, shape.position);
    for (PointForceDef& force : def_.point_forces) attach(force.body, force.point);
    for (PointTorqueDef& torque : def_.point_torques) attach(torque.body);
    for (BushingDef& bushing : def_.bushings) attach(bushing.frames);
    for (BeamDef& beam : def_.beams) attach(beam.frames);
    for (RopeDef& rope : def_.ropes) {
      for (std::size_t k = 0; k < rope.bodies.size(); ++k) attach(rope.bodies[k], rope.points[k]);
    }
    for (TyreDummyDef& tyre : def_.tyre_dummies) attach(tyre.relative_to, tyre.position);
    for (PartDummyDef& dummy : def_.part_dummies) attach(dummy.carried_by);
    def_.bodies.insert(def_.bodies.end(), nodes_.begin(), nodes_.end());
    def_.joints.insert(def_.joints.end(), holds_.begin(), holds_.end());
    return std::move(def_);
  }

 private:
  static BodyDef* find(std::vector<BodyDef>& bodies, const std::string& name) {
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [&](const BodyDef& body) { return body.name == name; });
    return found == bodies.end() ? nullptr : &*found;
  }

  // the body of a node, made where it is new
  std::string use(const FlexibleBodyDef& flexible, std::size_t index) {
    const ModalNode& node = flexible.modes->nodes[index];
    std::string name = node_name(flexible.body, node.id);
    if (!used_.insert(name).second) return name;
    nodes_.push_back({.name = name, .relative_to = flexible.body, .position = node.position.array()});
    holds_.push_back({.name = name,
                      .type = JointType::node,
                      .body1 = flexible.body,
                      .point1 = node.position.array(),
                      .body2 = name});
    return name;
  }

  [[nodiscard]] static std::size_t nearest(const ModalBody& modes, Vec3 point) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < modes.nodes.size(); ++i) {
      if (norm(modes.nodes[i].position - point) < norm(modes.nodes[best].position - point)) best = i;
    }
    return best;
  }

  void attach(std::string& body, Triple& point) {
    for (const FlexibleBodyDef& flexible : def_.flexible_bodies) {
      const ModalBody& modes = *flexible.modes;
      if (body == flexible.body) {
        const std::size_t index = nearest(modes, Vec3(point));
        if (static_cast<int>(index) == modes.root) return;
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
    Triple origin{};
    attach(body, origin);
  }
  void attach(ConnectorFrames& frames) { attach(frames.body1, frames.point1), attach(frames.body2, frames.point2); }

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

std::string node_name(const std::string& body, std::int64_t id) {
  return body + ".Node" + std::to_string(id);
}

MechanicsDef with_nodes(const MechanicsDef& mechanics) {
  return Expander(mechanics).run();
}

}  // namespace slew::multibody
