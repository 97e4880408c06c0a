// SPDX-License-Identifier: Apache-2.0
// Pages with a measured part, which a program replaces.
#pragma once

#include <filesystem>
#include <string>

namespace slew::benchmarks {

// Puts the text between the marks `<!-- measured: begin -->` and `<!-- measured: end -->` of the page. False: there are
// none, or the page cannot be written.
[[nodiscard]] bool replace_measured(const std::filesystem::path& page, const std::string& text);

}  // namespace slew::benchmarks
