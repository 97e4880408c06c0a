// SPDX-License-Identifier: Apache-2.0
// Text inside of pages.
#pragma once

#include <string>
#include <string_view>

namespace slew::plotting {

// Data for a <script> element: nothing in it can end the element.
[[nodiscard]] std::string in_script(std::string text);

// A JSON string with its quotes; bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string json_string(std::string_view text);

}  // namespace slew::plotting
