// SPDX-License-Identifier: Apache-2.0
// MuJoCo 2.2.2. Forward dynamics of a tree is its mj_forward() without contacts, sensors and actuators:
// composite inertias, bias forces, sparse L^T D L. Closures and contacts are its soft constraints, with the least
// compliance that its default time constant of 0.02 s leaves.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "benchmarks/peers/peer.h"

namespace slew::peers {
namespace {

using Quaternion = std::array<double, 4>;

Quaternion quaternion_of(const Rotation& R) {
  Quaternion q{};
  mju_mat2Quat(q.data(), R.data());
  return q;
}

template <typename Numbers>
std::string text(const Numbers& numbers) {
  std::ostringstream out;
  out.precision(17);
  for (const double x : numbers) out << x << ' ';
  return out.str();
}

std::string joints_of(const Body& body) {
  switch (body.joint) {
    case Joint::revolute:
      return "<joint type='hinge' axis='0 0 1'/>";
    case Joint::prismatic:
      return "<joint type='slide' axis='0 0 1'/>";
    case Joint::universal:
      return "<joint type='hinge' axis='0 1 0'/><joint type='hinge' axis='0 0 1'/>";
    case Joint::spherical:
      return "<joint type='ball'/>";
    case Joint::floating:
      return "<freejoint/>";
  }
  return {};
}

// the body as a universal joint holds it at zero
Rotation held(const Body& body) {
  if (body.joint != Joint::universal) return body.R_PJ;
  const Rotation& R = body.R_PJ;
  return {R[1], R[2], R[0], R[4], R[5], R[3], R[7], R[8], R[6]};
}

class Mujoco final : public Peer {
 public:
  Mujoco(const Mechanism& mechanism, double h) : mechanism_(mechanism) {
    load(xml(h));
    // the second body's point is taken from the zero position by its compiler, where the loops are open
    for (std::size_t i = 0; i < mechanism.closures.size(); ++i) {
      std::copy_n(mechanism.closures[i].point2.data(), 3, model_->eq_data + mjNEQDATA * i + 3);
    }
    data_ = mj_makeData(model_);
  }
  Mujoco(const Mujoco&) = delete;
  Mujoco& operator=(const Mujoco&) = delete;
  ~Mujoco() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  [[nodiscard]] std::string name() const override { return "MuJoCo"; }
  [[nodiscard]] bool has_dynamics() const override { return mechanism_.box < 0; }
  // its compiler's principal axes are 4e-7 off; soft closures
  [[nodiscard]] double tolerance() const override { return mechanism_.closures.empty() ? 1e-5 : 2e-2; }
  [[nodiscard]] std::string step_method() const override { return "Euler"; }

  void find_accelerations(const State& state) override {
    set(state);
    if (!mechanism_.closures.empty()) {
      mj_forward(model_, data_);
      return;
    }
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_crb(model_, data_);
    mj_factorM(model_, data_);
    mj_comVel(model_, data_);
    mj_rne(model_, data_, 0, data_->qfrc_bias);
    for (int i = 0; i < model_->nv; ++i) data_->qfrc_smooth[i] = data_->qfrc_applied[i] - data_->qfrc_bias[i];
    mj_solveM(model_, data_, data_->qacc, data_->qfrc_smooth, 1);
  }

  [[nodiscard]] std::vector<double> accelerations() const override {
    std::vector<double> udot;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const std::size_t speeds = sizes(mechanism_.bodies[b].joint)[1];
      const mjtNum* rates = data_->qacc + first_speed(b);
      udot.insert(udot.end(), rates, rates + speeds);
      if (speeds == 3) turn(data_->qpos + first_coordinate(b), udot.data() + udot.size() - 3);
    }
    return udot;
  }

  void start(const State& state) override {
    mj_resetData(model_, data_);
    set(state);
  }

  void step(double) override {
    damp();
    mj_step(model_, data_);
  }

  [[nodiscard]] std::vector<double> angles() const override {
    std::vector<double> list;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const bool is_single = sizes(mechanism_.bodies[b].joint)[1] == 1;
      list.push_back(is_single ? data_->qpos[first_coordinate(b)] : 0);
    }
    return list;
  }

 private:
  // axes of the body to axes of the joint's frame
  static void turn(const double* quaternion, double* vector) {
    const Vector from = {vector[0], vector[1], vector[2]};
    mju_rotVecQuat(vector, from.data(), quaternion);
  }

  // its joints are numbered in the order of the text, in which children follow their parent
  [[nodiscard]] int first_coordinate(std::size_t body) const { return model_->jnt_qposadr[first_joint_[body]]; }
  [[nodiscard]] int first_speed(std::size_t body) const { return model_->jnt_dofadr[first_joint_[body]]; }

  void set(const State& state) {
    for_each_body(mechanism_, [&](std::size_t b, std::size_t qi, std::size_t ui) {
      const auto [coordinates, speeds] = sizes(mechanism_.bodies[b].joint);
      mjtNum *q = data_->qpos + first_coordinate(b), *u = data_->qvel + first_speed(b);
      std::copy_n(state.q.data() + qi, coordinates, q);
      std::copy_n(state.u.data() + ui, speeds, u);
      if (speeds < 3) return;
      // angular velocity in axes of the body
      Quaternion back{};
      mju_negQuat(back.data(), q + coordinates - 4);
      turn(back.data(), u + speeds - 3);
    });
    damp();
  }

  void damp() {
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      if (mechanism_.bodies[b].damping == 0) continue;
      const int first = first_speed(b);
      for (int k = first; k < first + 3; ++k) {
        data_->qfrc_applied[k] = -mechanism_.bodies[b].damping * data_->qvel[k];
      }
    }
  }

  [[nodiscard]] std::string xml(double h) const {
    std::ostringstream out;
    out.precision(17);
    const char* constraint = mechanism_.closures.empty() && mechanism_.box < 0 ? "disable" : "enable";
    out << "<mujoco><compiler angle='radian' inertiafromgeom='false' balanceinertia='false' boundmass='0' "
           "boundinertia='0'/><option timestep='"
        << h << "' integrator='Euler' gravity='" << text(mechanism_.gravity) << "'><flag constraint='" << constraint
        << "'/></option><worldbody>";
    if (mechanism_.box >= 0) out << "<geom type='plane' size='0 0 1' zaxis='0 1 0' friction='" << friction() << "'/>";
    write_children(-1, out);
    out << "</worldbody><equality>";
    for (const Closure& closure : mechanism_.closures) {
      out << "<connect body1='B" << closure.body1 << "' body2='B" << closure.body2 << "' anchor='"
          << text(closure.point1) << "' solimp='0.9999 0.9999 0.001'/>";
    }
    out << "</equality></mujoco>";
    return out.str();
  }

  [[nodiscard]] std::string friction() const { return text(Vector{mechanism_.friction, 0, 0}); }

  void write_children(int parent, std::ostringstream& out) const {
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const Body& body = mechanism_.bodies[b];
      if (body.parent != parent) continue;
      const Rotation& I = body.inertia;
      first_joint_.resize(mechanism_.bodies.size());
      first_joint_[b] = joints_;
      joints_ += body.joint == Joint::universal ? 2 : 1;
      out << "<body name='B" << b << "' pos='" << text(body.p_PJ) << "' quat='" << text(quaternion_of(held(body)))
          << "'><inertial mass='" << body.mass << "' pos='" << text(body.center) << "' fullinertia='" << I[0] << ' '
          << I[4] << ' ' << I[8] << ' ' << I[1] << ' ' << I[2] << ' ' << I[5] << "'/>" << joints_of(body);
      if (static_cast<int>(b) == mechanism_.box) {
        Vector half = mechanism_.box_size;
        for (double& x : half) x *= 0.5;
        out << "<geom type='box' size='" << text(half) << "' friction='" << friction() << "'/>";
      }
      write_children(static_cast<int>(b), out);
      out << "</body>\n";
    }
  }

  void load(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), "m.xml", static_cast<int>(xml.size())) != 0) {
      throw std::runtime_error("no room for the model's text");
    }
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    std::array<char, 1000> problem{};
    model_ = mj_loadXML("m.xml", files.get(), problem.data(), static_cast<int>(problem.size()));
    mj_deleteVFS(files.get());
    if (model_ == nullptr) throw std::runtime_error(problem.data());
  }

  Mechanism mechanism_;
  mutable std::vector<int> first_joint_;
  mutable int joints_ = 0;
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const Mechanism& mechanism, double h) {
  // the text of a deeper chain is refused by its parser
  constexpr std::size_t kDeepest = 90;
  if (mechanism.bodies.size() > kDeepest) return nullptr;
  return std::make_unique<Mujoco>(mechanism, h);
}

}  // namespace slew::peers
