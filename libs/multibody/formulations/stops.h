// SPDX-License-Identifier: Apache-2.0
// One-sided forces within a sub-step: which of them begin or end, and how hard. Internal to the library.
//
// A rule of order 2 takes the mean of the forces at both ends of a sub-step. A spring k that pushes from x_0 on and has
// let go at x_1 does the work k x_0 (x_0 + |x_1|)/2 on the mechanism, more than the k x_0^2/2 that it stored; one that
// is touched takes as much more than it stores. The same holds within a spring by table by the difference between the
// table and its chord. The stages of an explicit rule before and behind the edge of a range weigh the force there as if
// it were smooth: near the limit of its stability a mass leaves with twice its speed.
#pragma once

#include <span>

#include "multibody/forces/force_row.h"
#include "multibody/model/state.h"

namespace slew::multibody {

// State of one-sided forces, by element: the side of its range on which an end damper pushes (-1, 0, 1), LimitedForce
// of ropes and tyres, the pushing contact points of a pair. Needs the elements' motion and a search for contacts.
[[nodiscard]] std::size_t stop_count(const Model& model) noexcept;
void see_stops(const Model& model, const Workspace& ws, std::span<signed char> stops) noexcept;

// Which of them a rule does not take in one part: all of them, that of `augmented`; all, and swings against an edge
// that its stages do not resolve, an explicit one; the other implicit rules take touches by themselves, but not tables.
enum class Touched { elements, swings, tables };

// The same without contacts, with coordinate and speed.
[[nodiscard]] std::size_t element_stop_count(const Model& model) noexcept;
[[nodiscard]] bool has_element_stops(const Model& model, Touched touched) noexcept;  // else none of them can change
void see_element_stops(const Model& model, const Workspace& ws, std::span<StopMotion> stops) noexcept;

// What happened in a part of h. A side that changes while the element's speed changes by less than kGentle is gentle;
// harsh is also a table whose chord misses it by more than kBent, and a swing.
enum class Touch { none, gentle, harsh };
struct Passed {
  Touched touched = Touched::elements;
  double h = 0;  // s
};
[[nodiscard]] Touch touch_between(const Model& model, std::span<const StopMotion> start,
                                  std::span<const StopMotion> end, Passed passed) noexcept;

}  // namespace slew::multibody
