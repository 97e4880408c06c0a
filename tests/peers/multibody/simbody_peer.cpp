// SPDX-License-Identifier: Apache-2.0
#include "tests/peers/multibody/simbody_peer.h"

#include <vector>

#include "tests/peers/multibody/def_laws.h"
#include "tests/peers/multibody/simbody_mechanism.h"

namespace slew::multibody::testing {

using math::Mat3;

struct SimbodyPeer::System : SimbodyMechanism {
  // a cylinder or piston: at its end's point, axis through the other end's
  struct Dummy {
    SimTK::MobilizedBodyIndex index;
    std::size_t force = 0;
  };

  class Elements final : public SimTK::Force::Custom::Implementation {
   public:
    explicit Elements(const System& system) : system_(system) {}

    void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                   SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector&) const override {
      Wrenches wrenches(system_.bodies.size());
      add_element_forces(system_.def, system_.motions(state, SimTK::Stage::Velocity), wrenches);
      for (std::size_t i = 0; i < wrenches.size(); ++i) {
        body_forces[system_.bodies[i]] += SimTK::SpatialVec(to_peer(wrenches[i].torque), to_peer(wrenches[i].force));
      }
    }

    [[nodiscard]] SimTK::Real calcPotentialEnergy(const SimTK::State& state) const override {
      return spring_energy(system_.def, system_.motions(state, SimTK::Stage::Position));
    }

   private:
    const System& system_;
  };

  explicit System(const MechanicsDef& mechanics) : SimbodyMechanism(mechanics), wrenches(forces, matter) {
    SimTK::Force::Custom(forces, new Elements(*this));  // the system owns it
    for (const StaticDummyDef& dummy : def.static_dummies) add_static_dummy(dummy);
    for (const ForceDummyDef& dummy : def.force_dummies) add_force_dummy(dummy);
    state = system.realizeTopology();
    system.realize(state, SimTK::Stage::Instance);
  }

  void add_static_dummy(const StaticDummyDef& dummy) {
    if (dummy.mass == 0) return;
    const auto [xx, yy, zz] = dummy.inertia;
    SimTK::MobilizedBody::Weld(mobilized(body_number(def, dummy.relative_to)),
                               to_peer(math::rotation_zxz(dummy.orientation), math::Vec3(dummy.position)),
                               rigid_body(dummy.mass, math::Vec3(dummy.center_of_mass), Mat3::diagonal(xx, yy, zz)),
                               SimTK::Transform());
  }

  // its z axis is the element's x axis
  void add_force_dummy(const ForceDummyDef& dummy) {
    std::size_t number = 0;
    while (def.translational_forces[number].name != dummy.relative_to) ++number;
    const TranslationalForceDef& force = def.translational_forces[number];
    const bool is_at_1 = dummy.index == 1;
    SimTK::MobilizedBody& near = mobilized(body_number(def, is_at_1 ? force.body1 : force.body2));
    SimTK::MobilizedBody& far = mobilized(body_number(def, is_at_1 ? force.body2 : force.body1));
    const math::Vec3 near_point(is_at_1 ? force.point1 : force.point2),
        far_point(is_at_1 ? force.point2 : force.point1);
    const double transverse = 0.5 * (dummy.inertia[1] + dummy.inertia[2]);
    SimTK::MobilizedBody::LineOrientation mobilizer(
        near, SimTK::Transform(to_peer(near_point)),
        rigid_body(dummy.mass, math::Vec3(0, 0, dummy.center_of_mass[0]), Mat3::diagonal(transverse, transverse, 0)),
        SimTK::Transform());
    SimTK::Constraint::PointOnLine(mobilizer, SimTK::UnitVec3(SimTK::ZAxis), SimTK::Vec3(0), far, to_peer(far_point));
    dummies.push_back({mobilizer.getMobilizedBodyIndex(), number});
  }

  [[nodiscard]] Motions motions(const SimTK::State& at, SimTK::Stage stage) const {
    Motions list;
    for (const SimTK::MobilizedBodyIndex index : bodies) {
      const SimTK::MobilizedBody& body = matter.getMobilizedBody(index);
      BodyMotion m;
      m.R = from_peer(body.getBodyRotation(at));
      m.p = from_peer(body.getBodyOriginLocation(at));
      if (stage >= SimTK::Stage::Velocity) {
        m.w = from_peer(body.getBodyAngularVelocity(at));
        m.v = from_peer(body.getBodyOriginVelocity(at));
      }
      if (stage >= SimTK::Stage::Acceleration) {
        m.alpha = from_peer(body.getBodyAngularAcceleration(at));
        m.a = from_peer(body.getBodyOriginAcceleration(at));
      }
      list.push_back(m);
    }
    return list;
  }

  // the constraints' forces on body 1; Simbody's have the opposite sign of applied ones
  [[nodiscard]] JointReaction cut_reaction(const CutJoint& cut, const Motions& motions) const {
    const JointDef& joint = def.joints[cut.joint];
    const std::size_t body1 = body_number(def, joint.body1);
    const math::Vec3 P2 = motion_of_point(motions[body_number(def, joint.body2)], frame2(joint).p).p;
    math::Vec3 f, n;
    for (const SimTK::ConstraintIndex index : cut.constraints) {
      const SimTK::Constraint& constraint = matter.getConstraint(index);
      const SimTK::Vector_<SimTK::SpatialVec> on_bodies = constraint.getConstrainedBodyForcesAsVector(state);
      for (SimTK::ConstrainedBodyIndex b(0); b < constraint.getNumConstrainedBodies(); ++b) {
        const SimTK::MobilizedBody& body = constraint.getMobilizedBodyFromConstrainedBody(b);
        if (!(body.getMobilizedBodyIndex() == bodies[body1])) continue;
        f -= from_peer(on_bodies[b][1]);
        n -= from_peer(on_bodies[b][0]);
      }
    }
    n += cross(motions[body1].p - P2, f);
    return {f.array(), n.array()};
  }

  SimTK::Force::DiscreteForces wrenches;
  SimTK::State state;
  std::vector<Dummy> dummies;
};

SimbodyPeer::SimbodyPeer(const MechanicsDef& def) : system_(std::make_unique<System>(def)) {}
SimbodyPeer::~SimbodyPeer() = default;

void SimbodyPeer::set_motion(const Motions& motions) {
  System& s = *system_;
  // pose and velocity of every mobilized body; mobilizers take what their coordinates can follow
  std::vector<BodyMotion> of(static_cast<std::size_t>(s.matter.getNumBodies()));
  for (std::size_t i = 0; i < motions.size(); ++i) of[static_cast<std::size_t>(s.bodies[i])] = motions[i];
  for (const System::Dummy& dummy : s.dummies) {
    const Line line = line_of(s.def, s.def.translational_forces[dummy.force], motions);
    BodyMotion& m = of[static_cast<std::size_t>(dummy.index)];
    m.R = from_peer(SimTK::Rotation(SimTK::UnitVec3(to_peer(line.e)), SimTK::ZAxis));
    m.w = cross(line.e, line.e_dot);
  }
  for (SimTK::MobilizedBodyIndex i(1); i < s.matter.getNumBodies(); ++i) {
    const SimTK::MobilizedBody& body = s.matter.getMobilizedBody(i);
    const auto pose = [&](const SimTK::MobilizedBody& b) {
      const BodyMotion& m = of[static_cast<std::size_t>(b.getMobilizedBodyIndex())];
      return to_peer(m.R, m.p);
    };
    const SimTK::Transform X_GF = pose(body.getParentMobilizedBody()) * body.getInboardFrame(s.state);
    const SimTK::Transform X_GM = pose(body) * body.getOutboardFrame(s.state);
    body.setQToFitTransform(s.state, ~X_GF * X_GM);
  }
  s.system.realize(s.state, SimTK::Stage::Position);
  for (SimTK::MobilizedBodyIndex i(1); i < s.matter.getNumBodies(); ++i) {
    const SimTK::MobilizedBody& body = s.matter.getMobilizedBody(i);
    const SimTK::MobilizedBody& parent = body.getParentMobilizedBody();
    const BodyMotion& inner = of[static_cast<std::size_t>(parent.getMobilizedBodyIndex())];
    const BodyMotion& outer = of[static_cast<std::size_t>(i)];
    const PointMotion F = motion_of_point(inner, from_peer(body.getInboardFrame(s.state).p()));
    const PointMotion M = motion_of_point(outer, from_peer(body.getOutboardFrame(s.state).p()));
    const math::Vec3 v = M.v - F.v - cross(inner.w, M.p - F.p);
    const SimTK::Rotation R_GF = to_peer(inner.R, inner.p).R() * body.getInboardFrame(s.state).R();
    body.setUToFitVelocity(s.state, SimTK::SpatialVec(~R_GF * to_peer(outer.w - inner.w), ~R_GF * to_peer(v)));
  }
}

Motions SimbodyPeer::accelerate(const Wrenches& wrenches) {
  System& s = *system_;
  for (std::size_t i = 0; i < wrenches.size(); ++i) {
    s.wrenches.setOneBodyForce(s.state, s.mobilized(i),
                               SimTK::SpatialVec(to_peer(wrenches[i].torque), to_peer(wrenches[i].force)));
  }
  s.system.realize(s.state, SimTK::Stage::Acceleration);
  return s.motions(s.state, SimTK::Stage::Acceleration);
}

std::vector<JointReaction> SimbodyPeer::reactions() const {
  const System& s = *system_;
  const Motions motions = s.motions(s.state, SimTK::Stage::Position);
  SimTK::Vector_<SimTK::SpatialVec> on_children;  // about the child's joint point
  s.matter.calcMobilizerReactionForces(s.state, on_children);
  std::vector<JointReaction> list(s.def.joints.size());
  for (const TreeEdge& edge : s.edges) {
    if (edge.joint == kNoJoint) continue;
    const auto number = static_cast<std::size_t>(edge.joint), child = static_cast<std::size_t>(edge.child);
    const JointDef& joint = s.def.joints[number];
    const SimTK::SpatialVec& on_child = on_children[s.bodies[child]];
    const math::Vec3 f = from_peer(on_child[1]);
    const math::Vec3 P = motion_of_point(motions[child], (edge.is_reversed ? frame1(joint) : frame2(joint)).p).p;
    const math::Vec3 P2 = motion_of_point(motions[body_number(s.def, joint.body2)], frame2(joint).p).p;
    const math::Vec3 n = from_peer(on_child[0]) + cross(P - P2, f);
    const double sign = edge.is_reversed ? 1 : -1;  // the child is body 1 or body 2
    list[number] = {(f * sign).array(), (n * sign).array()};
  }
  for (const SimbodyMechanism::CutJoint& cut : s.cuts) list[cut.joint] = s.cut_reaction(cut, motions);
  return list;
}

Energy SimbodyPeer::energy() {
  System& s = *system_;
  s.system.realize(s.state, SimTK::Stage::Dynamics);
  return {s.system.calcKineticEnergy(s.state), s.system.calcPotentialEnergy(s.state)};
}

void SimbodyPeer::run(double time, double accuracy) {
  System& s = *system_;
  SimTK::RungeKuttaMersonIntegrator integrator(s.system);
  integrator.setAccuracy(accuracy);
  integrator.setConstraintTolerance(accuracy);
  integrator.initialize(s.state);
  const double end = s.state.getTime() + time;
  while (integrator.getTime() < end) integrator.stepTo(end);
  s.state = integrator.getState();
}

}  // namespace slew::multibody::testing
