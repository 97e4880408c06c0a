// SPDX-License-Identifier: Apache-2.0
// The force elements of a mechanism beyond spring-dampers, as flat arrays by kind (force_kinds.h).
//
// No element has a state: all are functions of the links' motions and of time.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "multibody/forces/force_kinds.h"

namespace slew::multibody {

struct ElementSet : ForceKinds::Elements {};

// The elements of a kind.
template <typename Row>
[[nodiscard]] auto& elements_of(Row /*row*/, ElementSet& set) noexcept {
  return set.*Row::kElements;
}
template <typename Row>
[[nodiscard]] const auto& elements_of(Row /*row*/, const ElementSet& set) noexcept {
  return set.*Row::kElements;
}

// Calls add(link, body, wrench) for every link that every element touches. motion: of all links; time [s].
template <typename Add>
void for_each_wrench(const ElementSet& set, std::span<const LinkMotion> motion, double time, Add&& add) noexcept {
  for_each_force_kind([&](auto row) {
    for (const auto& element : elements_of(row, set)) row.for_each_wrench(element, motion, time, add);
  });
}

// Energy of all springs, preloads included [J].
[[nodiscard]] double stored_energy(const ElementSet& set, std::span<const LinkMotion> motion) noexcept;

// Whether anything follows the clock: then State::time is part of the state.
[[nodiscard]] bool depends_on_time(const ElementSet& set) noexcept;

// Whether anything has stiffness or damping; whether anything pushes on one side only.
[[nodiscard]] bool has_slopes(const ElementSet& set) noexcept;
[[nodiscard]] std::size_t stop_count(const ElementSet& set) noexcept;

// Variables, appended; values in the same order.
void list_variables(const ElementSet& set, std::vector<ElementVariable>& variables);
void read_variables(const ElementSet& set, std::span<const LinkMotion> motion, double time,
                    VariableSink& sink) noexcept;

// Index of a point force or torque by name; -1: none.
[[nodiscard]] int find_load(const ElementSet& set, std::string_view name) noexcept;

// A live value. kind: in the order of the table, -1: no element has the name; member: index in the row's value_keys(),
// -1: the element has no such value.
struct ElementValue {
  int kind = -1;
  int element = 0;
  int member = -1;
};
[[nodiscard]] ElementValue find_value(const ElementSet& set, std::string_view element, std::string_view key) noexcept;
[[nodiscard]] double& value_of(ElementSet& set, ElementValue value) noexcept;
[[nodiscard]] std::size_t value_count(const ElementSet& set) noexcept;
// Whether the set has it.
[[nodiscard]] bool has_value(const ElementSet& set, ElementValue value) noexcept;
void add_to_hash(const ElementSet& set, StateHash& hash) noexcept;
void save(const ElementSet& set, StateWriter& bytes);
void load(ElementSet& set, StateReader& bytes) noexcept;

}  // namespace slew::multibody
