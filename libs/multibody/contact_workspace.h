// What a search for contacts and their forces leaves behind, and what a sub-step needs to carry contacts along.
#pragma once

#include <vector>

#include "contact/contact_memory.h"
#include "multibody/contact_elements.h"

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
  double energy = 0;      // J, held by the normal law's spring and by the bristles
};

struct ContactWorkspace {
  explicit ContactWorkspace(const ContactElements& elements);

  struct FrameSpeed {
    math::Vec3 v_W;  // m/s, of the origin
    math::Vec3 w_W;  // rad/s
  };

  contact::ContactSet set;
  contact::ContactMemory before;                         // at the start of the sub-step
  contact::ContactMemory now;                            // carried to the instant of the search
  std::vector<contact::Pose> poses, start_poses, ahead;  // by frame: now, at the start, where the start's speeds lead
  std::vector<FrameSpeed> start_speeds;                  // by frame
  std::vector<unsigned char> was_touching;               // by pair, at the start: 0 or 1
  std::vector<ContactForce> forces;                      // of the last search
  std::size_t force_count = 0;
  double time = 0;          // s, since the start of the sub-step
  bool is_near = true;      // something touches or may touch within the sub-step; false: no search until its end
  bool has_passed = false;  // shapes went through each other unseen since this was last cleared
};

}  // namespace slew::multibody
