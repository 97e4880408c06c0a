#include <array>
#include <cmath>
#include <cstddef>

#include "multibody/forces/element_set.h"

namespace slew::multibody {
namespace {

using enum Dimension;

class ElementNames {
 public:
  explicit ElementNames(std::vector<ElementVariable>& list) : list_(list) {}
  void add(const std::string& name, Dimension dimension) { list_.push_back({name, dimension}); }
  void add_triple(const std::string& name, Dimension dimension) {
    for (const char* axis : {".x", ".y", ".z"}) add(name + axis, dimension);
  }

 private:
  std::vector<ElementVariable>& list_;
};

// what a connector shows: deflection and the wrench on body 2 at P2, all in frame 1's axes
void list_connector(const std::string& name, ElementNames& names) {
  names.add_triple(name + ".deflection", length);
  names.add_triple(name + ".rotation", angle);
  names.add_triple(name + ".force", force);
  names.add_triple(name + ".moment", torque);
}

template <typename Connector>
void read_connector(const Connector& connector, std::span<const LinkMotion> motion, VariableSink& sink) noexcept {
  const FramePair& frames = connector.frames;
  const Deflection deflection = deflection_of(frames, motion[static_cast<std::size_t>(frames.link1)],
                                              motion[static_cast<std::size_t>(frames.link2)]);
  const Six Q = force_of(connector, deflection);
  const math::Vec3 M = moment_of(deflection, Q);
  for (const double x : deflection.x) sink.put(x);
  for (std::size_t i = 0; i < 3; ++i) sink.put(Q[i]);
  for (const double m : M.array()) sink.put(m);
}

}  // namespace

void list_variables(const ElementSet& set, std::vector<ElementVariable>& variables) {
  ElementNames names(variables);
  for (const PointLoad& load : set.loads) {
    const bool is_force = load.kind == LoadKind::force;
    names.add(load.name + (is_force ? ".force" : ".torque"), is_force ? force : torque);
  }
  for (const Bushing& bushing : set.bushings) list_connector(bushing.name, names);
  for (const Beam& beam : set.beams) list_connector(beam.name, names);
  for (const Rope& rope : set.ropes) {
    names.add(rope.name + ".length", length);
    names.add(rope.name + ".rate", velocity);
    names.add(rope.name + ".slack", length);
    names.add(rope.name + ".tension", force);
  }
  for (const Tyre& tyre : set.tyres) {
    names.add(tyre.name + ".deflection", length);
    names.add(tyre.name + ".normal_force", force);
    names.add(tyre.name + ".longitudinal_force", force);
    names.add(tyre.name + ".lateral_force", force);
    names.add(tyre.name + ".slip", none);
    names.add(tyre.name + ".slip_angle", angle);
  }
}

void read_variables(const ElementSet& set, std::span<const LinkMotion> motion, double time,
                    VariableSink& sink) noexcept {
  for (const PointLoad& load : set.loads) sink.put(magnitude_of(load, time));
  for (const Bushing& bushing : set.bushings) read_connector(bushing, motion, sink);
  for (const Beam& beam : set.beams) read_connector(beam, motion, sink);
  for (const Rope& rope : set.ropes) {
    const RopeState state = state_of(rope, motion);
    for (const double value : {state.length, state.rate, state.slack, state.tension}) sink.put(value);
  }
  for (const Tyre& tyre : set.tyres) {
    const TyreState state = state_of(tyre, motion[static_cast<std::size_t>(tyre.link)]);
    for (const double value : {std::fmax(0.0, state.depth), state.normal_force, state.longitudinal_force,
                               state.lateral_force, state.slip, std::atan(state.lateral_slip)}) {
      sink.put(value);
    }
  }
}

}  // namespace slew::multibody
