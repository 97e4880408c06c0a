// Live constants of the elements by name: "Mount.stiffness.x", "Hoist.free_length".
#include <array>
#include <cstddef>

#include "multibody/forces/element_set.h"

namespace slew::multibody {
namespace {

constexpr std::array<std::string_view, 2> kLoadKeys = {"force", "torque"};  // by LoadKind
constexpr std::array<std::string_view, 18> kBushingKeys = {"stiffness.x",
                                                           "stiffness.y",
                                                           "stiffness.z",
                                                           "rotational_stiffness.x",
                                                           "rotational_stiffness.y",
                                                           "rotational_stiffness.z",
                                                           "damping.x",
                                                           "damping.y",
                                                           "damping.z",
                                                           "rotational_damping.x",
                                                           "rotational_damping.y",
                                                           "rotational_damping.z",
                                                           "preload_force.x",
                                                           "preload_force.y",
                                                           "preload_force.z",
                                                           "preload_moment.x",
                                                           "preload_moment.y",
                                                           "preload_moment.z"};
constexpr std::array<std::string_view, 1> kBeamKeys = {"damping_time"};

template <typename Element>
struct ElementMember {
  std::string_view key;
  double Element::*value;
};
constexpr std::array<ElementMember<Rope>, 4> kRopeMembers = {{{"free_length", &Rope::free_length},
                                                              {"stiffness", &Rope::spring},
                                                              {"axial_rigidity", &Rope::rigidity},
                                                              {"damping_constant", &Rope::damping}}};
constexpr std::array<ElementMember<Tyre>, 5> kTyreMembers = {{{"ground_height", &Tyre::height},
                                                              {"stiffness", &Tyre::stiffness},
                                                              {"damping", &Tyre::damping},
                                                              {"friction", &Tyre::friction},
                                                              {"rolling_resistance", &Tyre::rolling_resistance}}};

template <std::size_t N>
int index_of(const std::array<std::string_view, N>& keys, std::string_view key) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    if (keys[i] == key) return static_cast<int>(i);
  }
  return -1;
}

template <typename Element, std::size_t N>
int index_of(const std::array<ElementMember<Element>, N>& members, std::string_view key) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    if (members[i].key == key) return static_cast<int>(i);
  }
  return -1;
}

template <typename Element>
int position_of(const std::vector<Element>& elements, std::string_view name) noexcept {
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

double& bushing_value(Bushing& bushing, std::size_t member) noexcept {
  if (member < 6) return bushing.spring[member];
  return member < 12 ? bushing.damping[member - 6] : bushing.preload[member - 12];
}

}  // namespace

ElementValue find_value(const ElementSet& set, std::string_view element, std::string_view key) noexcept {
  if (const int i = position_of(set.loads, element); i >= 0) {
    const bool is_own = key == kLoadKeys[static_cast<std::size_t>(set.loads[static_cast<std::size_t>(i)].kind)];
    return {ElementKind::load, i, is_own ? 0 : -1};
  }
  if (const int i = position_of(set.bushings, element); i >= 0)
    return {ElementKind::bushing, i, index_of(kBushingKeys, key)};
  if (const int i = position_of(set.beams, element); i >= 0) return {ElementKind::beam, i, index_of(kBeamKeys, key)};
  if (const int i = position_of(set.ropes, element); i >= 0) return {ElementKind::rope, i, index_of(kRopeMembers, key)};
  if (const int i = position_of(set.tyres, element); i >= 0) return {ElementKind::tyre, i, index_of(kTyreMembers, key)};
  return {};
}

double& value_of(ElementSet& set, ElementValue value) noexcept {
  const auto i = static_cast<std::size_t>(value.element), m = static_cast<std::size_t>(value.member);
  switch (value.kind) {
    case ElementKind::load:
      return set.loads[i].constant;
    case ElementKind::bushing:
      return bushing_value(set.bushings[i], m);
    case ElementKind::beam:
      return set.beams[i].damping_time;
    case ElementKind::rope:
      return set.ropes[i].*kRopeMembers[m].value;
    case ElementKind::tyre:
      break;
  }
  return set.tyres[i].*kTyreMembers[m].value;
}

std::size_t value_count(const ElementSet& set) noexcept {
  return set.loads.size() + set.bushings.size() * kBushingKeys.size() + set.beams.size() +
         set.ropes.size() * kRopeMembers.size() + set.tyres.size() * kTyreMembers.size();
}

bool has_value(const ElementSet& set, ElementValue value) noexcept {
  const auto is_in = [&](const auto& elements, std::size_t members) {
    return value.element >= 0 && static_cast<std::size_t>(value.element) < elements.size() && value.member >= 0 &&
           static_cast<std::size_t>(value.member) < members;
  };
  switch (value.kind) {
    case ElementKind::load:
      return is_in(set.loads, 1);
    case ElementKind::bushing:
      return is_in(set.bushings, kBushingKeys.size());
    case ElementKind::beam:
      return is_in(set.beams, kBeamKeys.size());
    case ElementKind::rope:
      return is_in(set.ropes, kRopeMembers.size());
    case ElementKind::tyre:
      return is_in(set.tyres, kTyreMembers.size());
  }
  return false;
}

namespace {

template <typename Set, typename Visit>
void for_each_value(Set& set, Visit visit) {
  for (auto& load : set.loads) visit(load.constant);
  for (auto& bushing : set.bushings) {
    for (auto* values : {&bushing.spring, &bushing.damping, &bushing.preload}) {
      for (auto& value : *values) visit(value);
    }
  }
  for (auto& beam : set.beams) visit(beam.damping_time);
  for (auto& rope : set.ropes) {
    for (const auto& member : kRopeMembers) visit(rope.*member.value);
  }
  for (auto& tyre : set.tyres) {
    for (const auto& member : kTyreMembers) visit(tyre.*member.value);
  }
}

}  // namespace

void add_to_hash(const ElementSet& set, StateHash& hash) noexcept {
  for_each_value(set, [&](double value) { hash.add(value); });
}

void save(const ElementSet& set, StateWriter& bytes) {
  for_each_value(set, [&](double value) { bytes.number(value); });
}

void load(ElementSet& set, StateReader& bytes) noexcept {
  for_each_value(set, [&](double& value) { bytes.number(value); });
}

}  // namespace slew::multibody
