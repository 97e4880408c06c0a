// SPDX-License-Identifier: Apache-2.0
// JSON of the report on a reduced flexible body.
#pragma once

#include "core/json.h"
#include "flex/attachment_comparison.h"
#include "flex/reduction_report.h"

namespace slew::cli {

// SI; frequencies in Hz. Values that need the whole model are null in a report on flexible files.
[[nodiscard]] Json to_json(const flex::ReductionReport& report);
[[nodiscard]] Json to_json(const flex::AttachmentComparison& comparison);

}  // namespace slew::cli
