#include "multibody/forces/element_set.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace slew::multibody {
namespace {

const LinkMotion& motion_of(std::span<const LinkMotion> motion, int link) noexcept {
  return motion[static_cast<std::size_t>(link)];
}

Deflection deflection_of(const FramePair& frames, std::span<const LinkMotion> motion) noexcept {
  return multibody::deflection_of(frames, motion_of(motion, frames.link1), motion_of(motion, frames.link2));
}

}  // namespace

double stored_energy(const ElementSet& set, std::span<const LinkMotion> motion) noexcept {
  double energy = 0;
  for (const Bushing& bushing : set.bushings) energy += stored_energy(bushing, deflection_of(bushing.frames, motion));
  for (const Beam& beam : set.beams) energy += stored_energy(beam, deflection_of(beam.frames, motion));
  for (const Rope& rope : set.ropes) energy += stored_energy(rope, state_of(rope, motion));
  for (const Tyre& tyre : set.tyres) energy += stored_energy(tyre, state_of(tyre, motion_of(motion, tyre.link)));
  return energy;
}

int find_load(const ElementSet& set, std::string_view name) noexcept {
  for (std::size_t i = 0; i < set.loads.size(); ++i) {
    if (set.loads[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

bool depends_on_time(const ElementSet& set) noexcept {
  return std::any_of(set.loads.begin(), set.loads.end(), [](const PointLoad& load) { return !load.table.empty(); });
}

}  // namespace slew::multibody
