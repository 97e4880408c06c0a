// SPDX-License-Identifier: Apache-2.0
// From a finite element model to the reduced body: modes, integrals, shortening, recovery, and its origin.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "flex/craig_bampton.h"
#include "flex/integrals.h"
#include "flex/recovery.h"
#include "flex/reduced_body.h"
#include "flex/uniform_element.h"

namespace slew::flex {

// none: g = 0. straight_beam: the shortening of foreshortening.h.
enum class GeometricStiffening : int { none, straight_beam };

struct ReductionDef {
  CraigBamptonDef modes = {};
  GeometricStiffening stiffening = GeometricStiffening::none;
};

// Origin of a reduced body; one line each, for files and reports.
struct Source {
  std::string model;
  std::string made_of;
  Attachment attachment = Attachment::clamped;
  std::vector<int> clamped_nodes;
  std::vector<int> interface_nodes;
  int nodes = 0;
  int elements = 0;  // 0: imported matrices
  int boundary_freedoms = 0;
  int interior_freedoms = 0;
  int fixed_interface_modes = 0;
  GeometricStiffening stiffening = GeometricStiffening::none;
  MassDeviation deviation;  // deviation of imported matrices from the assumption of the integrals
};

struct Reduction {
  Source source;
  ReducedBody body;
  Recovery recovery;
  std::vector<UniformElement> elements;  // elements of beams, for any selected modes
};

// All modes of the reduction: those of the interfaces and of the inside. Throws InputError as craig_bampton() and
// add_foreshortening() do. Allocates.
[[nodiscard]] Reduction reduce(const FeModel& model, const ReductionDef& def);

// The reduction with some of the modes, as select() of reduced_body.h.
[[nodiscard]] Reduction select(const Reduction& reduction, std::span<const int> ordinals);

}  // namespace slew::flex
