// SPDX-License-Identifier: Apache-2.0
// `slewring loadchart SCENE`: the largest payload over the reach for each limit, at rest.
//
// The machine stands at every pose of a grid of one or two joint coordinates. At each pose the static line forces are
// linear in the payload's mass m, and every limit gives a load:
//   cylinder   m_i = m_0 + (F_i,max - F_i(m_0)) / s_i                       description/port_limits.h            (1)
//   structure  m_i = m_0 + (+-F_i,allowed - F_i(m_0)) / s_i                 for cylinders with an allowed force  (2)
//   tipping    m = -M_0 / s                                                 tipping.h                            (3)
// The load of the pose is the smallest of them, at least 0. F_i,max is what the valves press with when the pistons are
// held; it does not depend on the pose and is found once, at the first one that the machine reaches.
//
// Not covered: safety factors, dynamics, friction of joints, strength beyond (2), flexible bodies.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/json.h"
#include "scene/scene.h"

namespace slew::analysis {

struct LoadChartOptions {
  std::string scene;
  scene::Overrides overrides{};
  std::vector<std::string> over{};       // "Boom_Foot=-40deg..50deg:10", one or two
  std::vector<std::string> lines{};      // "1.4 0 -1.2, 1.4 0 1.2"; none: those of the tyres
  std::vector<std::string> structure{};  // "Cyl_Lift=400kN"
  std::string from{};                    // body whose origin the reach is measured from; empty: Ground
};

inline constexpr std::size_t kMostChartPoses = 10'000;

struct ChartCoordinate {
  std::string joint;
  std::string unit;  // of the poses' values
};

enum class LimitKind { cylinder, structure, tipping };

struct ChartLimit {
  LimitKind kind{};
  std::string name;  // "Cyl_Lift", "Cyl_Lift structure", "tipping"
};

struct ChartPose {
  std::vector<double> values;         // of the coordinates, in their units
  std::vector<std::string> settings;  // the same as texts, "20 deg"
  std::string refusal{};              // why there is no load; empty: there is one
  double reach = 0, height = 0;       // m, payload's centre of mass: level distance, height above `from`
  std::vector<double> loads{};        // kg, by limit; infinite: it does not limit here
  std::size_t limiting = 0;           // the smallest of them
  double load = 0;                    // kg, at least 0
  bool tips_alone = false;            // the machine tips without payload

  [[nodiscard]] bool has_load() const noexcept { return refusal.empty(); }
};

struct LoadChart {
  std::string scene, payload, from;
  double mass = 0;  // kg, in the scene
  std::vector<ChartCoordinate> coordinates;
  std::vector<ChartLimit> limits;
  std::vector<ChartPose> poses;       // the last coordinate changes fastest
  std::vector<std::string> warnings;  // sentences
  std::vector<std::string> notes;     // sentences: what was taken where the options leave it open
};

// progress: what is done and its share; false ends the work, and the poses so far are kept. Throws Failure and
// LoadError.
[[nodiscard]] LoadChart find_load_chart(const LoadChartOptions& options,
                                        const std::function<bool(std::string_view, double)>& progress);

// width [characters]: of the lines of the table; 0: no limit.
[[nodiscard]] std::string report_text(const LoadChart& chart, std::size_t width = 0);
[[nodiscard]] std::string report_csv(const LoadChart& chart);
[[nodiscard]] Json report_json(const LoadChart& chart);
// One coordinate: load over reach, a curve for each limit. Two: the poses by reach and height with their loads.
[[nodiscard]] std::string report_svg(const LoadChart& chart);

}  // namespace slew::analysis
