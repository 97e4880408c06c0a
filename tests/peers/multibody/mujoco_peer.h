// SPDX-License-Identifier: Apache-2.0
// A MechanicsDef as a model of MuJoCo (Todorov, Erez, Tassa 2012), written as its XML and compiled by it.
//
// Every body of the Def is a body there, fixed joints are bodies without a joint, static dummies nested bodies. No
// armature, damping, contact or constraint; inertia as given, not balanced or bounded. Force elements act by
// def_laws.h.
//
// Not covered: dummies on forces (the loops that they close are soft there), bodies without inertia, motion (its
// integrators are of the first order or take fixed steps).
#pragma once

#include <memory>

#include "tests/peers/multibody/body_motion.h"

namespace slew::multibody::testing {

class MujocoPeer {
 public:
  // Throws std::invalid_argument for a Def with dummies on forces, std::runtime_error with MuJoCo's words.
  explicit MujocoPeer(const MechanicsDef& def);
  ~MujocoPeer();

  // Takes poses and velocities; they must obey the joints.
  void set_motion(const Motions& motions);

  // Poses and velocities now, accelerations under gravity, force elements and the given wrenches, one per body.
  [[nodiscard]] Motions accelerate(Wrenches wrenches);

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace slew::multibody::testing
