// SPDX-License-Identifier: Apache-2.0
// DART 6.12: articulated bodies through virtual calls and lazily updated caches, closures and contacts by a linear
// complementarity problem in velocities.
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/UniversalJoint.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "benchmarks/peers/peer.h"

namespace slew::peers {
namespace {

namespace dynamics = dart::dynamics;

Eigen::Vector3d to_peer(const Vector& a) {
  return {a[0], a[1], a[2]};
}

Eigen::Matrix3d to_peer(const Rotation& R) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
}

Eigen::Matrix3d rotation_of(const double* q) {
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

class Dart final : public Peer {
 public:
  Dart(const Mechanism& mechanism, double h) : mechanism_(mechanism) {
    skeleton_ = dynamics::Skeleton::create("mechanism");
    for (const Body& body : mechanism.bodies) add(body);
    world_->setGravity(to_peer(mechanism.gravity));
    world_->setTimeStep(h);
    world_->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    if (mechanism.box >= 0) add_shapes();
    skeleton_->setGravity(to_peer(mechanism.gravity));
    world_->addSkeleton(skeleton_);
  }

  [[nodiscard]] std::string name() const override { return "DART"; }
  [[nodiscard]] bool has_dynamics() const override { return mechanism_.box < 0 && mechanism_.closures.empty(); }
  [[nodiscard]] double tolerance() const override { return 1e-9; }
  [[nodiscard]] std::string step_method() const override { return "semi-implicit Euler"; }

  void find_accelerations(const State& state) override {
    set(state);
    skeleton_->computeForwardDynamics();
  }

  [[nodiscard]] std::vector<double> accelerations() const override {
    std::vector<double> udot;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const dynamics::Joint* joint = skeleton_->getJoint(b);
      Eigen::VectorXd rates = joint->getAccelerations();
      if (mechanism_.bodies[b].joint == Joint::spherical) {
        rates = (joint->getRelativeTransform().linear() * rates).eval();
        rates = (to_peer(mechanism_.bodies[b].R_PJ).transpose() * rates).eval();
      }
      udot.insert(udot.end(), rates.data(), rates.data() + rates.size());
    }
    return udot;
  }

  void start(const State& state) override {
    world_->reset();
    set(state);
    if (has_closures_) return;
    has_closures_ = true;
    for (const Closure& closure : mechanism_.closures) {
      dynamics::BodyNode* body1 = skeleton_->getBodyNode(static_cast<std::size_t>(closure.body1));
      dynamics::BodyNode* body2 = skeleton_->getBodyNode(static_cast<std::size_t>(closure.body2));
      world_->getConstraintSolver()->addConstraint(std::make_shared<dart::constraint::BallJointConstraint>(
          body1, body2, body1->getWorldTransform() * to_peer(closure.point1)));
    }
  }

  void step(double) override {
    damp();
    world_->step();
  }

  [[nodiscard]] std::vector<double> angles() const override {
    std::vector<double> list;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const Joint joint = mechanism_.bodies[b].joint;
      const bool is_single = joint == Joint::revolute || joint == Joint::prismatic;
      list.push_back(is_single ? skeleton_->getJoint(b)->getPosition(0) : 0);
    }
    return list;
  }

 private:
  template <typename JointType>
  dynamics::BodyNode* hang(const Body& body, typename JointType::Properties properties) {
    dynamics::BodyNode* parent =
        body.parent < 0 ? nullptr : skeleton_->getBodyNode(static_cast<std::size_t>(body.parent));
    properties.mName = "J" + std::to_string(skeleton_->getNumBodyNodes());
    properties.mT_ParentBodyToJoint.linear() = to_peer(body.R_PJ);
    properties.mT_ParentBodyToJoint.translation() = to_peer(body.p_PJ);
    if (body.joint == Joint::universal) {
      // x2 = y1, y2 = z1, z2 = x1
      Eigen::Matrix3d held;
      held << 0, 0, 1, 1, 0, 0, 0, 1, 0;
      properties.mT_ParentBodyToJoint.linear() = to_peer(body.R_PJ) * held;
    }
    const dynamics::BodyNode::AspectProperties body_properties("B" + std::to_string(skeleton_->getNumBodyNodes()));
    return skeleton_
        ->createJointAndBodyNodePair<JointType>(parent, properties, dynamics::BodyNode::Properties(body_properties))
        .second;
  }

  void add(const Body& body) {
    dynamics::BodyNode* node = nullptr;
    switch (body.joint) {
      case Joint::revolute: {
        dynamics::RevoluteJoint::Properties properties;
        properties.mAxis = Eigen::Vector3d::UnitZ();
        node = hang<dynamics::RevoluteJoint>(body, properties);
        break;
      }
      case Joint::prismatic: {
        dynamics::PrismaticJoint::Properties properties;
        properties.mAxis = Eigen::Vector3d::UnitZ();
        node = hang<dynamics::PrismaticJoint>(body, properties);
        break;
      }
      case Joint::universal: {
        dynamics::UniversalJoint::Properties properties;
        properties.mAxis = {Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
        node = hang<dynamics::UniversalJoint>(body, properties);
        break;
      }
      case Joint::spherical:
        node = hang<dynamics::BallJoint>(body, {});
        break;
      case Joint::floating:
        node = hang<dynamics::FreeJoint>(body, {});
        break;
    }
    node->setInertia(dynamics::Inertia(body.mass, to_peer(body.center), to_peer(body.inertia)));
    node->setGravityMode(true);
  }

  void add_shapes() {
    constexpr double kGround = 100;
    const auto box = std::make_shared<dynamics::BoxShape>(to_peer(mechanism_.box_size));
    const auto give = [this](dynamics::BodyNode* node, const dynamics::ShapePtr& shape) {
      auto* shown = node->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
      shown->getDynamicsAspect()->setFrictionCoeff(mechanism_.friction);
      return shown;
    };
    give(skeleton_->getBodyNode(static_cast<std::size_t>(mechanism_.box)), box);
    const dynamics::SkeletonPtr ground = dynamics::Skeleton::create("ground");
    dynamics::BodyNode* node = ground->createJointAndBodyNodePair<dynamics::WeldJoint>().second;
    give(node, std::make_shared<dynamics::BoxShape>(Eigen::Vector3d(kGround, kGround, kGround)))
        ->setRelativeTranslation(Eigen::Vector3d(0, -kGround / 2, 0));
    ground->setMobile(false);
    world_->addSkeleton(ground);
  }

  void set(const State& state) {
    for_each_body(mechanism_, [&](std::size_t b, std::size_t qi, std::size_t ui) {
      dynamics::Joint* joint = skeleton_->getJoint(b);
      const std::size_t speeds = sizes(mechanism_.bodies[b].joint)[1];
      const double *q = state.q.data() + qi, *u = state.u.data() + ui;
      if (speeds == 6) {
        auto* flight = static_cast<dynamics::FreeJoint*>(joint);
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = rotation_of(q + 3);
        pose.translation() = Eigen::Vector3d(q[0], q[1], q[2]);
        flight->setTransform(pose);
        flight->setLinearVelocity(Eigen::Vector3d(u[0], u[1], u[2]));
        flight->setAngularVelocity(Eigen::Vector3d(u[3], u[4], u[5]));
      } else if (speeds == 3) {
        const Eigen::Matrix3d R = rotation_of(q);
        joint->setPositions(dynamics::BallJoint::convertToPositions(R));
        joint->setVelocities(R.transpose() * Eigen::Vector3d(u[0], u[1], u[2]));
      } else {
        for (std::size_t k = 0; k < speeds; ++k) {
          joint->setPosition(k, q[k]);
          joint->setVelocity(k, u[k]);
        }
      }
    });
    damp();
  }

  void damp() {
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      if (mechanism_.bodies[b].damping == 0) continue;
      dynamics::Joint* joint = skeleton_->getJoint(b);
      for (std::size_t k = 0; k < 3; ++k) joint->setForce(k, -mechanism_.bodies[b].damping * joint->getVelocity(k));
    }
  }

  Mechanism mechanism_;
  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  dynamics::SkeletonPtr skeleton_;
  bool has_closures_ = false;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const Mechanism& mechanism, double h) {
  return std::make_unique<Dart>(mechanism, h);
}

}  // namespace slew::peers
