// SPDX-License-Identifier: Apache-2.0
// Mechanisms with one beam in segments, made of libs/flex as a scene makes them.
#pragma once

#include <memory>

#include "multibody/model/defs.h"
#include "scene/flexible_conversion.h"
#include "tests/support/flex_beams.h"

namespace slew::testing {

inline std::shared_ptr<const multibody::SegmentChain> segments_of(const flex::BeamDef& beam, int segments) {
  const flex::Reduction reduction =
      flex::reduce(flex::build_beam(beam), flex::testing::with_modes(beam.nodes.size() > 2 ? 2 : 0));
  return std::make_shared<multibody::SegmentChain>(scene::segment_chain(reduction, segments, beam.name));
}

}  // namespace slew::testing
