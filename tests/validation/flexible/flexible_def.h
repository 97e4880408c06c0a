// SPDX-License-Identifier: Apache-2.0
// Mechanisms with one flexible beam, made of libs/flex as a scene makes them.
#pragma once

#include <memory>
#include <vector>

#include "multibody/model/defs.h"
#include "scene/flexible_conversion.h"
#include "tests/support/flex_beams.h"

namespace slew::testing {

// kept: ordinals of the modes; empty: all
inline std::shared_ptr<const multibody::ModalBody> modes_of(const flex::BeamDef& beam, flex::ReductionDef def,
                                                            const std::vector<int>& kept) {
  flex::Reduction reduction = flex::reduce(flex::build_beam(beam), def);
  if (!kept.empty()) reduction = flex::select(reduction, kept);
  return std::make_shared<multibody::ModalBody>(scene::modal_body(reduction, beam.name));
}

}  // namespace slew::testing
