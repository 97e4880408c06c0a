// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/element_set.h"

#include <algorithm>
#include <cstddef>

namespace slew::multibody {
namespace {

// visit(row, elements) for every kind
template <typename Set, typename Visit>
void for_each_list(Set& set, Visit visit) {
  for_each_force_kind([&](auto row) { visit(row, elements_of(row, set)); });
}

// visit(row, elements) for the kind with this number
template <typename Set, typename Visit>
void at_kind(Set& set, int kind, Visit visit) {
  int number = 0;
  for_each_list(set, [&](auto row, auto& elements) {
    if (number++ == kind) visit(row, elements);
  });
}

template <typename Element>
int position_of(const std::vector<Element>& elements, std::string_view name) noexcept {
  const auto found =
      std::find_if(elements.begin(), elements.end(), [&](const Element& element) { return element.name == name; });
  return found == elements.end() ? -1 : static_cast<int>(found - elements.begin());
}

int index_of_key(std::span<const std::string_view> keys, std::string_view key) noexcept {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? -1 : static_cast<int>(found - keys.begin());
}

// visit(value) for every live value
template <typename Visit>
void for_each_value(ElementSet& set, Visit visit) {
  for_each_list(set, [&](auto row, auto& elements) {
    for (auto& element : elements) {
      const std::size_t count = row.value_keys(element).size();
      for (std::size_t i = 0; i < count; ++i) visit(*row.value(element, i));
    }
  });
}
template <typename Visit>
void for_each_value(const ElementSet& set, Visit visit) {
  for_each_value(const_cast<ElementSet&>(set), [&](const double& value) { visit(value); });
}

}  // namespace

double stored_energy(const ElementSet& set, std::span<const LinkMotion> motion) noexcept {
  double energy = 0;
  for_each_list(set, [&](auto row, const auto& elements) {
    for (const auto& element : elements) energy += row.energy(element, motion);
  });
  return energy;
}

bool depends_on_time(const ElementSet& set) noexcept {
  bool depends = false;
  for_each_list(set, [&](auto row, const auto& elements) {
    for (const auto& element : elements) depends = depends || row.depends_on_time(element);
  });
  return depends;
}

bool has_slopes(const ElementSet& set) noexcept {
  bool has = false;
  for_each_list(set, [&](auto row, const auto& elements) { has = has || (row.kHasSlopes && !elements.empty()); });
  return has;
}

std::size_t stop_count(const ElementSet& set) noexcept {
  std::size_t count = 0;
  for_each_list(set, [&](auto row, const auto& elements) { count += row.kHasStops ? elements.size() : 0; });
  return count;
}

void list_variables(const ElementSet& set, std::vector<ElementVariable>& variables) {
  VariableNames names(variables);
  for_each_list(set, [&](auto row, const auto& elements) {
    for (const auto& element : elements) row.list_variables(element, names);
  });
}

void read_variables(const ElementSet& set, std::span<const LinkMotion> motion, double time,
                    VariableSink& sink) noexcept {
  for_each_list(set, [&](auto row, const auto& elements) {
    for (const auto& element : elements) row.read_variables(element, motion, time, sink);
  });
}

int find_load(const ElementSet& set, std::string_view name) noexcept {
  return position_of(set.loads, name);
}

ElementValue find_value(const ElementSet& set, std::string_view element, std::string_view key) noexcept {
  ElementValue value;
  int kind = 0;
  for_each_list(set, [&](auto row, const auto& elements) {
    const int i = value.kind < 0 ? position_of(elements, element) : -1;
    if (i >= 0) value = {kind, i, index_of_key(row.value_keys(elements[static_cast<std::size_t>(i)]), key)};
    ++kind;
  });
  return value;
}

double& value_of(ElementSet& set, ElementValue value) noexcept {
  double* found = nullptr;
  at_kind(set, value.kind, [&](auto row, auto& elements) {
    found = row.value(elements[static_cast<std::size_t>(value.element)], static_cast<std::size_t>(value.member));
  });
  return *found;
}

std::size_t value_count(const ElementSet& set) noexcept {
  std::size_t count = 0;
  for_each_value(set, [&](double) { ++count; });
  return count;
}

bool has_value(const ElementSet& set, ElementValue value) noexcept {
  bool has = false;
  at_kind(set, value.kind, [&](auto row, const auto& elements) {
    const auto i = static_cast<std::size_t>(value.element), m = static_cast<std::size_t>(value.member);
    has = value.element >= 0 && i < elements.size() && value.member >= 0 && m < row.value_keys(elements[i]).size();
  });
  return has;
}

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
