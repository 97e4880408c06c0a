#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "multibody/observe.h"

namespace slew::multibody {

using math::Vec3;

namespace {

constexpr std::size_t kPerPair = 11;

// What the points of one pair add up to.
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

}  // namespace

void append_contact_variables(const Model& model, std::vector<ElementVariable>& variables) {
  if (model.contact == nullptr) return;
  for (const ContactPairElement& pair : model.contact->pairs) {
    variables.push_back({pair.name + ".contacts", Dimension::none});
    variables.push_back({pair.name + ".depth", Dimension::length});
    for (const auto& [quantity, dimension] :
         {std::pair(".normal_force", Dimension::force), std::pair(".friction_force", Dimension::force),
          std::pair(".center_of_pressure", Dimension::length)}) {
      for (const char* axis : {".x", ".y", ".z"}) variables.push_back({pair.name + quantity + axis, dimension});
    }
  }
}

std::size_t read_contact_variables(const Model& model, const Workspace& ws, std::span<double> values) noexcept {
  if (model.contact == nullptr) return 0;
  std::size_t next = 0;
  for (std::size_t pair = 0; pair < model.contact->pairs.size() && next + kPerPair <= values.size(); ++pair) {
    const PairSum sum = sum_of(pair, *ws.contact);
    values[next++] = sum.count;
    values[next++] = sum.depth;
    for (const Vec3& vector : {sum.normal_W, sum.friction_W, sum.center()}) {
      for (const double x : vector.array()) values[next++] = x;
    }
  }
  return next;
}

}  // namespace slew::multibody
