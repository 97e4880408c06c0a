// SPDX-License-Identifier: Apache-2.0
// Curves as a table of comma-separated values (RFC 4180), for spreadsheets, MATLAB and pandas.
//
// First line: "time [s]" and "name [unit]" of each curve. One line for every instant at which any curve has a value; a
// curve without a value there leaves its cell empty. Numbers have as many digits as bring back the same bits.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <span>

#include "core/status.h"
#include "plotting/series.h"

namespace slew::plotting {

void write_csv(std::span<const Series> series, std::ostream& out);

// Writes a new file or replaces one. Errors: storage.
[[nodiscard]] Status export_csv(std::span<const Series> series, const std::filesystem::path& path);

}  // namespace slew::plotting
