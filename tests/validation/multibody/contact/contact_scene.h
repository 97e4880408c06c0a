// Bodies on a ground, as a scene defines them, moved by the Dynamics of either formulation.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "multibody/formulation.h"
#include "multibody/observe.h"
#include "multibody/validate.h"

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

class Motion {
 public:
  explicit Motion(const MechanicsDef& def, Formulation formulation = Formulation::recursive)
      : model((expect_sound(def), build_model(def))),
        state(start_state(model)),
        ws(model),
        dynamics(formulation, model, state) {
    see();
  }

  static void expect_sound(const MechanicsDef& def) {
    Problems problems;
    validate(def, problems);
    for (const Problem& problem : problems) ADD_FAILURE() << problem.path << ": " << problem.what;
  }

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
  void see() { observe(model, state, ws); }

  [[nodiscard]] BodyPose pose(const std::string& body) const { return body_pose(model, ws, find_body(model, body)); }
  [[nodiscard]] double total_energy() const {
    const Energy e = energy(model, ws);
    return e.kinetic + e.potential;
  }
  [[nodiscard]] double value(const std::string& variable) const {
    const std::vector<ElementVariable> names = variables(model);
    std::vector<double> values(names.size());
    read_variables(model, state, ws, {}, values);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == variable) return values[i];
    }
    ADD_FAILURE() << "no variable " << variable;
    return 0;
  }

  Model model;
  State state;
  Workspace ws;
  Dynamics dynamics;
  bool is_sound = true;
};

}  // namespace slew::multibody::testing
