// SPDX-License-Identifier: Apache-2.0
// Names of files for pictures and pages.
#pragma once

#include <string>

namespace slew::cli {

// For options::Option::check(): empty for a name that ends in .svg or .html, for "-" and for a device such as
// /dev/stdout; otherwise what is wrong.
[[nodiscard]] std::string problem_of_picture_name(const std::string& path);

}  // namespace slew::cli
