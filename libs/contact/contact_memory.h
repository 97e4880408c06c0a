// SPDX-License-Identifier: Apache-2.0
// State of contacts from one search to the next: impact speed and bristles, matched by position.
//
// A contact of this search is matched to the nearest contact of its pair in the last search, in the frame of shape A,
// if it is nearer than a tenth of the smaller shape. Two new contacts may match the same old one: a corner found as two
// points, each with half of the load, keeps the bending and so the total force.
// A contact without predecessor starts with no impact speed and straight bristles. Bristles turn with their normal, and
// about it by the mean turn of both frames.
// An integrator advances the state that it has accepted. For a trial within the step it computes the successor of an
// unchanged state (the overload with `before`).
// Real-time safe. Not covered: bristles of points that vanish are lost, also when another point takes their load over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/contact_model.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"

namespace slew::contact {

struct RememberedContact {
  NormalState normal;
  FrictionState friction;
};

class ContactMemory {
 public:
  ContactMemory() = default;  // memory without pairs
  explicit ContactMemory(const ContactModel& model);

  // To be called after each search with the poses that it had; states() then belongs to set.points(), one each.
  void advance(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept;

  // Becomes the successor of `before`, which stays unchanged: for a trial of an integrator. Both belong to this model.
  void advance(const ContactMemory& before, const ContactModel& model, std::span<const Pose> poses,
               const ContactSet& set) noexcept;

  // Copies the contacts of `other`, of the same model. The cost grows with the remembered contacts; allocates only into
  // an empty memory.
  void assign(const ContactMemory& other);

  // Adds the raw bits of all states; no bits without contact.
  void add_to_hash(StateHash& hash) const noexcept;
  // The same as bytes. Loaded bytes belong to the same model.
  void save(StateWriter& bytes) const;
  void load(StateReader& bytes) noexcept;

  [[nodiscard]] std::span<RememberedContact> states() noexcept { return {states_.data(), count_}; }
  [[nodiscard]] std::span<const RememberedContact> states() const noexcept { return {states_.data(), count_}; }

 private:
  struct Place {
    std::size_t pair = 0;
    math::Vec3 p_A;  // m, in the frame of shape A
    math::Vec3 n_W;
  };
  template <typename Self, typename Bytes>
  static void visit(Self& self, Bytes& bytes);
  void match(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept;
  [[nodiscard]] RememberedContact taken_over(const ContactModel& model, std::span<const Pose> poses,
                                             const Place& place) noexcept;
  [[nodiscard]] double spin(const ContactModel& model, std::span<const Pose> poses, const Place& place) const noexcept;

  std::vector<RememberedContact> states_, old_states_;
  std::vector<Place> places_, old_places_;
  std::vector<math::Mat3> old_R_WF_;  // by frame
  std::size_t count_ = 0, old_count_ = 0;
};

}  // namespace slew::contact
