// SPDX-License-Identifier: Apache-2.0
// Bullet 3.24 with double precision (btMultiBody): articulated bodies, closures and contacts by 50 sweeps of projected
// Gauss-Seidel in velocities. Its links have their centre of mass as origin and principal axes as axes. It has no
// universal joint: two hinges with a link without mass between them. The box is a body of its own.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <btBulletDynamicsCommon.h>

#include "benchmarks/peers/peer.h"

namespace slew::peers {
namespace {

btVector3 to_peer(const Vector& a) {
  return {a[0], a[1], a[2]};
}

btMatrix3x3 to_peer(const Rotation& R) {
  return {R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]};
}

btQuaternion to_quaternion(const btMatrix3x3& R) {
  btQuaternion q;
  R.getRotation(q);
  return q;
}

class Bullet final : public Peer {
 public:
  Bullet(const Mechanism& mechanism, double) : mechanism_(mechanism) {
    int links = 0;
    for (const Body& body : mechanism.bodies) {
      if (body.joint != Joint::floating) links += body.joint == Joint::universal ? 2 : 1;
    }
    tree_ = std::make_unique<btMultiBody>(links, 0, btVector3(0, 0, 0), true, false);
    for (const Body& body : mechanism.bodies) add(body);
    tree_->finalizeMultiDof();
    tree_->setLinearDamping(0);
    tree_->setAngularDamping(0);
    tree_->setMaxCoordinateVelocity(1e10);
    add_colliders();
    world_.setGravity(to_peer(mechanism.gravity));
    world_.getSolverInfo().m_numIterations = 50;
    world_.addMultiBody(tree_.get());
    for (const Closure& closure : mechanism.closures) {
      const Placed &a = placed_[static_cast<std::size_t>(closure.body1)],
                   &b = placed_[static_cast<std::size_t>(closure.body2)];
      const btVector3 at_a = a.axes.transpose() * (to_peer(closure.point1) - a.center),
                      at_b = b.axes.transpose() * (to_peer(closure.point2) - b.center);
      closures_.push_back(
          std::make_unique<btMultiBodyPoint2Point>(tree_.get(), a.link, tree_.get(), b.link, at_a, at_b));
      closures_.back()->finalizeMultiDof();
      world_.addMultiBodyConstraint(closures_.back().get());
    }
    if (mechanism.box >= 0) add_box();
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;
  ~Bullet() override {
    for (const auto& closure : closures_) world_.removeMultiBodyConstraint(closure.get());
    world_.removeMultiBody(tree_.get());
    for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  [[nodiscard]] std::string name() const override { return "Bullet"; }
  [[nodiscard]] bool has_dynamics() const override { return mechanism_.box < 0 && mechanism_.closures.empty(); }
  [[nodiscard]] double tolerance() const override { return 1e-9; }
  [[nodiscard]] std::string step_method() const override { return "symplectic Euler, 50 sweeps"; }

  void find_accelerations(const State& state) override {
    set(state);
    tree_->clearForcesAndTorques();
    for (const Placed& body : placed_) tree_->addLinkForce(body.link, to_peer(mechanism_.gravity) * body.mass);
    damp();
    for (int i = 0; i < tree_->getNumDofs(); ++i)
      before_[static_cast<std::size_t>(i)] = tree_->getVelocityVector()[6 + i];
    tree_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(kSpan, scratch_r_, scratch_v_, scratch_m_, false, false,
                                                                false);
  }

  [[nodiscard]] std::vector<double> accelerations() const override {
    std::vector<double> udot;
    std::size_t i = 0;
    for (std::size_t b = 0; b < placed_.size(); ++b) {
      btVector3 rate;
      const std::size_t speeds = sizes(mechanism_.bodies[b].joint)[1];
      for (std::size_t k = 0; k < speeds; ++k, ++i) {
        const double change = tree_->getVelocityVector()[6 + i] - before_[i];
        udot.push_back(change / kSpan);
        if (speeds == 3) rate[static_cast<int>(k)] = udot.back();
      }
      if (speeds == 3) {
        rate = quatRotate(turned_, placed_[b].axes * rate);
        for (int k = 0; k < 3; ++k) udot[udot.size() - 3 + static_cast<std::size_t>(k)] = rate[k];
      }
    }
    return udot;
  }

  void start(const State& state) override {
    set(state);
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> places;
    tree_->forwardKinematics(rotations, places);
    tree_->updateCollisionObjectWorldTransforms(rotations, places);
  }

  void step(double h) override {
    damp();
    world_.stepSimulation(h, 0, h);
  }

  [[nodiscard]] std::vector<double> angles() const override {
    std::vector<double> list;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const Joint joint = mechanism_.bodies[b].joint;
      const bool is_single = joint == Joint::revolute || joint == Joint::prismatic;
      list.push_back(is_single ? tree_->getJointPos(placed_[b].link) : 0);
    }
    return list;
  }

 private:
  // a body's link: axes and origin in the body's frame
  struct Placed {
    int link = -1;
    double mass = 0;
    btVector3 center{0, 0, 0};
    btMatrix3x3 axes = btMatrix3x3::getIdentity();
  };

  void add(const Body& body) {
    if (body.joint == Joint::floating) {
      placed_.emplace_back();
      return;
    }
    const Placed parent = body.parent < 0 ? Placed() : placed_[static_cast<std::size_t>(body.parent)];
    Placed placed;
    placed.mass = body.mass;
    placed.center = to_peer(body.center);
    btMatrix3x3 moments = to_peer(body.inertia);
    moments.diagonalize(placed.axes, 1e-15, 100);
    const btVector3 inertia(moments[0][0], moments[1][1], moments[2][2]);
    btVector3 pivot = parent.axes.transpose() * (to_peer(body.p_PJ) - parent.center);
    const btVector3 to_center = placed.axes.transpose() * placed.center;
    btMatrix3x3 turn = parent.axes.transpose() * to_peer(body.R_PJ);  // the joint's frame in the parent's axes
    int inner = parent.link;
    const btVector3 z(0, 0, 1), zero(0, 0, 0);
    if (body.joint == Joint::universal) {
      tree_->setupRevolute(links_, 0, zero, inner, to_quaternion(turn.transpose()), z, pivot, zero, true);
      inner = links_++;
      pivot = zero;
      turn = btMatrix3x3(0, 0, 1, 1, 0, 0, 0, 1, 0);
    }
    placed.link = links_++;
    const btQuaternion to_this = to_quaternion((turn * placed.axes).transpose());
    const btVector3 axis = placed.axes.transpose() * z;
    if (body.joint == Joint::spherical) {
      tree_->setupSpherical(placed.link, body.mass, inertia, inner, to_this, pivot, to_center, true);
    } else if (body.joint == Joint::prismatic) {
      tree_->setupPrismatic(placed.link, body.mass, inertia, inner, to_this, axis, pivot, to_center, true);
    } else {
      tree_->setupRevolute(placed.link, body.mass, inertia, inner, to_this, axis, pivot, to_center, true);
    }
    placed_.push_back(placed);
  }

  // the world's islands are made of colliders; these touch nothing
  void add_colliders() {
    for (int i = 0; i < tree_->getNumLinks(); ++i) {
      colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(tree_.get(), i));
      colliders_.back()->setCollisionShape(&point_);
      world_.addCollisionObject(colliders_.back().get(), 0, 0);
      tree_->getLink(i).m_collider = colliders_.back().get();
    }
    before_.resize(static_cast<std::size_t>(tree_->getNumDofs()));
  }

  void add_box() {
    const Body& body = mechanism_.bodies[static_cast<std::size_t>(mechanism_.box)];
    shape_ = std::make_unique<btBoxShape>(to_peer(mechanism_.box_size) * 0.5);
    const btVector3 inertia(body.inertia[0], body.inertia[4], body.inertia[8]);
    bodies_.push_back(std::make_unique<btRigidBody>(0, nullptr, &ground_));
    bodies_.push_back(std::make_unique<btRigidBody>(body.mass, nullptr, shape_.get(), inertia));
    for (const auto& placed : bodies_) {
      placed->setFriction(std::sqrt(mechanism_.friction));  // coefficients are multiplied
      placed->setActivationState(DISABLE_DEACTIVATION);
      world_.addRigidBody(placed.get());
    }
  }

  void set(const State& state) {
    for_each_body(mechanism_, [&](std::size_t b, std::size_t qi, std::size_t ui) {
      const Joint joint = mechanism_.bodies[b].joint;
      const Placed& placed = placed_[b];
      const double *q = state.q.data() + qi, *u = state.u.data() + ui;
      if (joint == Joint::spherical) {
        turned_ = btQuaternion(q[1], q[2], q[3], q[0]);
        const btMatrix3x3 R(turned_);
        const btQuaternion turn = to_quaternion(placed.axes.transpose() * R * placed.axes);
        const btVector3 w = placed.axes.transpose() * (R.transpose() * btVector3(u[0], u[1], u[2]));
        const double position[4] = {turn.x(), turn.y(), turn.z(), turn.w()}, rate[3] = {w.x(), w.y(), w.z()};
        tree_->setJointPosMultiDof(placed.link, position);
        tree_->setJointVelMultiDof(placed.link, rate);
      } else if (joint != Joint::floating) {
        const int first = joint == Joint::universal ? placed.link - 1 : placed.link;
        for (std::size_t k = 0; k < sizes(joint)[1]; ++k) {
          tree_->setJointPos(first + static_cast<int>(k), q[k]);
          tree_->setJointVel(first + static_cast<int>(k), u[k]);
        }
      } else if (!bodies_.empty()) {
        btRigidBody& box = *bodies_.back();
        box.setWorldTransform(btTransform(btQuaternion(q[4], q[5], q[6], q[3]), btVector3(q[0], q[1], q[2])));
        box.setLinearVelocity(btVector3(u[0], u[1], u[2]));
        box.setAngularVelocity(btVector3(u[3], u[4], u[5]));
      }
    });
  }

  void damp() {
    for (std::size_t b = 0; b < placed_.size(); ++b) {
      if (mechanism_.bodies[b].damping == 0) continue;
      const double* rate = tree_->getJointVelMultiDof(placed_[b].link);
      for (int k = 0; k < 3; ++k) {
        tree_->addJointTorqueMultiDof(placed_[b].link, k, -mechanism_.bodies[b].damping * rate[k]);
      }
    }
  }

  static constexpr double kSpan = 1e-3;  // s, over which it turns accelerations into changes of speed
  Mechanism mechanism_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btSphereShape point_{1e-3};
  btStaticPlaneShape ground_{btVector3(0, 1, 0), 0};
  std::unique_ptr<btBoxShape> shape_;
  std::unique_ptr<btMultiBody> tree_;
  std::vector<Placed> placed_;
  int links_ = 0;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> closures_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btQuaternion turned_;
  std::vector<double> before_;
  btAlignedObjectArray<btScalar> scratch_r_;
  btAlignedObjectArray<btVector3> scratch_v_;
  btAlignedObjectArray<btMatrix3x3> scratch_m_;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const Mechanism& mechanism, double h) {
  return std::make_unique<Bullet>(mechanism, h);
}

}  // namespace slew::peers
