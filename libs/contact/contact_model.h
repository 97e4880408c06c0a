// SPDX-License-Identifier: Apache-2.0
// Contacts of the declared pairs at given poses of their frames.
//
//   ContactModel   immutable: shapes, pairs, laws
//   ContactSet     the contacts found, and memory of the search; sized once
//   find_contacts  poses of the frames -> contacts, in the order of the pairs
//
// A pair is first tested by bounding spheres, then by the kernel of its types (kernels.h). Pairs are few and declared,
// so there is no broad phase over all shapes. A pair that was found apart is not searched again until the motion of
// both shapes exceeds their distance (clearance.cpp): this saves time and finds the same contacts.
//
// Real-time safe: no search allocates or locks, and its cost is bounded. A search covers one instant; sweep.h finds
// shapes that passed through each other between two instants.
#pragma once

#include <span>
#include <vector>

#include "contact/contact_def.h"
#include "contact/manifold.h"
#include "contact/solid.h"

namespace slew::contact {

// Pose of a frame in the world.
struct Pose {
  math::Vec3 p_WF;                           // m
  math::Mat3 R_WF = math::Mat3::identity();  // columns are the frame's axes
};

struct ContactPoint {
  std::size_t pair = 0;  // index of ContactDef::pairs
  math::Vec3 p_W;        // m, half way between both surfaces
  math::Vec3 n_W;        // unit, from shape B to shape A: a normal force F pushes A along it
  double depth = 0;      // m, > 0
  double share = 0;      // share of the pair's stiffness; the shares of a pair sum to 1
};

// match_distance over the bounding radius of the smaller shape
inline constexpr double kMatchShare = 0.1;

struct ContactPair {
  std::size_t shape_a = 0, shape_b = 0;
  NormalLaw normal;
  FrictionLaw friction;
  bool has_friction = false;
  double match_distance = 0;  // m: contacts of two searches nearer than this may match
  double half_thickness = 0;  // m: a displacement shorter than this stays on its side (sweep.h)
};

class ContactSet;

class ContactModel {
 public:
  [[nodiscard]] std::span<const ContactPair> pairs() const noexcept { return pairs_; }
  [[nodiscard]] std::size_t frame_of(std::size_t shape) const noexcept { return shapes_[shape].frame; }
  [[nodiscard]] std::size_t frame_count() const noexcept { return frame_count_; }

 private:
  friend ContactModel build(const ContactDef& def);
  friend class ContactSet;
  friend void find_contacts(const ContactModel& model, std::span<const Pose> poses, ContactSet& set) noexcept;
  friend class Sweeper;
  ContactModel() = default;

  struct Shape {
    Geometry geometry;
    std::size_t frame = 0;
    math::Vec3 p_FS;
    math::Mat3 R_FS;
    double extent = 0;  // m, distance of the farthest point from the frame's origin
  };
  [[nodiscard]] Solid place(const Shape& shape, const Pose& pose) const noexcept;
  void find_pair(std::size_t pair, const Pose& frame_a, const Pose& frame_b, ContactSet& set) const noexcept;
  [[nodiscard]] bool is_clear(std::size_t pair, const Pose& frame_a, const Pose& frame_b,
                              const ContactSet& set) const noexcept;
  void note_clearance(std::size_t pair, const Pose& frame_a, const Pose& frame_b, ContactSet& set) const noexcept;

  std::vector<Shape> shapes_;
  std::vector<ContactPair> pairs_;
  std::size_t frame_count_ = 0;
};

// Pre-condition: validate() found nothing.
[[nodiscard]] ContactModel build(const ContactDef& def);

class ContactSet {
 public:
  explicit ContactSet(const ContactModel& model);

  // Contacts in the order of the pairs.
  [[nodiscard]] std::span<const ContactPoint> points() const noexcept { return {points_.data(), count_}; }

 private:
  friend class ContactModel;
  friend class Sweeper;
  friend void find_contacts(const ContactModel& model, std::span<const Pose> poses, ContactSet& set) noexcept;
  // Poses at which a pair was found apart, and the lower bound of its distance.
  struct Clearance {
    Pose frame_a, frame_b;
    double distance = 0;  // m; 0: unknown
  };

  std::vector<ContactPoint> points_;
  std::vector<Clearance> clearances_;  // by pair
  std::size_t count_ = 0;
  Manifold manifold_;
};

// poses: one per frame, in the order of ContactDef::frames.
void find_contacts(const ContactModel& model, std::span<const Pose> poses, ContactSet& set) noexcept;

}  // namespace slew::contact
