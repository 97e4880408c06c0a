// SPDX-License-Identifier: Apache-2.0
// Comparison of a clamped and a free body frame: share of the tip's static compliance by the modes of each.
//
// The other frame uses the same nodes: a clamped body is set free with the clamped nodes as interfaces too, a free one
// is clamped at its first interface node. Both are measured from the clamped nodes (tip_compliance.h).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "flex/reduction.h"

namespace slew::flex {

struct AttachmentShares {
  std::string modes;                                   // "1;2", "lowest 4", "all"
  std::optional<std::array<double, 3>> clamped, free;  // along x, y, z [1]; empty: it has fewer modes
};

struct AttachmentComparison {
  int tip = 0;                       // id
  std::vector<int> reference_nodes;  // ids
  std::vector<AttachmentShares> rows;
  std::string obstacle;  // reason for missing rows; else empty
};

// all: reduce(model, def). kept: ordinals; empty: all. Reduces the model a second time.
[[nodiscard]] AttachmentComparison compare_attachments(const FeModel& model, const ReductionDef& def,
                                                       const Reduction& all, std::span<const int> kept);

[[nodiscard]] std::string text_of(const AttachmentComparison& comparison);
[[nodiscard]] Json report_json(const AttachmentComparison& comparison);

}  // namespace slew::flex
