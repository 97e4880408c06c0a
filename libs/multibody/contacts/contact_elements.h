// SPDX-License-Identifier: Apache-2.0
// The contacts of a mechanism, ready for searches: frames on links, and pairs.
//
// Immutable and shared by all copies of a Model (live parameters do not reach it). A pair of shapes that cannot move
// against each other (both on Ground, or on bodies that fixed joints merge), or that the scene excludes from tests,
// keeps its name and is never searched.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/contact_model.h"
#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

struct Model;

// A body with shapes.
struct ContactFrame {
  int body = 0, link = 0;
  math::Mat3 R_LB;  // pose in the link
  math::Vec3 p_LB;  // m
};

struct ContactPairElement {
  std::string name;
  std::size_t point_slots = 0;  // contact points that are variables
  int tested = -1;              // pair of ContactElements::model; -1: the pair is never searched
};

struct ContactElements {
  contact::ContactModel model;
  std::vector<ContactFrame> frames;       // those of the model
  std::vector<ContactPairElement> pairs;  // all of the scene, in its order
  std::vector<int> pair_of_tested;        // index of pairs, by pair of the model
  double substep = 0;                     // s
};

// None when the scene declares no pair. Pre-condition: validate() found nothing; bodies and links of the model are
// there.
[[nodiscard]] std::shared_ptr<const ContactElements> build_contacts(const MechanicsDef& mechanics, const Model& model);

// Appends the problems of shapes, pairs and frictions. Pre-condition: the rest of the mechanics is sound.
void validate_contacts(const MechanicsDef& mechanics, Problems& problems);

}  // namespace slew::multibody
