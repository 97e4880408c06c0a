// SPDX-License-Identifier: Apache-2.0
// Case P03: a URDF file read by MuJoCo 2.2.2 itself, and by `slewring import urdf`: accelerations at random states.
//
// A branching tree of six joints that move: skew axes, turned origins, turned inertial frames, each product of inertia
// once, links without mass, damping. Both are exact but for the principal axes that MuJoCo's compiler finds: with one
// product a link its first rotation is the last one and exact (1e-14 found); with three it stops early, and so it does
// when it fuses fixed links (2e-9 found).
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cstring>
#include <memory>
#include <random>

#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace mujoco_urdf_test {

using testing::Imported;

std::string link(const std::string& name, const std::string& origin, double mass, const Triple& moments,
                 const Triple& products) {
  return fmt::format(
      "<link name=\"{}\"><inertial><origin {}/><mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" "
      "ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/></inertial></link>\n",
      name, origin, mass, moments[0], moments[1], moments[2], products[0], products[1], products[2]);
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& rest) {
  return fmt::format("<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}</joint>\n", name, type,
                     parent, child, rest);
}

const std::string kJoints =
    joint("j1", "revolute", "base", "pillar",
          "<origin xyz=\"0.1 0.2 0.3\" rpy=\"0.3 -0.2 1\"/><axis xyz=\"0 0 1\"/><limit lower=\"-3\" upper=\"3\" "
          "effort=\"1\" velocity=\"1\"/><dynamics damping=\"0.7\"/>") +
    joint("j2", "continuous", "pillar", "boom",
          "<origin xyz=\"0 0 1\" rpy=\"0 0.5 0\"/><axis xyz=\"1 -2 0.5\"/><dynamics damping=\"0.2\"/>") +
    joint("j3", "prismatic", "boom", "stick",
          "<origin xyz=\"0.9 0 0.1\" rpy=\"1 0 -0.4\"/><axis xyz=\"-1 0.3 0\"/><limit lower=\"-1\" upper=\"1\" "
          "effort=\"1\" velocity=\"1\"/>") +
    joint("j4", "fixed", "stick", "flange", "<origin xyz=\"0.2 0.1 0\" rpy=\"0.1 0.2 0.3\"/>") +
    joint("j5", "fixed", "flange", "plate", "<origin xyz=\"0 0 0.2\" rpy=\"-0.6 0 0.3\"/>") +
    joint("j6", "continuous", "flange", "hand", "<origin xyz=\"0 0.3 0\"/><axis xyz=\"0 -1 0\"/>") +
    joint("j7", "continuous", "boom", "second", "<origin xyz=\"-0.4 0 0\" rpy=\"0 0 2\"/>") +
    joint("j8", "prismatic", "second", "weight",
          "<axis xyz=\"0 1 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>");

std::string robot(const std::array<Triple, 3>& products) {
  return "<robot name=\"tree\">\n<mujoco><compiler fusestatic=\"false\" balanceinertia=\"false\" boundmass=\"0\" "
         "boundinertia=\"0\"/></mujoco>\n"
         "<link name=\"base\"/>\n<link name=\"flange\"/>\n" +
         link("pillar", "xyz=\"0.05 0 0.5\" rpy=\"0.2 0.4 -0.8\"", 12, {1.1, 1.2, 0.4}, {0, 0, 0}) +
         link("boom", "xyz=\"0.5 0.1 0\" rpy=\"0.3 -1.2 0.5\"", 7, {0.3, 0.9, 0.8}, products[0]) +
         link("stick", "xyz=\"0.3 0 -0.1\"", 4, {0.2, 0.35, 0.3}, products[1]) +
         link("plate", "xyz=\"0 0.1 0\" rpy=\"1.5707963267948966 0 0\"", 1.5, {0.05, 0.04, 0.06}, {0, 0, 0}) +
         link("hand", "xyz=\"0 0 0.2\" rpy=\"0 0 0.7\"", 2, {0.06, 0.05, 0.03}, products[2]) +
         link("second", "xyz=\"-0.2 0 0\"", 3, {0.1, 0.2, 0.2}, {0, 0, 0}) +
         link("weight", "xyz=\"0 0 0\"", 5, {0.1, 0.1, 0.1}, {0, 0, 0}) + kJoints + "</robot>\n";
}

class MujocoReader {
 public:
  explicit MujocoReader(const std::string& urdf) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    EXPECT_EQ(mj_makeEmptyFileVFS(files.get(), "robot.urdf", static_cast<int>(urdf.size())), 0);
    std::memcpy(files->filedata[0], urdf.data(), urdf.size());
    std::array<char, 1000> problem{};
    model_.reset(mj_loadXML("robot.urdf", files.get(), problem.data(), static_cast<int>(problem.size())));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(problem.data());
    // limits are no part of the comparison
    model_->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT;
    data_.reset(mj_makeData(model_.get()));
  }

  [[nodiscard]] int joints() const { return model_->njnt; }
  [[nodiscard]] int at(const std::string& joint) const {
    const int id = mj_name2id(model_.get(), mjOBJ_JOINT, joint.c_str());
    EXPECT_GE(id, 0) << joint;
    return id;
  }
  double& q(const std::string& joint) { return data_->qpos[model_->jnt_qposadr[at(joint)]]; }
  double& u(const std::string& joint) { return data_->qvel[model_->jnt_dofadr[at(joint)]]; }
  [[nodiscard]] double udot(const std::string& joint) const { return data_->qacc[model_->jnt_dofadr[at(joint)]]; }
  [[nodiscard]] double damping(const std::string& joint) const {
    return model_->dof_damping[model_->jnt_dofadr[at(joint)]];
  }
  void forward() { mj_forward(model_.get(), data_.get()); }

 private:
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

// Largest difference of an acceleration over 50 random states, relative to the largest of its state.
double difference(const std::string& urdf) {
  Imported ours(urdf);
  MujocoReader peer(urdf);
  auto& mechanism = ours.mechanism;
  const std::size_t n = mechanism.state.q.size();
  EXPECT_EQ(static_cast<int>(n), peer.joints());
  const std::vector<std::string> rows = scene::row_names(ours.scene);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> any(-1, 1);
  double largest = 0;
  for (int state = 0; state < 50; ++state) {
    std::vector<double> q(n), u(n), forces(rows.size(), 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string name(multibody::joint_of(mechanism.model, static_cast<int>(i)));
      peer.q(name) = q[i] = any(generator);
      peer.u(name) = u[i] = 4 * any(generator);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k] == name) forces[k] = -ours.joint(name).first.viscous_friction * u[i];
      }
      EXPECT_EQ(peer.damping(name), ours.joint(name).first.viscous_friction);
    }
    peer.forward();
    const std::vector<double> got = ours.accelerations(q, u, forces);
    double scale = 0, off = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double expected = peer.udot(std::string(multibody::joint_of(mechanism.model, static_cast<int>(i))));
      scale = std::max(scale, std::abs(expected));
      off = std::max(off, std::abs(got[i] - expected));
    }
    EXPECT_TRUE(std::isfinite(off));
    largest = std::max(largest, off / scale);
  }
  ::testing::Test::RecordProperty("difference", fmt::format("{:.3g}", largest));
  return largest;
}

TEST(UrdfInMujoco, AcceleratesAsOurImportDoes) {
  EXPECT_LT(difference(robot({{{0.05, 0, 0}, {0, -0.03, 0}, {0, 0, 0.01}}})), 1e-12);
}

TEST(UrdfInMujoco, AcceleratesAlikeWithThreeProductsALink) {
  EXPECT_LT(difference(robot({{{0.05, 0.1, -0.04}, {0.02, -0.03, 0.01}, {0.005, -0.01, 0.01}}})), 1e-7);
}

TEST(UrdfInMujoco, SeesAProductOfTheOtherSign) {
  const std::string urdf = robot({{{0.05, 0, 0}, {0, -0.03, 0}, {0, 0, 0.01}}});
  const std::string other = robot({{{0.05, 0, 0}, {0, 0.03, 0}, {0, 0, 0.01}}});
  Imported a(urdf), b(other);
  const std::vector<double> q(a.mechanism.state.q.size(), 0.3), u(q.size(), 1.0);
  const std::vector<double> first = a.accelerations(q, u), second = b.accelerations(q, u);
  double off = 0;
  for (std::size_t i = 0; i < q.size(); ++i) off = std::max(off, std::abs(first[i] - second[i]));
  EXPECT_GT(off, 1e-3);
}

}  // namespace mujoco_urdf_test
}  // namespace slew::urdf
