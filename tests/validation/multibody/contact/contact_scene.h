// SPDX-License-Identifier: Apache-2.0
// Bodies on a ground, as a scene defines them, moved by the Dynamics of any formulation.
#pragma once

#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody::testing {

inline constexpr double kDegree = M_PI / 180;
// turns a plane's outward z to +y
inline constexpr Triple kUpward = {0, -M_PI / 2, 0};

inline BodyDef free_body(const std::string& name, double mass, const Triple& inertia, const Triple& position) {
  BodyDef body;
  body.name = name;
  body.mass = mass;
  body.inertia = inertia;
  body.position = position;
  return body;
}

inline BodyDef box_body(const std::string& name, double mass, const Triple& size, const Triple& position) {
  const auto moment = [mass](double a, double b) { return mass * (a * a + b * b) / 12; };
  return free_body(name, mass, {moment(size[1], size[2]), moment(size[0], size[2]), moment(size[0], size[1])},
                   position);
}

inline ShapeDef box_shape(const std::string& name, const std::string& body, const Triple& size) {
  ShapeDef shape;
  shape.name = name;
  shape.body = body;
  shape.type = contact::ShapeType::box;
  shape.size = size;
  return shape;
}

inline ShapeDef ball_shape(const std::string& name, const std::string& body, double radius) {
  ShapeDef shape;
  shape.name = name;
  shape.body = body;
  shape.type = contact::ShapeType::sphere;
  shape.radius = radius;
  return shape;
}

inline ShapeDef ground_shape(const std::string& name) {
  ShapeDef shape;
  shape.name = name;
  shape.type = contact::ShapeType::plane;
  shape.orientation = kUpward;
  return shape;
}

inline ContactPairDef pair_of(const std::string& a, const std::string& b, const contact::NormalLawDef& normal,
                              const std::string& friction = "") {
  ContactPairDef pair;
  pair.name = a + "_" + b;
  pair.shape_a = a;
  pair.shape_b = b;
  pair.normal = normal;
  pair.friction = friction;
  return pair;
}

inline FrictionDef dry_friction(const std::string& name, double mu) {
  FrictionDef friction;
  friction.name = name;
  friction.law.stiffness = 1e6;
  friction.law.damping = 1e3;
  friction.law.viscosity = 0;
  friction.law.static_coefficient = mu;
  friction.law.dynamic_coefficient = mu;
  return friction;
}

// adds a body on a floating joint
inline void add_free(MechanicsDef& def, const BodyDef& body, const Triple& velocity = {}) {
  def.bodies.push_back(body);
  JointDef joint;
  joint.name = body.name + "_Free";
  joint.type = JointType::floating;
  joint.body2 = body.name;
  joint.point1 = body.position;
  joint.initial_translation = velocity;
  def.joints.push_back(joint);
}

// How a mechanism is moved: formulation, and the rule of its sub-steps where that can be chosen.
struct Way {
  Way(Formulation chosen = Formulation::recursive, Integrator rule = Integrator::rk4)  // NOLINT: a formulation is one
      : formulation(chosen), integrator(rule) {}
  Formulation formulation;
  Integrator integrator;
};

// the cheap one, for long runs
inline bool is_recursion(const Way& way) {
  return way.formulation == Formulation::recursive && way.integrator == Integrator::rk4;
}

inline std::string name_of(const Way& way) {
  return name_of(way.formulation) + (way.integrator == Integrator::rk4 ? "" : "_" + name_of(way.integrator));
}
inline std::string name_of_way(const ::testing::TestParamInfo<Way>& test) {
  return name_of(test.param);
}

// in the gate: each formulation with its own rule, and an implicit one
inline std::vector<Way> gate_ways() {
  using enum Formulation;
  return {recursive, lagrange, augmented, penalty, {recursive, Integrator::trapezoidal}};
}

// the other implicit rules of the two formulations that have a choice
inline std::vector<Way> nightly_ways() {
  using enum Formulation;
  return {{recursive, Integrator::generalised_alpha},
          {recursive, Integrator::sdirk2},
          {lagrange, Integrator::trapezoidal},
          {lagrange, Integrator::generalised_alpha},
          {lagrange, Integrator::sdirk2}};
}

// A mechanism that is moved in one way by communication steps.
class Motion : public Mechanism {
 public:
  explicit Motion(const MechanicsDef& def, const Way& way = {})
      : Mechanism(def),
        dynamics(way.formulation, model, state, {way.integrator, def.spectral_radius, def.iteration_tolerance}) {}

  // one communication step of h; false when it was flagged
  bool step(double h) {
    dynamics.evaluate(model, state, ws);
    return dynamics.advance(model, state, ws, h, {}, {});
  }
  void run(double time, double h) {
    const long steps = std::lround(time / h);
    for (long i = 0; i < steps; ++i) is_sound = step(h) && is_sound;
    see();
  }

  Dynamics dynamics;
  bool is_sound = true;
};

}  // namespace slew::multibody::testing
