// SPDX-License-Identifier: Apache-2.0
// Results of a search for contacts and their forces, and the data that a sub-step needs to advance contacts.
#pragma once

#include <vector>

#include "contact/contact_memory.h"
#include "multibody/contacts/contact_elements.h"

namespace slew::multibody {

// A contact point and its forces on shape A; B has the opposite ones.
struct ContactForce {
  int pair = 0;  // of ContactElements::pairs
  int frame_a = 0, frame_b = 0;
  math::Vec3 p_W;         // m
  math::Vec3 n_W;         // unit, from B to A
  math::Vec3 normal_W;    // N, on A
  math::Vec3 friction_W;  // N, on A
  double depth = 0;       // m
  double depth_rate = 0;  // m/s
  double energy = 0;      // J, held by the normal law's spring and by the bristles
};

// Blocks of a symmetric 6 by 6 matrix: rows and columns of push, rows of turn and columns of push, of turn.
struct ScaledSlopes {
  math::Mat3 push, mixed, turn;
};

// A link taken as free, and the sums of its contacts, scaled by its mass (contact_rate.h).
struct ContactRates {
  bool is_touched = false;   // false: the other members are not valid
  math::Vec3 c_W;            // m, centre of mass
  double per_root_mass = 0;  // 1/sqrt(kg)
  math::Mat3 turning;        // from a moment in Ground axes [1/(kg^0.5 m)]
  ScaledSlopes damping;      // 1/s
  ScaledSlopes stiffness;    // 1/s^2
};

struct ContactWorkspace {
  explicit ContactWorkspace(const ContactElements& elements);

  struct FrameSpeed {
    math::Vec3 v_W;  // m/s, velocity of the origin
    math::Vec3 w_W;  // rad/s
  };

  contact::ContactSet set;
  contact::ContactMemory before;                         // at the start of the sub-step
  contact::ContactMemory now;                            // carried to the instant of the search
  std::vector<contact::Pose> poses, start_poses, ahead;  // by frame: now, at the start, where the start's speeds lead
  std::vector<FrameSpeed> start_speeds;                  // by frame
  std::vector<unsigned char> was_touching;               // by pair, at the start: 0 or 1
  std::vector<ContactForce> forces;                      // forces of the last search
  std::size_t force_count = 0;
  std::vector<ContactRates> rates;  // by link, up to the last one with a shape
  double time = 0;                  // s, since the start of the sub-step
  bool is_near = true;   // something touches or may touch within the sub-step; false: no search until its end
  bool is_hit = false;   // in the last accepted sub-step a contact closed or deepened faster than the smallest impact
                         // speed of its law
  bool is_lost = false;  // since this was last cleared, shapes passed through each other, or contacts were faster than
                         // the shortest part
  int lost_pair = -1;    // of ContactElements::pairs, the first one that is_lost was set for; -1: none, or its parts
};

}  // namespace slew::multibody
