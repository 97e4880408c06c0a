// SPDX-License-Identifier: Apache-2.0
// Simbody 3.7: recursion over typed nodes, closures by multipliers with projection.
#include "benchmarks/peers/peer.h"
#include "tests/peers/multibody/simbody_headers.h"

namespace slew::peers {
namespace {

using SimTK::MobilizedBody, SimTK::MobilizedBodyIndex;

SimTK::Vec3 to_peer(const Vector& a) {
  return {a[0], a[1], a[2]};
}

SimTK::Rotation to_peer(const Rotation& R) {
  return {SimTK::Mat33(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]), true};
}

// axes as Simbody's mobilizers want them: tests/peers/multibody/simbody_mechanism.cpp
const SimTK::Rotation kSlideInner(SimTK::Mat33(0, 1, 0, 0, 0, 1, 1, 0, 0), true);
const SimTK::Rotation kTurnInner(SimTK::Mat33(0, 1, 0, 0, 0, 1, 1, 0, 0), true);
const SimTK::Rotation kTurnOuter(SimTK::Mat33(0, 0, 1, 1, 0, 0, 0, 1, 0), true);

class Simbody final : public Peer {
 public:
  Simbody(const Mechanism& mechanism, double) : mechanism_(mechanism), matter_(system_), forces_(system_) {
    SimTK::Force::UniformGravity(forces_, matter_, to_peer(mechanism.gravity));
    for (const Body& body : mechanism.bodies) add(body);
    for (const Closure& closure : mechanism.closures) {
      SimTK::Constraint::Ball(body_of(closure.body1), to_peer(closure.point1), body_of(closure.body2),
                              to_peer(closure.point2));
    }
    state_ = system_.realizeTopology();
    matter_.setUseEulerAngles(state_, false);
    system_.realizeModel(state_);
    system_.realize(state_, SimTK::Stage::Instance);
    if (mechanism.closures.empty()) {
      integrator_ = std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system_, 1e-3);
    } else {
      integrator_ = std::make_unique<SimTK::RungeKutta2Integrator>(system_);
    }
  }

  [[nodiscard]] std::string name() const override { return "Simbody"; }
  [[nodiscard]] bool has_dynamics() const override { return mechanism_.box < 0; }
  [[nodiscard]] double tolerance() const override { return 1e-9; }
  [[nodiscard]] std::string step_method() const override {
    if (mechanism_.box >= 0) return "";
    return mechanism_.closures.empty() ? "semi-explicit Euler" : "RK2, projected";
  }

  void find_accelerations(const State& state) override {
    set(state, state_);
    system_.realize(state_, SimTK::Stage::Acceleration);
  }

  [[nodiscard]] std::vector<double> accelerations() const override {
    std::vector<double> udot;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const MobilizedBody& body = matter_.getMobilizedBody(MobilizedBodyIndex(static_cast<int>(b) + 1));
      const SimTK::Vector rates = body.getUDotAsVector(state_);
      if (mechanism_.bodies[b].joint == Joint::floating) {
        for (const int k : {3, 4, 5, 0, 1, 2}) udot.push_back(rates[k]);
      } else {
        for (int k = 0; k < rates.size(); ++k) udot.push_back(rates[k]);
      }
    }
    return udot;
  }

  void start(const State& state) override {
    SimTK::State begin = state_;
    begin.setTime(0);
    set(state, begin);
    steps_ = 0;
    integrator_->setFixedStepSize(1e-3);
    integrator_->setConstraintTolerance(1e-6);
    integrator_->initialize(begin);
  }

  void step(double h) override {
    const double end = ++steps_ * h;
    while (integrator_->getTime() < end - 1e-9) integrator_->stepTo(end);
  }

  [[nodiscard]] std::vector<double> angles() const override {
    std::vector<double> list;
    for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
      const Joint joint = mechanism_.bodies[b].joint;
      const MobilizedBody& body = matter_.getMobilizedBody(MobilizedBodyIndex(static_cast<int>(b) + 1));
      const bool is_single = joint == Joint::revolute || joint == Joint::prismatic;
      list.push_back(is_single ? body.getOneQ(integrator_->getState(), 0) : 0);
    }
    return list;
  }

 private:
  MobilizedBody& body_of(int body) { return matter_.updMobilizedBody(MobilizedBodyIndex(body + 1)); }

  void add(const Body& body) {
    const Rotation& I = body.inertia;
    const SimTK::Vec3 center = to_peer(body.center);
    const SimTK::Inertia central(I[0], I[4], I[8], I[1], I[2], I[5]);
    const SimTK::Body::Rigid rigid(
        SimTK::MassProperties(body.mass, center, central.shiftFromMassCenter(center, body.mass)));
    MobilizedBody& parent = body_of(body.parent);
    const SimTK::Rotation R = to_peer(body.R_PJ);
    const SimTK::Vec3 p = to_peer(body.p_PJ);
    const SimTK::Transform F(R, p), M;
    switch (body.joint) {
      case Joint::revolute:
        MobilizedBody::Pin(parent, F, rigid, M);
        break;
      case Joint::prismatic:
        MobilizedBody::Slider(parent, SimTK::Transform(R * kSlideInner, p), rigid, SimTK::Transform(kSlideInner));
        break;
      case Joint::universal:
        MobilizedBody::Universal(parent, SimTK::Transform(R * kTurnInner, p), rigid, SimTK::Transform(kTurnOuter));
        break;
      case Joint::spherical: {
        const MobilizedBody::Ball ball(parent, F, rigid, M);
        for (int k = 0; k < 3 && body.damping > 0; ++k) {
          SimTK::Force::MobilityLinearDamper(forces_, ball, SimTK::MobilizerUIndex(k), body.damping);
        }
        break;
      }
      case Joint::floating:
        MobilizedBody::Free(parent, rigid);
        break;
    }
  }

  void set(const State& state, SimTK::State& to) const {
    for_each_body(mechanism_, [&](std::size_t b, std::size_t qi, std::size_t ui) {
      const MobilizedBody& body = matter_.getMobilizedBody(MobilizedBodyIndex(static_cast<int>(b) + 1));
      const auto [coordinates, speeds] = sizes(mechanism_.bodies[b].joint);
      // Free: quaternion first, angular velocity first
      const bool is_floating = mechanism_.bodies[b].joint == Joint::floating;
      for (std::size_t k = 0; k < coordinates; ++k) {
        body.setOneQ(to, static_cast<int>(is_floating ? (k + 4) % 7 : k), state.q[qi + k]);
      }
      for (std::size_t k = 0; k < speeds; ++k) {
        body.setOneU(to, static_cast<int>(is_floating ? (k + 3) % 6 : k), state.u[ui + k]);
      }
    });
  }

  Mechanism mechanism_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::State state_;
  std::unique_ptr<SimTK::Integrator> integrator_;
  int steps_ = 0;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const Mechanism& mechanism, double h) {
  return std::make_unique<Simbody>(mechanism, h);
}

}  // namespace slew::peers
