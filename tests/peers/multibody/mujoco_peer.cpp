// SPDX-License-Identifier: Apache-2.0
#include "tests/peers/multibody/mujoco_peer.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "multibody/model/topology.h"
#include "tests/peers/multibody/def_laws.h"

namespace slew::multibody::testing {
namespace {

using math::Mat3;
using math::Vec3;

std::string text(Vec3 a) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", a[0], a[1], a[2]);
}

std::string text(const Mat3& R) {
  const math::Quaternion q = math::quaternion_of(R);
  return fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", q.w, q.x, q.y, q.z);
}

// with principal axes of our own: those that MuJoCo's compiler finds are 4e-7 off
std::string inertial(double mass, Vec3 center, const Mat3& I) {
  Eigen::Matrix3d tensor;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) tensor(i, j) = I(i, j);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
  const Eigen::Matrix3d axes = solver.eigenvectors();
  const Eigen::Vector3d moments = solver.eigenvalues();
  const Vec3 x(axes(0, 0), axes(1, 0), axes(2, 0)), y(axes(0, 1), axes(1, 1), axes(2, 1));
  return fmt::format(R"(<inertial mass="{:.17g}" pos="{}" quat="{}" diaginertia="{}"/>)", mass, text(center),
                     text(Mat3{x, y, cross(x, y)}), text(Vec3(moments[0], moments[1], moments[2])));
}

// what the tree hangs on an edge, from the child's side
struct Connection {
  TreeEdge edge;
  Frame inner, outer;  // joint frames in parent and child
  Mat3 R_PC;           // pose of the child in the parent where the joint's frames are the same
  Vec3 p_PC;
};

Connection connection_of(const MechanicsDef& def, const TreeEdge& edge) {
  const JointDef& joint = def.joints[static_cast<std::size_t>(edge.joint)];
  Connection c{.edge = edge,
               .inner = edge.is_reversed ? frame2(joint) : frame1(joint),
               .outer = edge.is_reversed ? frame1(joint) : frame2(joint),
               .R_PC = {},
               .p_PC = {}};
  c.R_PC = c.inner.R * transpose(c.outer.R);
  c.p_PC = c.inner.p - c.R_PC * c.outer.p;
  return c;
}

}  // namespace

struct MujocoPeer::Simulation {
  explicit Simulation(const MechanicsDef& mechanics) : def(mechanics) {
    if (!def.force_dummies.empty()) throw std::invalid_argument("MuJoCo cannot have dummies on forces");
    Problems problems;
    for (const TreeEdge& edge : find_tree(def, problems)) connections.push_back(connection_of(def, edge));
    load(xml());
    data.reset(mj_makeData(model.get()));
    bodies.push_back(0);
    for (const BodyDef& body : def.bodies) bodies.push_back(mj_name2id(model.get(), mjOBJ_BODY, body.name.c_str()));
  }

  [[nodiscard]] std::string xml() const {
    return fmt::format(R"(<mujoco>
<compiler angle="radian" inertiafromgeom="false" balanceinertia="false" boundmass="0" boundinertia="0"/>
<option gravity="{}"><flag constraint="disable" contact="disable"/></option>
<worldbody>{}</worldbody>
</mujoco>)",
                       text(Vec3(def.gravity)), children_of(0));
  }

  [[nodiscard]] std::string children_of(int parent) const {
    std::string list;
    for (const Connection& c : connections) {
      if (c.edge.parent != parent) continue;
      const BodyDef& body = def.bodies[static_cast<std::size_t>(c.edge.child) - 1];
      const bool is_floating = joint_of(c).type == JointType::floating;
      list += fmt::format(R"(<body name="{}" pos="{}" quat="{}">)", body.name, text(is_floating ? Vec3() : c.p_PC),
                          text(is_floating ? Mat3::identity() : c.R_PC)) +
              inertial(body.mass, Vec3(body.center_of_mass), central_inertia(body)) + joint(c) +
              static_dummies_of(body.name) + children_of(c.edge.child) + "</body>\n";
    }
    return list;
  }

  [[nodiscard]] const JointDef& joint_of(const Connection& c) const {
    return def.joints[static_cast<std::size_t>(c.edge.joint)];
  }

  [[nodiscard]] std::string joint(const Connection& c) const {
    const JointDef& joint = joint_of(c);
    const auto element = [&](const char* type) {
      return fmt::format(R"(<joint name="{}" type="{}" pos="{}" axis="{}"/>)", joint.name, type, text(c.outer.p),
                         text(c.outer.R.c[2]));
    };
    switch (joint.type) {
      case JointType::revolute:
        return element("hinge");
      case JointType::prismatic:
        return element("slide");
      case JointType::spherical:
        return element("ball");
      case JointType::floating:
        return fmt::format(R"(<freejoint name="{}"/>)", joint.name);
      case JointType::fixed:
        return {};
      default:
        throw std::logic_error("the tree has no such joint");
    }
  }

  [[nodiscard]] std::string static_dummies_of(const std::string& body) const {
    std::string list;
    for (const StaticDummyDef& dummy : def.static_dummies) {
      if (dummy.relative_to != body || dummy.mass == 0) continue;
      const auto [xx, yy, zz] = dummy.inertia;
      list += fmt::format(R"(<body name="{}" pos="{}" quat="{}">{}</body>)", dummy.name, text(Vec3(dummy.position)),
                          text(math::rotation_zxz(dummy.orientation)),
                          inertial(dummy.mass, Vec3(dummy.center_of_mass), Mat3::diagonal(xx, yy, zz)));
    }
    return list;
  }

  void load(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    constexpr const char* kFile = "mechanism.xml";
    if (mj_makeEmptyFileVFS(files.get(), kFile, static_cast<int>(xml.size())) != 0) {
      throw std::runtime_error("no room for the model's text");
    }
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    std::array<char, 1000> problem{};
    model.reset(mj_loadXML(kFile, files.get(), problem.data(), static_cast<int>(problem.size())));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(problem.data());
  }

  // coordinates of a joint from the motion of its two bodies
  void set_joint(const Connection& c, const Motions& motions) {
    const JointDef& joint = joint_of(c);
    if (joint.type == JointType::fixed) return;
    const BodyMotion& parent = motions[static_cast<std::size_t>(c.edge.parent)];
    const BodyMotion& child = motions[static_cast<std::size_t>(c.edge.child)];
    const int id = mj_name2id(model.get(), mjOBJ_JOINT, joint.name.c_str());
    mjtNum* q = data->qpos + model->jnt_qposadr[id];
    mjtNum* u = data->qvel + model->jnt_dofadr[id];
    const auto put = [](Vec3 a, mjtNum* to) {
      for (int i = 0; i < 3; ++i) to[i] = a[i];
    };
    const auto put_rotation = [](const Mat3& R, mjtNum* to) {
      const math::Quaternion of = math::quaternion_of(R);
      to[0] = of.w;
      to[1] = of.x;
      to[2] = of.y;
      to[3] = of.z;
    };
    if (joint.type == JointType::floating) {
      // position and velocity in Ground axes, angular velocity in the body's
      put(child.p, q);
      put_rotation(child.R, q + 3);
      put(child.v, u);
      put(transpose_multiply(child.R, child.w), u + 3);
    } else if (joint.type == JointType::spherical) {
      put_rotation(transpose(parent.R * c.R_PC) * child.R, q);
      put(transpose_multiply(child.R, child.w - parent.w), u);
    } else {
      // our coordinate is that of frame 2 seen from frame 1, MuJoCo's that of the child seen from the parent
      const double sign = c.edge.is_reversed ? -1 : 1;
      const RowMotion row = row_motion(def, joint.name, motions);
      *q = sign * row.x;
      *u = sign * row.v;
    }
  }

  [[nodiscard]] Motions motions() const {
    Motions list;
    for (const int body : bodies) {
      BodyMotion m;
      const mjtNum *R = data->xmat + 9 * body, *p = data->xpos + 3 * body;
      m.R = transpose(Mat3{Vec3(R[0], R[1], R[2]), Vec3(R[3], R[4], R[5]), Vec3(R[6], R[7], R[8])});
      m.p = Vec3(p[0], p[1], p[2]);
      std::array<mjtNum, 6> rate{};  // angular, then linear
      mj_objectVelocity(model.get(), data.get(), mjOBJ_XBODY, body, rate.data(), 0);
      m.w = Vec3(rate[0], rate[1], rate[2]);
      m.v = Vec3(rate[3], rate[4], rate[5]);
      mj_objectAcceleration(model.get(), data.get(), mjOBJ_XBODY, body, rate.data(), 0);
      m.alpha = Vec3(rate[0], rate[1], rate[2]);
      m.a = Vec3(rate[3], rate[4], rate[5]) + Vec3(def.gravity);  // less gravity, as an accelerometer has it
      list.push_back(m);
    }
    return list;
  }

  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };

  MechanicsDef def;
  std::vector<Connection> connections;
  std::unique_ptr<mjModel, Delete> model;
  std::unique_ptr<mjData, Delete> data;
  std::vector<int> bodies;  // by body, [0] is the world
};

MujocoPeer::MujocoPeer(const MechanicsDef& def) : simulation_(std::make_unique<Simulation>(def)) {}
MujocoPeer::~MujocoPeer() = default;

void MujocoPeer::set_motion(const Motions& motions) {
  for (const Connection& c : simulation_->connections) simulation_->set_joint(c, motions);
}

Motions MujocoPeer::accelerate(Wrenches wrenches) {
  const Simulation& s = *simulation_;
  mjData* data = s.data.get();
  mju_zero(data->qfrc_applied, s.model->nv);
  mj_forward(s.model.get(), data);
  const Motions now = s.motions();
  add_element_forces(s.def, now, wrenches);
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    const Triple force = wrenches[i].force.array(), torque = wrenches[i].torque.array(), origin = now[i].p.array();
    mj_applyFT(s.model.get(), data, force.data(), torque.data(), origin.data(), s.bodies[i], data->qfrc_applied);
  }
  mj_forward(s.model.get(), data);
  mj_rnePostConstraint(s.model.get(), data);
  return s.motions();
}

}  // namespace slew::multibody::testing
