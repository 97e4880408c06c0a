// SPDX-License-Identifier: Apache-2.0
// A row of the table of force kinds (force_kinds.h): all that the library needs of one kind of force element.
//
// A kind has a Def that a scene fills, an element that the model holds, and a row: a struct that derives from
// ForceRow<element>. What every row states:
//
//   struct DragRow : ForceRow<Drag> {
//     struct Defs { std::vector<DragDef> drags; };         // becomes MechanicsDef::drags
//     struct Elements { std::vector<Drag> drags; };        // becomes ElementSet::drags
//     static constexpr auto kElements = &Elements::drags;
//     static constexpr std::tuple kTypes{ForceType{"forces", "drag", "one line", drag_fields, &Defs::drags}};
//
//     static Drag build(const DragDef& def, ElementBuilder& builder);       // build_elements.h; all names are known
//     static void check(const DragDef& def, ElementRules& rules);           // validate_elements.h; rules without poses
//     static void visit_points(DragDef& def, const VisitPoint& visit);      // bodies that it names, with its points
//     // add(link, body, wrench) for every link
//     template <typename Add>
//     static void for_each_wrench(const Drag&, std::span<const LinkMotion>, double time, Add&&) noexcept;
//     // names and values in the same order
//     static void list_variables(const Drag&, VariableNames& names);
//     static void read_variables(const Drag&, std::span<const LinkMotion>, double time, VariableSink&) noexcept;
//   };
//
// ForceRow holds what a row may leave out: an element without energy, slopes, stops, live values and rules of the
// start. A row replaces it by a member of the same name. Everything is static and known to the compiler: a step calls
// no function through a pointer. What a step reaches neither allocates nor throws.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/element_variable.h"
#include "core/field.h"
#include "multibody/forces/wrench.h"

namespace slew::multibody {

class ElementBuilder;
class ElementRules;
class ElementStartRules;
class StiffnessSum;

// One value of the key `type` and the Defs that a scene makes with it.
template <typename Lists, typename Def>
struct ForceType {
  std::string_view section;            // "forces" or "dummies"
  std::string_view name;               // value of `type`
  std::string_view doc;                // one line
  std::span<const Field> (*fields)();  // of the Def
  std::vector<Def> Lists::*list;
};
template <typename Lists, typename Def>
ForceType(const char*, const char*, const char*, std::span<const Field> (*)(), std::vector<Def> Lists::*)
    -> ForceType<Lists, Def>;  // clang 14 does not deduce an aggregate's arguments

// A body by name, and the point in its frame; null: the element has no point there.
using VisitPoint = std::function<void(std::string& body, Triple* point)>;

// Names of variables, appended to a list.
class VariableNames {
 public:
  explicit VariableNames(std::vector<ElementVariable>& list) : list_(list) {}
  void add(const std::string& name, Dimension dimension) { list_.push_back({name, dimension}); }
  void add_triple(const std::string& name, Dimension dimension) {
    for (const char* axis : {".x", ".y", ".z"}) add(name + axis, dimension);
  }

 private:
  std::vector<ElementVariable>& list_;
};

// Values of variables: put(value) is called once for each.
struct VariableSink {
  std::span<double> values;
  std::size_t next = 0;
  void put(double value) noexcept {
    if (next < values.size()) values[next++] = value;
  }
  [[nodiscard]] std::span<double> rest() const noexcept { return values.subspan(next); }
};

// Motion along the coordinate of a one-sided law at one instant.
struct StopMotion {
  int side = 0;      // the part of the law that acts, 0: none
  double x = 0;      // coordinate of its spring [m or rad]
  double speed = 0;  // m/s or rad/s
  // behind the edge of its range, negative before it [m or rad], and its rate; tables have no edge
  double depth = -INFINITY, depth_rate = 0;
};

template <typename T>
struct ForceRow {
  using Element = T;

  // Rules of the poses that a scene starts from.
  template <typename Def>
  static void check_start(const Def& /*def*/, ElementStartRules& /*rules*/) {}

  // Why a live field would change nothing of this Def; empty: it changes something.
  template <typename Def>
  static std::string obstacle_of_change(const Def& /*def*/, const Field& /*field*/) {
    return {};
  }

  static double energy(const T& /*element*/, std::span<const LinkMotion> /*motion*/) noexcept {
    return 0;
  }  // J, of springs

  static bool depends_on_time(const T& /*element*/) noexcept { return false; }

  // Stiffness and damping over the speeds of the links, for implicit steps: stiffness_sum.h, with every pair of links
  // between which it adds something.
  static constexpr bool kHasSlopes = false;
  static void add_stiffness(const T& /*element*/, StiffnessSum& /*sum*/) noexcept {}
  template <typename Couple>
  static void for_each_coupling(const T& /*element*/, Couple&& /*couple*/) {}

  // One-sided laws: a change of the side within an implicit step restarts that step. curve_force: of a spring by table,
  // at its coordinate; 0 of linear ones.
  static constexpr bool kHasStops = false;
  static StopMotion stop_of(const T& /*element*/, std::span<const LinkMotion> /*motion*/) noexcept { return {}; }
  static double curve_force(const T& /*element*/, double /*x*/) noexcept { return 0; }

  // Whether it is linear around the start, but for tables, which linearise() leaves out; silence() leaves nothing. For
  // the check of explicit steps (steepest_laws.h, which has the laws of kinds that push on one side or saturate).
  static constexpr bool kIsLinear = false;
  static void linearise(T& /*element*/) {}
  static void silence(T& /*element*/) {}

  // Values that may change while the mechanism runs, by key below the element's name ("stiffness.x").
  static std::span<const std::string_view> value_keys(const T& /*element*/) noexcept { return {}; }
  static double* value(T& /*element*/, std::size_t /*index*/) noexcept { return nullptr; }  // index in value_keys()
};

}  // namespace slew::multibody
