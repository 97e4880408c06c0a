// SPDX-License-Identifier: Apache-2.0
// An elastic bearing between a frame on one body and a frame on another: six springs and dampers, coupled or not.
//
//   Q = P - (K + k) x - (D + d) x' - s(x) - b(x')                                                     (1)
// x of frame_pair.h; k, d diagonal; K, D full 6x6 matrices; s, b tables of single directions; P preload: Q at x = 0.
// With K symmetric the springs have the energy V = x^T (K + k) x/2 + sum of the tables' integrals - P . x; with D + d
// positive semi-definite the dampers take x'^T (D + d) x' >= 0.
// Card: docs/models/multibody_bushing.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "math/monotone_cubic.h"
#include "multibody/forces/connector.h"

namespace slew::multibody {

// Tables of a bushing, by direction.
struct DirectionTables {
  Table x{}, y{}, z{};
  Table about_x{}, about_y{}, about_z{};

  [[nodiscard]] std::array<const Table*, 6> all() const { return {&x, &y, &z, &about_x, &about_y, &about_z}; }
};

struct BushingDef {
  std::string name{};
  ConnectorFrames frames{};
  Triple stiffness{};                      // N/m, along the axes of frame 1
  Triple rotational_stiffness{};           // N m/rad
  Triple damping{};                        // N s/m
  Triple rotational_damping{};             // N m s/rad
  std::vector<double> stiffness_matrix{};  // 36 numbers row by row, SI; added to the diagonal; none: zero
  std::vector<double> damping_matrix{};    // the same
  Triple preload_force{};                  // N, on body 2 without deflection
  Triple preload_moment{};                 // N m
  DirectionTables spring_tables{};         // m or rad, N or N m; go on with their last slopes
  DirectionTables damper_tables{};         // m/s or rad/s, N or N m; never fall beyond their ends
};

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

// rad: short of half a turn, where the rotation vector jumps.
inline constexpr double kMostBushingRotation = 170 * M_PI / 180;
// Its moment depends on the rotation.
[[nodiscard]] bool holds_rotation(const Bushing& bushing) noexcept;

[[nodiscard]] Six force_of(const Bushing& bushing, const Deflection& deflection) noexcept;
// position (K + k + s') + rate (D + d + b'), tables' slopes where they rise.
[[nodiscard]] SixBySix slopes_of(const Bushing& bushing, const Deflection& deflection, ChangeWeights weights) noexcept;
[[nodiscard]] double stored_energy(const Bushing& bushing, const Deflection& deflection) noexcept;  // V [J]
[[nodiscard]] WrenchPair wrenches_of(const Bushing& bushing, const LinkMotion& link1, const LinkMotion& link2) noexcept;

[[nodiscard]] std::span<const Field> bushing_fields() noexcept;

struct BushingRow : ConnectorRow<Bushing> {
  struct Defs {
    std::vector<BushingDef> bushings;
  };
  struct Elements {
    std::vector<Bushing> bushings;
  };
  static constexpr auto kElements = &Elements::bushings;
  static constexpr std::tuple kTypes{ForceType{"forces", "bushing",
                                               "elastic bearing: six springs and dampers between two frames",
                                               bushing_fields, &Defs::bushings}};

  static Bushing build(const BushingDef& def, ElementBuilder& builder);
  static void check(const BushingDef& def, ElementRules& rules);
  static void check_start(const BushingDef& def, ElementStartRules& rules);
  static void linearise(Bushing& bushing) { bushing.curves.clear(); }
  static void silence(Bushing& bushing);
  static std::span<const std::string_view> value_keys(const Bushing& bushing) noexcept;
  static double* value(Bushing& bushing, std::size_t index) noexcept;
};

}  // namespace slew::multibody
