// SPDX-License-Identifier: Apache-2.0
#include "contact/contact_memory.h"

#include <algorithm>
#include <utility>

#include "core/check.h"

namespace slew::contact {

using math::Mat3;
using math::Vec3;

namespace {

// part of a small turn from `before` to `after` about n; sine instead of angle, a sub-step turns little
double turn_about(Vec3 n, const Mat3& before, const Mat3& after) noexcept {
  const Mat3 turn = after * transpose(before);
  return dot(n, Vec3(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1))) / 2;
}

}  // namespace

ContactMemory::ContactMemory(const ContactModel& model)
    : states_(model.pairs().size() * kMaxPointsPerPair),
      old_states_(states_.size()),
      places_(states_.size()),
      old_places_(states_.size()),
      old_R_WF_(model.frame_count(), Mat3::identity()) {}

double ContactMemory::spin(const ContactModel& model, std::span<const Pose> poses, const Place& place) const noexcept {
  const ContactPair& pair = model.pairs()[place.pair];
  const std::size_t a = model.frame_of(pair.shape_a), b = model.frame_of(pair.shape_b);
  return (turn_about(place.n_W, old_R_WF_[a], poses[a].R_WF) + turn_about(place.n_W, old_R_WF_[b], poses[b].R_WF)) / 2;
}

RememberedContact ContactMemory::taken_over(const ContactModel& model, std::span<const Pose> poses,
                                            const Place& place) noexcept {
  const double largest = model.pairs()[place.pair].match_distance;
  double least = largest * largest;
  std::size_t nearest = old_count_;
  for (std::size_t i = 0; i < old_count_; ++i) {
    const Place& old = old_places_[i];
    if (old.pair != place.pair) continue;
    const Vec3 away = old.p_A - place.p_A;
    const double distance2 = dot(away, away);
    if (distance2 >= least) continue;
    least = distance2;
    nearest = i;
  }
  if (nearest == old_count_) return {};
  RememberedContact state = old_states_[nearest];
  turn_bristle(old_places_[nearest].n_W, place.n_W, spin(model, poses, place), state.friction);
  return state;
}

void ContactMemory::match(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept {
  SLEW_ASSERT(poses.size() == old_R_WF_.size() && set.points().size() <= states_.size());
  count_ = set.points().size();
  for (std::size_t i = 0; i < count_; ++i) {
    const ContactPoint& point = set.points()[i];
    const Pose& frame = poses[model.frame_of(model.pairs()[point.pair].shape_a)];
    places_[i] = {point.pair, transpose_multiply(frame.R_WF, point.p_W - frame.p_WF), point.n_W};
    states_[i] = taken_over(model, poses, places_[i]);
  }
  if (count_ == 0) return;
  for (std::size_t i = 0; i < poses.size(); ++i) old_R_WF_[i] = poses[i].R_WF;
}

void ContactMemory::advance(const ContactModel& model, std::span<const Pose> poses, const ContactSet& set) noexcept {
  std::swap(states_, old_states_);
  std::swap(places_, old_places_);
  old_count_ = count_;
  match(model, poses, set);
}

void ContactMemory::advance(const ContactMemory& before, const ContactModel& model, std::span<const Pose> poses,
                            const ContactSet& set) noexcept {
  SLEW_ASSERT(&before != this && before.states_.size() == states_.size());
  old_count_ = before.count_;
  std::copy_n(before.states_.begin(), old_count_, old_states_.begin());
  std::copy_n(before.places_.begin(), old_count_, old_places_.begin());
  if (old_count_ > 0) std::copy(before.old_R_WF_.begin(), before.old_R_WF_.end(), old_R_WF_.begin());
  match(model, poses, set);
}

void ContactMemory::assign(const ContactMemory& other) {
  if (states_.size() != other.states_.size()) {
    *this = other;
    return;
  }
  count_ = other.count_;
  std::copy_n(other.states_.begin(), count_, states_.begin());
  std::copy_n(other.places_.begin(), count_, places_.begin());
  if (count_ > 0) std::copy(other.old_R_WF_.begin(), other.old_R_WF_.end(), old_R_WF_.begin());
}

void ContactMemory::add_to_hash(StateHash& hash) const noexcept {
  if (count_ == 0) return;
  const auto add = [&hash](const Vec3& v) {
    for (const double x : v.array()) hash.add(x);
  };
  hash.add(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    hash.add(places_[i].pair);
    add(places_[i].p_A);
    add(places_[i].n_W);
    hash.add(states_[i].normal.impact_speed);
    add(states_[i].friction.z_W);
  }
  for (const Mat3& R : old_R_WF_) {
    for (const Vec3& column : R.c) add(column);
  }
}

template <typename Self, typename Bytes>
void ContactMemory::visit(Self& self, Bytes& bytes) {
  bytes.count(self.count_, self.states_.size());
  for (std::size_t i = 0; i < self.count_; ++i) {
    bytes.count(self.places_[i].pair, self.states_.size() / kMaxPointsPerPair - 1);
    visit_vector(bytes, self.places_[i].p_A);
    visit_vector(bytes, self.places_[i].n_W);
    bytes.number(self.states_[i].normal.impact_speed);
    visit_vector(bytes, self.states_[i].friction.z_W);
  }
  if (self.count_ == 0) return;
  for (auto& R : self.old_R_WF_) {
    for (auto& column : R.c) visit_vector(bytes, column);
  }
}

void ContactMemory::save(StateWriter& bytes) const {
  visit(*this, bytes);
}

void ContactMemory::load(StateReader& bytes) noexcept {
  visit(*this, bytes);
}

}  // namespace slew::contact
