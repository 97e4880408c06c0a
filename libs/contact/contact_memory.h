// What contacts remember from one search to the next: impact speed and bristles, found again by place.
//
// A contact of this search is the one of the last search that is nearest to it among those of its pair, seen from the
// frame of shape A, and nearer than a tenth of the smaller shape. Two new ones may come from the same old one: a corner
// that is found as two points, each with half of the load, keeps the bending and so the force of both together.
// A contact without predecessor starts afresh: no impact speed, straight bristles. Bristles turn with their normal, and
// about it by the mean of what both frames turned.
// An integrator follows the state it has accepted and, for a trial within the step, what comes after a state that stays
// as it is (follow with `before`).
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
  ContactMemory() = default;  // without pairs
  explicit ContactMemory(const ContactModel& model);

  // To be called after each search with the poses that it had; states() then belongs to set.points(), one each.
  void follow(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept;

  // Becomes what `before` would become, which stays as it is: for a trial of an integrator. Both are of this model.
  void follow(const ContactMemory& before, const ContactModel& model, std::span<const Pose> poses,
              const ContactSet& set) noexcept;

  // The same contacts as `other`, of the same model. Costs by what is remembered; allocates only into an empty one.
  void assign(const ContactMemory& other);

  // Raw bits of all that is remembered; nothing while nothing touches.
  void add_to_hash(StateHash& hash) const noexcept;
  // The same as bytes. What is loaded belongs to the same model.
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
