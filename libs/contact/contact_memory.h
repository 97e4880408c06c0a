// What contacts remember from one search to the next: impact speed and bristles, found again by place.
//
// A contact of this search is the one of the last search that is nearest to it among those of its pair, seen from the
// frame of shape A, and nearer than a tenth of the smaller shape; each old contact is taken once, in the order of the
// new ones. A contact without predecessor starts afresh: no impact speed, straight bristles. Bristles turn with their
// normal, and about it by the mean of what both frames turned.
// Real-time safe. Not covered: bristles of points that vanish are lost, also when another point takes their load over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/contact_model.h"

namespace slew::contact {

struct RememberedContact {
  NormalState normal;
  FrictionState friction;
};

class ContactMemory {
 public:
  explicit ContactMemory(const ContactModel& model);

  // To be called after each search with the poses that it had; states() then belongs to set.points(), one each.
  void follow(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept;

  [[nodiscard]] std::span<RememberedContact> states() noexcept { return {states_.data(), count_}; }
  [[nodiscard]] std::span<const RememberedContact> states() const noexcept { return {states_.data(), count_}; }

 private:
  struct Place {
    std::size_t pair = 0;
    math::Vec3 p_A;  // m, in the frame of shape A
    math::Vec3 n_W;
    bool is_taken = false;
  };
  [[nodiscard]] RememberedContact taken_over(const ContactModel& model, std::span<const Pose> poses,
                                             const Place& place) noexcept;
  [[nodiscard]] double spin(const ContactModel& model, std::span<const Pose> poses, const Place& place) const noexcept;

  std::vector<RememberedContact> states_, old_states_;
  std::vector<Place> places_, old_places_;
  std::vector<math::Mat3> old_R_WF_;  // by frame
  std::size_t count_ = 0, old_count_ = 0;
};

}  // namespace slew::contact
