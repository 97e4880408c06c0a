// The force elements of a mechanism beyond spring-dampers, as flat arrays by kind.
//
// Kinds with one law each are walked one after the other, each in the scene's order; a kind that the scene does not
// have costs the look at an empty array. No element has a state: all are functions of the links' motions and of time.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/element_variable.h"
#include "core/state_bytes.h"
#include "core/state_hash.h"
#include "multibody/forces/beam.h"
#include "multibody/forces/bushing.h"
#include "multibody/forces/point_load.h"
#include "multibody/forces/rope.h"
#include "multibody/forces/tyre.h"

namespace slew::multibody {

struct ElementSet {
  std::vector<PointLoad> loads;
  std::vector<Bushing> bushings;
  std::vector<Beam> beams;
  std::vector<Rope> ropes;
  std::vector<Tyre> tyres;
};

// Calls add(link, body, wrench) for every link that every element touches. motion: of all links; time [s].
template <typename Add>
void for_each_wrench(const ElementSet& set, std::span<const LinkMotion> motion, double time, Add&& add) noexcept {
  const auto link = [motion](int index) -> const LinkMotion& { return motion[static_cast<std::size_t>(index)]; };
  const auto add_pair = [&](const FramePair& frames, const WrenchPair& pair) {
    add(frames.link1, frames.body1, pair.on1);
    add(frames.link2, frames.body2, pair.on2);
  };
  for (const PointLoad& load : set.loads) add(load.link, load.body, wrench_of(load, link(load.link), time));
  for (const Bushing& bushing : set.bushings) {
    add_pair(bushing.frames, wrenches_of(bushing, link(bushing.frames.link1), link(bushing.frames.link2)));
  }
  for (const Beam& beam : set.beams) {
    add_pair(beam.frames, wrenches_of(beam, link(beam.frames.link1), link(beam.frames.link2)));
  }
  for (const Rope& rope : set.ropes) {
    const double tension = state_of(rope, motion).tension;
    if (tension == 0) continue;
    for (std::size_t k = 0; k < rope.points.size(); ++k) {
      add(rope.points[k].link, rope.points[k].body, wrench_on(rope, k, tension, motion));
    }
  }
  for (const Tyre& tyre : set.tyres) {
    const TyreState state = state_of(tyre, link(tyre.link));
    if (state.depth > 0) add(tyre.link, tyre.body, wrench_of(tyre, state, link(tyre.link)));
  }
}

// Energy of all springs, preloads included [J].
[[nodiscard]] double stored_energy(const ElementSet& set, std::span<const LinkMotion> motion) noexcept;

// Whether anything follows the clock: then State::time is part of the state.
[[nodiscard]] bool depends_on_time(const ElementSet& set) noexcept;

// Variables, appended; values in the same order. put(value) is called once for each.
void list_variables(const ElementSet& set, std::vector<ElementVariable>& variables);
struct VariableSink {
  std::span<double> values;
  std::size_t next = 0;
  void put(double value) noexcept {
    if (next < values.size()) values[next++] = value;
  }
  [[nodiscard]] std::span<double> rest() const noexcept { return values.subspan(next); }
};
void read_variables(const ElementSet& set, std::span<const LinkMotion> motion, double time,
                    VariableSink& sink) noexcept;

// Index of a point force or torque by name; -1: none.
[[nodiscard]] int find_load(const ElementSet& set, std::string_view name) noexcept;

// Live constants. kind: in the order of the arrays above; member: of that kind; -1 when there is none of that key.
enum class ElementKind : int { load, bushing, beam, rope, tyre };
struct ElementValue {
  ElementKind kind = ElementKind::load;
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
