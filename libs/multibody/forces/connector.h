// SPDX-License-Identifier: Apache-2.0
// What kinds of elements between two frames share: the frames that a scene states, and most of their row.
//
// A Connector has a member `FramePair frames` and the functions force_of(connector, deflection), slopes_of(connector,
// deflection, weights), stored_energy(connector, deflection) and wrenches_of(connector, link1, link2); its Def a member
// `ConnectorFrames frames`.
#pragma once

#include <string>

#include "multibody/forces/force_row.h"
#include "multibody/forces/stiffness_sum.h"

namespace slew::multibody {

// Where a connector's two frames lie.
struct ConnectorFrames {
  std::string body1{};
  Triple point1{};        // m, body 1 frame
  Triple orientation1{};  // rad
  std::string body2{};
  Triple point2{};        // m, body 2 frame
  Triple orientation2{};  // rad
};

template <typename Connector>
struct ConnectorRow : ForceRow<Connector> {
  static Deflection deflection(const Connector& connector, std::span<const LinkMotion> motion) noexcept {
    return deflection_of(connector.frames, motion[static_cast<std::size_t>(connector.frames.link1)],
                         motion[static_cast<std::size_t>(connector.frames.link2)]);
  }

  template <typename Def>
  static void visit_points(Def& def, const VisitPoint& visit) {
    visit(def.frames.body1, &def.frames.point1);
    visit(def.frames.body2, &def.frames.point2);
  }

  template <typename Add>
  static void for_each_wrench(const Connector& connector, std::span<const LinkMotion> motion, double /*time*/,
                              Add&& add) noexcept {
    const FramePair& frames = connector.frames;
    const WrenchPair pair = wrenches_of(connector, motion[static_cast<std::size_t>(frames.link1)],
                                        motion[static_cast<std::size_t>(frames.link2)]);
    add(frames.link1, frames.body1, pair.on1);
    add(frames.link2, frames.body2, pair.on2);
  }

  static double energy(const Connector& connector, std::span<const LinkMotion> motion) noexcept {
    return stored_energy(connector, deflection(connector, motion));
  }

  static constexpr bool kHasSlopes = true;
  static void add_stiffness(const Connector& connector, StiffnessSum& sum) noexcept {
    const Deflection d = deflection(connector, sum.motion());
    sum.add_frames(connector.frames, d, slopes_of(connector, d, sum.weights()), force_of(connector, d));
  }
  template <typename Couple>
  static void for_each_coupling(const Connector& connector, Couple&& couple) {
    couple(connector.frames.link1, connector.frames.link2);
  }

  static constexpr bool kIsLinear = true;

  // deflection and the wrench on body 2 at P2, all in frame 1's axes
  static void list_variables(const Connector& connector, VariableNames& names) {
    names.add_triple(connector.name + ".deflection", Dimension::length);
    names.add_triple(connector.name + ".rotation", Dimension::angle);
    names.add_triple(connector.name + ".force", Dimension::force);
    names.add_triple(connector.name + ".moment", Dimension::torque);
  }
  static void read_variables(const Connector& connector, std::span<const LinkMotion> motion, double /*time*/,
                             VariableSink& sink) noexcept {
    const Deflection d = deflection(connector, motion);
    const Six Q = force_of(connector, d);
    const math::Vec3 M = moment_of(d, Q);
    for (const double x : d.x) sink.put(x);
    for (std::size_t i = 0; i < 3; ++i) sink.put(Q[i]);
    for (const double m : M.array()) sink.put(m);
  }
};

}  // namespace slew::multibody
