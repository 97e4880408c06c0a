// An elastic bearing between a frame on one body and a frame on another: six springs and dampers, coupled or not.
//
//   Q = P - (K + k) x - (D + d) x' - s(x) - b(x')                                                     (1)
// x of frame_pair.h; k, d diagonal; K, D full 6x6 matrices; s, b tables of single directions; P preload: Q at x = 0.
// With K symmetric the springs have the energy V = x^T (K + k) x/2 + sum of the tables' integrals - P . x; with D + d
// positive semi-definite the dampers take x'^T (D + d) x' >= 0.
// Card: docs/models/multibody_bushing.md.
#pragma once

#include <string>
#include <vector>

#include "math/monotone_cubic.h"
#include "multibody/forces/frame_pair.h"

namespace slew::multibody {

// Table of one direction.
struct DirectionCurve {
  int direction = 0;  // entry of Six
  bool is_damper = false;
  math::MonotoneCubic curve;  // force that holds the deflection, or the speed
};

struct Bushing {
  std::string name;
  FramePair frames;
  Six spring{}, damping{};    // k [N/m, N m/rad], d [N s/m, N m s/rad]
  Six preload{};              // P [N, N m]
  SixBySix K{}, D{};          // in the SI units of their entries
  bool has_coupling = false;  // K or D is given
  std::vector<DirectionCurve> curves{};
};

[[nodiscard]] Six force_of(const Bushing& bushing, const Deflection& deflection) noexcept;
// position (K + k + s') + rate (D + d + b'), tables' slopes where they rise.
[[nodiscard]] SixBySix slopes_of(const Bushing& bushing, const Deflection& deflection, ChangeWeights weights) noexcept;
[[nodiscard]] double stored_energy(const Bushing& bushing, const Deflection& deflection) noexcept;  // V [J]
[[nodiscard]] WrenchPair wrenches_of(const Bushing& bushing, const LinkMotion& link1, const LinkMotion& link2) noexcept;

}  // namespace slew::multibody
