// SPDX-License-Identifier: Apache-2.0
// Accuracy of a reduction: figures, and their text.
//
// Static compliance of the tip: tip_compliance.h. Effective modal mass of mode k along a: C_k,a^2; the sum over all
// modes of a clamped body is its mass less the held part. A free body has none: its modes carry no momentum.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "flex/reduction.h"
#include "flex/tip_compliance.h"

namespace slew::flex {

struct ModeFigures {
  int ordinal = 0;  // counted from 1
  bool is_kept = false;
  double full = 0;                         // frequency of the whole model, held alike [rad/s]; 0 without it
  double reduced = 0;                      // rad/s
  double relative_error = 0;               // reduced/full - 1
  std::array<double, 3> effective_mass{};  // along x, y, z [kg]
};

struct ComplianceFigures {
  char direction = 'x';
  double full = 0;  // compliance of the whole model, without it of all modes [m/N]
  double kept = 0;  // m/N
  [[nodiscard]] double share() const noexcept { return full > 0 ? kept / full : 0; }
};

struct ReductionReport {
  bool has_model = true;  // false: built from flexible files; values of the whole model are 0
  Source source;
  int freedoms = 0, held_freedoms = 0;
  std::vector<ModeFigures> modes;
  int tip = 0;                                // id
  std::vector<int> reference_nodes;           // ids
  std::vector<ComplianceFigures> compliance;  // empty: the reference nodes do not hold the body
  RigidMass full_mass, reduced_mass;          // R^T M R of the matrices, integrals of the reduced body
  double kept_effective_mass[3] = {0, 0, 0};  // sum over the kept modes [kg]
};

// all: reduce(model, def). kept: ordinals of the used modes; empty: all.
// Throws InputError as select() does. Solves the whole model: seconds for thousands of freedoms.
[[nodiscard]] ReductionReport report_reduction(const FeModel& model, const ReductionDef& def, const Reduction& all,
                                               std::span<const int> kept);

// The same from flexible files.
[[nodiscard]] ReductionReport report_files(const Reduction& all, std::span<const int> kept);

[[nodiscard]] std::string text_of(const ReductionReport& report);
// SI; frequencies in Hz. Values that need the whole model are null in a report on flexible files.
[[nodiscard]] Json report_json(const ReductionReport& report);

// A few lines: mass, frequencies, static compliance and its share by the lowest modes.
[[nodiscard]] std::string summary_of(const Reduction& all, const TipCompliance& tip);

}  // namespace slew::flex
