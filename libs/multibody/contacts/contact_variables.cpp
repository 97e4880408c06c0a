// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <string>

#include "core/static_vector.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Vec3;

namespace {

constexpr std::size_t kPerPair = 11, kPerPoint = 11;

// Sums over the points of one pair.
struct PairSum {
  double count = 0, depth = 0, pressure = 0;
  Vec3 normal_W, friction_W, moment_W;  // N, N, N m: points weighted by their normal force

  // centre of pressure; Ground's origin while nothing presses
  [[nodiscard]] Vec3 center() const noexcept { return pressure > 0 ? moment_W * (1 / pressure) : Vec3(); }
};

PairSum sum_of(std::size_t pair, const ContactWorkspace& contacts) noexcept {
  PairSum sum;
  for (std::size_t i = 0; i < contacts.force_count; ++i) {
    const ContactForce& force = contacts.forces[i];
    if (static_cast<std::size_t>(force.pair) != pair) continue;
    const double pressure = norm(force.normal_W);
    sum.count += 1;
    sum.depth = std::max(sum.depth, force.depth);
    sum.pressure += pressure;
    sum.normal_W += force.normal_W;
    sum.friction_W += force.friction_W;
    sum.moment_W += force.p_W * pressure;
  }
  return sum;
}

// The points of a pair in its slots, as indices of ContactWorkspace::forces in the order of the search; the deepest
// when there are more of them than slots.
using Slots = StaticVector<std::size_t, contact::kMaxPointsPerPair>;

Slots slots_of(std::size_t pair, std::size_t count, const ContactWorkspace& contacts) noexcept {
  Slots slots;
  for (std::size_t i = 0; i < contacts.force_count; ++i) {
    if (static_cast<std::size_t>(contacts.forces[i].pair) == pair) slots.push_back(i);
  }
  while (slots.size() > count) {
    std::size_t least = 0;
    for (std::size_t k = 1; k < slots.size(); ++k) {
      if (contacts.forces[slots[k]].depth <= contacts.forces[slots[least]].depth) least = k;
    }
    std::copy(slots.begin() + least + 1, slots.end(), slots.begin() + least);
    slots.resize(slots.size() - 1);
  }
  return slots;
}

void append_vector(const std::string& name, Dimension dimension, std::vector<ElementVariable>& variables) {
  for (const char* axis : {".x", ".y", ".z"}) variables.push_back({name + axis, dimension});
}

// Writes values one after the other as far as there is room.
struct Writer {
  std::span<double> values;
  std::size_t next = 0;

  [[nodiscard]] bool has_room(std::size_t count) const noexcept { return next + count <= values.size(); }
  void put(double x) noexcept { values[next++] = x; }
  void put(const Vec3& vector) noexcept {
    for (const double x : vector.array()) put(x);
  }
};

}  // namespace

void append_contact_variables(const Model& model, std::vector<ElementVariable>& variables) {
  if (model.contact == nullptr) return;
  for (const ContactPairElement& pair : model.contact->pairs) {
    variables.push_back({pair.name + ".contacts", Dimension::none});
    variables.push_back({pair.name + ".depth", Dimension::length});
    append_vector(pair.name + ".normal_force", Dimension::force, variables);
    append_vector(pair.name + ".friction_force", Dimension::force, variables);
    append_vector(pair.name + ".center_of_pressure", Dimension::length, variables);
    for (std::size_t slot = 1; slot <= pair.point_slots; ++slot) {
      const std::string point = pair.name + ".point" + std::to_string(slot);
      append_vector(point + ".position", Dimension::length, variables);
      append_vector(point + ".normal", Dimension::none, variables);
      variables.push_back({point + ".depth", Dimension::length});
      variables.push_back({point + ".normal_force", Dimension::force});
      append_vector(point + ".friction_force", Dimension::force, variables);
    }
  }
}

std::size_t read_contact_variables(const Model& model, const Workspace& ws, std::span<double> values) noexcept {
  if (model.contact == nullptr) return 0;
  Writer row{values};
  for (std::size_t pair = 0; pair < model.contact->pairs.size(); ++pair) {
    const std::size_t point_slots = model.contact->pairs[pair].point_slots;
    if (!row.has_room(kPerPair + kPerPoint * point_slots)) break;
    const PairSum sum = sum_of(pair, *ws.contact);
    row.put(sum.count);
    row.put(sum.depth);
    row.put(sum.normal_W);
    row.put(sum.friction_W);
    row.put(sum.center());
    const Slots slots = slots_of(pair, point_slots, *ws.contact);
    for (std::size_t slot = 0; slot < point_slots; ++slot) {
      const ContactForce point = slot < slots.size() ? ws.contact->forces[slots[slot]] : ContactForce{};
      row.put(point.p_W);
      row.put(point.n_W);
      row.put(point.depth);
      row.put(dot(point.normal_W, point.n_W));
      row.put(point.friction_W);
    }
  }
  return row.next;
}

}  // namespace slew::multibody
